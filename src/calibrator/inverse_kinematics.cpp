#include <algorithm>
#include <cmath>
#include <numbers>

#include "model/halton.hpp"
#include "posewise/calibrator/correction.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr double turn = 2 * std::numbers::pi;

/// A pose is reached within this, m and rad.
constexpr double reached_within = 1e-6;

/// Solutions nearer to each other than this in every joint are one, rad and m.
constexpr double same_solution = 1e-4;

bool is_reached(const PoseError& left) {
    return left.position <= reached_within && left.orientation <= reached_within;
}

class InverseSearch {
  public:
    InverseSearch(const Chain& robot, const VectorXd& parameters, const Isometry3d& wanted,
                  const VectorXd& seed, const InverseOptions& options)
        : robot_(robot), parameters_(parameters), wanted_(wanted), seed_(seed), options_(options) {
        // Nothing but the joint limits holds a joint.
        for (const Joint& joint : robot.joints()) {
            double& largest = joint.motion == Motion::Rotation ? correction_.largest_turn
                                                               : correction_.largest_slide;
            largest = std::max(largest, joint.upper - joint.lower);
        }
    }

    InverseSolution run() {
        const RowMatrixXd all_over = detail::halton_configurations(robot_, options_.start_count);
        try_from(seed_);
        for (Index k = 0; k < all_over.rows(); ++k) {
            const VectorXd start = all_over.row(k).transpose();
            constexpr double near = 0.25;  // of the way from the seed
            try_from(k % 2 == 0 ? VectorXd(seed_ + near * (start - seed_)) : start);
        }
        std::ranges::stable_sort(found_, {}, [&](const VectorXd& q) { return distance(q); });
        return nearest();
    }

  private:
    double distance(const VectorXd& q) const { return (q - seed_).squaredNorm(); }

    void try_from(const VectorXd& start) {
        const Correction once =
            correct_configuration(robot_, parameters_, start, wanted_, correction_);
        if (!is_reached(once.residual)) return;
        // From there, what a change of joints costs no longer counts.
        const Correction solution =
            correct_configuration(robot_, parameters_, once.joints, wanted_, correction_);
        const VectorXd& q = is_reached(solution.residual) ? solution.joints : once.joints;
        if (std::ranges::any_of(solutions_, [&](const VectorXd& one) { return is_same(one, q); })) {
            return;
        }
        solutions_.push_back(q);
        add_turns(q, 0);
    }

    static bool is_same(const VectorXd& a, const VectorXd& b) {
        return (a - b).cwiseAbs().maxCoeff() < same_solution;
    }

    /// The solution with joints from `first` on at each of their turns within the limits.
    void add_turns(const VectorXd& q, Index first) {
        if (first == robot_.joint_count()) return add(q);
        const Joint& joint = robot_.joint(first);
        add_turns(q, first + 1);
        if (joint.motion != Motion::Rotation) return;
        for (const double shift : {-turn, turn}) {
            VectorXd other = q;
            other[first] += shift;
            if (other[first] < joint.lower || other[first] > joint.upper) continue;
            add_turns(other, first + 1);
        }
    }

    void add(const VectorXd& q) {
        const auto is_known = [&](const VectorXd& one) { return is_same(one, q); };
        if (std::ranges::any_of(found_, is_known)) return;
        if (options_.is_wanted && !options_.is_wanted(q)) return;
        // A joint may drive more than its own turn, such as a coupled slide.
        const Isometry3d flange = robot_.base_from_flange(q, parameters_);
        const Isometry3d left = wanted_.inverse() * flange;
        if (left.translation().norm() > 2 * reached_within) return;
        if (vector_from_rotation(left.linear()).norm() > 2 * reached_within) return;
        found_.push_back(q);
    }

    InverseSolution nearest() const {
        InverseSolution solution;
        if (found_.empty()) return solution;
        solution.joints = found_.front();
        constexpr double surely = 4;  // squares: twice as far
        const auto is_rival = [&](const VectorXd& q) {
            return distance(q) < surely * distance(solution.joints) + same_solution;
        };
        // With more joints than six all solutions are of one branch, or of few.
        const bool has_branches = robot_.joint_count() <= 6;
        if (has_branches && found_.size() > 1 && is_rival(found_[1])) solution.rival = found_[1];
        return solution;
    }

    const Chain& robot_;
    const VectorXd& parameters_;
    const Isometry3d& wanted_;
    const VectorXd& seed_;
    const InverseOptions& options_;
    CorrectionOptions correction_;
    std::vector<VectorXd> solutions_;  ///< each once, whatever its turns
    std::vector<VectorXd> found_;      ///< wanted ones, turns and all
};

}  // namespace

InverseSolution inverse_kinematics(const Chain& robot, const VectorXd& parameters,
                                   const Isometry3d& base_from_flange, const VectorXd& seed,
                                   const InverseOptions& options) {
    if (!robot.torques().empty()) {
        throw InputError("the robot measures torques; must have joints only");
    }
    return InverseSearch(robot, parameters, base_from_flange, seed, options).run();
}

}  // namespace posewise
