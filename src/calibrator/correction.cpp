#include "posewise/calibrator/correction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/decompositions.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensor.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {
namespace {

/// What a change of joints by 1 rad or 1 m costs, m: next to nothing, so that it decides only
/// between joint values that are equally good.
constexpr double change_weight = 1e-5;

/// The same beside a singular pose, where it keeps joints that gain hardly anything from turning,
/// and what they must gain to turn all the same, m per rad or m.
constexpr double singular_change_weight = 1e-2;
constexpr double least_gain = 2e-3;

/// Falls of the sum of squares below this are rounding, m^2.
constexpr double negligible = 1e-26;

/// A pose with a weighted error below this is reached, m: nothing holds it, nor is it singular.
constexpr double attained = 1e-6;

/// Weight of a joint sum that is kept at its limit, m per rad or m: far above all others, so that
/// the least squares leave it there.
constexpr double sum_weight = 1e4;

/// A sum that is beyond its limit by less than this is taken to be at it, rad or m.
constexpr double sum_rounding = 1e-9;

/// Rotation vector of what R lacks to be the wanted rotation, in the frame both are in.
Vector3d missing_rotation(const Matrix3d& wanted, const Matrix3d& R) {
    return vector_from_rotation(wanted * R.transpose());
}

/// min |J d - r|^2, rows: position and weighted angle that are missing, change of each joint, what
/// each sum that is held lacks to its limit.
struct Equations {
    MatrixXd J;
    VectorXd r;
};

/// A joint sum that is kept at one of its limits.
struct HeldSum {
    const JointSum* sum = nullptr;
    double limit = 0;  ///< rad or m
};

class Search {
  public:
    Search(const Chain& robot, const VectorXd& parameters, const VectorXd& nominal,
           const Isometry3d& wanted, const CorrectionOptions& options)
        : robot_(robot),
          parameters_(parameters),
          nominal_(nominal),
          wanted_(wanted),
          options_(options),
          lower_(nominal),
          upper_(nominal) {
        // What follows the joints, measured torques, stays as it is.
        for (Index j = 0; j < robot.joint_count(); ++j) {
            const bool turns = robot.joint(j).motion == Motion::Rotation;
            const double change = turns ? options.largest_turn : options.largest_slide;
            lower_[j] = std::max(limits(j).lower, nominal[j] - change);
            upper_[j] = std::min(limits(j).upper, nominal[j] + change);
        }
    }

    Correction run() {
        const Correction correction = solve();
        if (correction.held_by_change.empty()) return correction;
        change_weight_ = singular_change_weight;
        Correction calm = solve();
        const double gained = weigh(calm.residual) - weigh(correction.residual);
        if (gained >= least_gain * (change(correction) - change(calm))) return correction;
        calm.is_singular = true;
        return calm;
    }

  private:
    /// Each sum that the joints found would be beyond is held at its limit, until none is.
    Correction solve() {
        held_sums_.clear();
        for (;;) {
            const Correction correction = solve_with_held_sums();
            const auto beyond = find_sum_beyond(correction.joints);
            if (!beyond) return correction;
            held_sums_.push_back(*beyond);
        }
    }

    /// The first sum beyond its limit that is not held yet. Where the nominal joints are beyond
    /// already, the limit is where they are.
    std::optional<HeldSum> find_sum_beyond(const VectorXd& q) const {
        for (const JointSum& sum : options_.joint_sums) {
            if (std::ranges::find(held_sums_, &sum, &HeldSum::sum) != held_sums_.end()) continue;
            const double lower = std::min(sum.limits.lower, sum.amount(nominal_));
            const double upper = std::max(sum.limits.upper, sum.amount(nominal_));
            if (sum.amount(q) < lower - sum_rounding) return HeldSum{&sum, lower};
            if (sum.amount(q) > upper + sum_rounding) return HeldSum{&sum, upper};
        }
        return std::nullopt;
    }

    Correction solve_with_held_sums() {
        Correction correction;
        correction.joints = nominal_.cwiseMax(lower_).cwiseMin(upper_);
        correction.uncorrected = error_at(nominal_);
        double damping = 1e-9;
        for (Index k = 0; correction.ending == Ending::NotRun; ++k) {
            correction.ending = k < options_.iteration_limit ? step(correction.joints, damping)
                                                             : Ending::IterationLimit;
        }
        correction.residual = error_at(correction.joints);
        if (is_reached(correction)) return correction;
        find_held(correction);
        correction.is_singular = is_singular(correction);
        return correction;
    }

    double weigh(const PoseError& left) const {
        return std::hypot(left.position, options_.length_per_angle * left.orientation);
    }

    bool is_reached(const Correction& correction) const {
        return weigh(correction.residual) <= attained;
    }

    double change(const Correction& correction) const {
        return (correction.joints - nominal_).cwiseAbs().maxCoeff();
    }

    bool is_singular(const Correction& correction) const {
        if (!correction.held_by_limit.empty() || !correction.held_by_change.empty() ||
            !correction.held_by_sum.empty()) {
            return false;
        }
        return robot_.joint_count() >= (options_.length_per_angle > 0 ? 6 : 3);
    }

    void find_held(Correction& correction) {
        const Equations system = equations(correction.joints);
        const std::vector<Index> free = free_joints(correction.joints, system);
        for (const HeldSum& held : held_sums_) correction.held_by_sum.push_back(held.sum->name);
        for (Index j = 0; j < robot_.joint_count(); ++j) {
            if (std::find(free.begin(), free.end(), j) != free.end()) continue;
            const double q = correction.joints[j];
            const bool at_limit = q == limits(j).lower || q == limits(j).upper;
            (at_limit ? correction.held_by_limit : correction.held_by_change).push_back(j);
        }
    }

    const Joint& limits(Index joint) const {
        return robot_.joints()[static_cast<std::size_t>(joint)];
    }

    PoseError error_at(const VectorXd& q) const {
        const Isometry3d flange = robot_.base_from_flange(q, parameters_);
        return {(wanted_ * options_.tool - flange * options_.tool).norm(),
                missing_rotation(wanted_.linear(), flange.linear()).norm()};
    }

    Equations equations(const VectorXd& q) {
        const Index count = q.size();
        robot_.differentiate(Isometry3d::Identity(), q, parameters_, motion_);
        const Isometry3d& flange = motion_.world_from_flange;
        const Vector3d tool = flange * options_.tool;
        const double weight = options_.length_per_angle;
        const auto sums = std::ssize(held_sums_);
        const Index rows = 6 + count + sums;
        Equations system{MatrixXd::Zero(rows, count), VectorXd::Zero(rows)};
        for (Index j = 0; j < robot_.joint_count(); ++j) {
            const Twist twist = motion_.joint_twists.col(j);
            system.J.block<3, 1>(0, j) = velocity_of(tool, twist);
            system.J.block<3, 1>(3, j) = weight * twist.head<3>();
        }
        system.J.middleRows(6, count).diagonal().setConstant(change_weight_);
        system.r.head(6 + count) << wanted_ * options_.tool - tool,
            weight * missing_rotation(wanted_.linear(), flange.linear()),
            change_weight_ * (nominal_ - q);
        for (Index k = 0; k < sums; ++k) {
            const auto& [sum, limit] = held_sums_[static_cast<std::size_t>(k)];
            system.J.row(6 + count + k).head(sum->coefficients.size()) =
                sum_weight * sum->coefficients.transpose();
            system.r[6 + count + k] = sum_weight * (limit - sum->amount(q));
        }
        return system;
    }

    /// All joints but those at a bound beyond which the sum of squares would fall.
    std::vector<Index> free_joints(const VectorXd& q, const Equations& system) const {
        const VectorXd descent = system.J.transpose() * system.r;
        std::vector<Index> free;
        for (Index j = 0; j < q.size(); ++j) {
            const bool is_held =
                (q[j] <= lower_[j] && descent[j] < 0) || (q[j] >= upper_[j] && descent[j] > 0);
            if (!is_held) free.push_back(j);
        }
        return free;
    }

    /// One accepted step, or an ending.
    Ending step(VectorXd& q, double& damping) {
        const Equations system = equations(q);
        const std::vector<Index> free = free_joints(q, system);
        if (free.empty()) return Ending::Converged;
        const auto count = static_cast<Index>(free.size());
        MatrixXd J = MatrixXd::Zero(system.J.rows() + count, count);
        J.topRows(system.J.rows()) = system.J(Eigen::all, free);
        VectorXd r = VectorXd::Zero(J.rows());
        r.head(system.r.size()) = system.r;
        const double cost = system.r.squaredNorm();
        const VectorXd whole = detail::solve_least_squares(J, r);
        if ((J * whole).squaredNorm() <= negligible + 1e-12 * cost) return Ending::Converged;
        for (; damping < 1e12; damping *= 10) {
            J.bottomRows(count).diagonal().setConstant(std::sqrt(damping));
            VectorXd moved = q;
            moved(free) += detail::solve_least_squares(J, r);
            moved = moved.cwiseMax(lower_).cwiseMin(upper_);
            if (equations(moved).r.squaredNorm() < cost) {
                q = moved;
                damping = std::max(damping / 100, 1e-15);
                return Ending::NotRun;
            }
        }
        return Ending::Stalled;
    }

    const Chain& robot_;
    const VectorXd& parameters_;
    const VectorXd& nominal_;
    const Isometry3d& wanted_;
    const CorrectionOptions& options_;
    VectorXd lower_;
    VectorXd upper_;
    FlangeMotion motion_;
    double change_weight_ = change_weight;
    std::vector<HeldSum> held_sums_;
};

void check_options(const CorrectionOptions& options) {
    const auto check = [](const char* name, double value, bool may_be_zero) {
        if (std::isfinite(value) && (value > 0 || (may_be_zero && value == 0))) return;
        throw InputError(fmt::format("{} is {}, must be a positive number{}", name, value,
                                     may_be_zero ? " or 0" : ""));
    };
    check("length_per_angle", options.length_per_angle, true);
    check("largest_turn", options.largest_turn, false);
    check("largest_slide", options.largest_slide, false);
    if (!options.tool.allFinite()) throw InputError("the tool point is not finite");
}

void check_limits(const Chain& robot, const VectorXd& nominal) {
    robot.check_configuration(nominal);
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joint(j);
        constexpr double rounding = 1e-9;  // of values that were converted, rad or m
        if (nominal[j] >= joint.lower - rounding && nominal[j] <= joint.upper + rounding) continue;
        const AmountUnits& units = units_of(joint.motion);
        throw InputError(
            fmt::format("joint '{}' is at {:.6g} {}; must be within its limits, {:.6g} to {:.6g}",
                        joint.name, units.to_reading(nominal[j]), units.reading,
                        units.to_reading(joint.lower), units.to_reading(joint.upper)));
    }
}

}  // namespace

Correction correct_configuration(const Chain& robot, const VectorXd& parameters,
                                 const VectorXd& nominal, const Isometry3d& base_from_flange,
                                 const CorrectionOptions& options) {
    check_options(options);
    check_limits(robot, nominal);
    return Search(robot, parameters, nominal, base_from_flange, options).run();
}

std::string describe_shortfall(const Chain& robot, const Correction& correction) {
    std::string text;
    const auto add = [&text](const std::string& what) {
        text += (text.empty() ? "" : ", ") + what;
    };
    const auto add_joints = [&](const std::vector<Index>& joints, const char* where) {
        for (const Index j : joints) {
            add(robot.joints()[static_cast<std::size_t>(j)].name + where);
        }
    };
    add_joints(correction.held_by_limit, " at its limit");
    for (const std::string& sum : correction.held_by_sum) add(sum + " at its limit");
    add_joints(correction.held_by_change, " at the largest change");
    if (correction.is_singular) add("singular");
    if (correction.ending == Ending::IterationLimit) add("not converged");
    return text;
}

}  // namespace posewise
