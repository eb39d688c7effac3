#include "posewise/calibrator/identification.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "core/decompositions.hpp"
#include "learned_sizes.hpp"
#include "measurement/noise.hpp"
#include "model_error.hpp"
#include "normal_equations.hpp"
#include "posewise/core/errors.hpp"
#include "robust.hpp"

namespace posewise {
namespace {

/// A linearised system as steps are taken from it: in information form unless its columns are so
/// nearly dependent that rounding would matter.
class Steps {
  public:
    Steps(const detail::IdentificationProblem& problem, const detail::LinearisedSystem& system)
        : equations_(normal_equations(problem, system)), metric_(equations_.M) {
        if (!metric_.is_regular()) triangle_ = triangularise(system);
    }

    /// What a full step could take off the sum of squares.
    double gain() const {
        return triangle_ ? triangle_->c.squaredNorm()
                         : equations_.g.dot(metric_.solve(equations_.g));
    }

    /// Half of what the sum of squares falls by per part of this step, where it begins.
    double slope(const VectorXd& step) const {
        return triangle_ ? triangle_->c.dot(triangle_->R * step) : equations_.g.dot(step);
    }

    /// The step of minimal |J d - r|^2 + damping |D d|^2, D the column norms [Marquardt 1963].
    VectorXd damped(double damping) const {
        if (!triangle_) {
            MatrixXd M = equations_.M;
            M.diagonal() *= 1 + damping;
            return detail::Metric(M).solve(equations_.g);
        }
        const Index size = triangle_->R.cols();
        MatrixXd stacked(2 * size, size);
        stacked.topRows(size) = triangle_->R;
        stacked.bottomRows(size) =
            (std::sqrt(damping) * triangle_->R.colwise().norm()).transpose().asDiagonal();
        VectorXd right = VectorXd::Zero(2 * size);
        right.head(size) = triangle_->c;
        return detail::solve_least_squares(std::move(stacked), right);
    }

  private:
    detail::NormalEquations equations_;
    detail::Metric metric_;
    std::optional<detail::Triangle> triangle_;
};

struct LevenbergMarquardt {
    detail::IdentificationProblem& problem;
    double relative_tolerance;
    Estimate& estimate;
    std::optional<detail::LinearisedSystem> system{};  ///< at the estimate, if it is known
    double cost = total_loss(problem, estimate.parameters);
    double damping = 1e-6;
    bool has_constant_noise = detail::has_constant_noise(problem.campaign);
    Index deviations_open = problem.loss.kind == LossKind::Squares ? 0 : 50;
    double used = deviations_open > 0 ? parameters_used(problem, estimate.parameters) : 0;

    /// The unit of the loss follows the residuals until it stays; from then on all steps lower one
    /// function.
    void follow_deviation() {
        const double before = problem.deviation;
        problem.deviation = robust_deviation(problem, estimate.parameters, used);
        const bool stays = std::abs(problem.deviation - before) <= 1e-6 * before;
        deviations_open = stays ? 0 : deviations_open - 1;
        cost = total_loss(problem, estimate.parameters);
    }

    /// A step by some part of it.
    struct Trial {
        Parameters moved;
        double cost;
    };
    /// Where noise depends on the pose a step is judged with that before it: the fixed point of
    /// reweighted least squares is where no such step is left.
    Trial try_step(const VectorXd& step) const {
        Parameters moved = advance(problem.campaign, estimate.parameters, problem.units.step(step));
        const double moved_cost =
            total_loss(problem, moved, has_constant_noise ? nullptr : &estimate.parameters);
        return {std::move(moved), moved_cost};
    }

    /// To where a parabola through the cost along the step is least, if the step gained far less or
    /// far more than expected and that is better: large residuals bend the cost in directions that
    /// hardly anything but the prior holds, so that steps would go to and fro, or creep.
    void stretch(const VectorXd& step, double slope, Trial& trial) const {
        const double part = (cost - trial.cost) / slope;  // 1 where the system is exact
        if (std::abs(part - 1) <= 0.25) return;
        const double curvature = trial.cost - cost + 2 * slope;
        const double best = curvature > 0 ? std::clamp(slope / curvature, 0.1, 10.0) : 10.0;
        Trial other = try_step(best * step);
        if (other.cost < trial.cost) trial = std::move(other);
    }

    /// One accepted step, or an ending.
    void iterate() {
        if (deviations_open > 0) follow_deviation();
        system = linearise(problem, estimate.parameters);
        const Steps steps(problem, *system);
        const double gain = steps.gain();
        if (gain <= converged_below(problem, relative_tolerance, cost)) {
            if (deviations_open == 0) estimate.ending = Ending::Converged;
            return;
        }
        for (; damping < 1e12; damping *= 10) {
            const VectorXd step = steps.damped(damping);
            Trial trial = try_step(step);
            stretch(step, steps.slope(step), trial);
            if (trial.cost < cost) {
                estimate.parameters = trial.moved;
                system.reset();
                cost = has_constant_noise ? trial.cost : total_loss(problem, trial.moved);
                damping = std::max(damping / 100, 1e-15);
                return;
            }
        }
        constexpr double rounding = 1e-10;  // of the cost; a step could gain less than that
        estimate.ending = gain <= rounding * cost ? Ending::Converged : Ending::Stalled;
    }
};

/// The system where it ends. A search for a model error to be found from it may be `rough`: that
/// follows the root of the cost, and is found at the optimum of the linearised system. Farther than
/// that many small steps may lead: beside a few gross errors, of thousands of deviations by the
/// error expected, directions that only the prior holds are curved more by their residuals than by
/// the prior.
detail::LinearisedSystem search(detail::IdentificationProblem& problem,
                                const LevenbergMarquardtOptions& options, Estimate& estimate,
                                bool is_rough) {
    constexpr double rough = 1e-3;
    const double tolerance = options.relative_tolerance;
    LevenbergMarquardt steps{problem, is_rough ? std::max(rough, tolerance) : tolerance, estimate};
    while (estimate.ending == Ending::NotRun) {
        if (estimate.iterations >= options.iteration_limit) {
            estimate.ending = Ending::IterationLimit;
            break;
        }
        estimate.ending = options.stop.ending_or(Ending::NotRun);
        if (estimate.ending == Ending::NotRun) steps.iterate();
        if (estimate.ending == Ending::NotRun) ++estimate.iterations;
    }
    return steps.system ? std::move(*steps.system) : linearise(problem, estimate.parameters);
}

/// Whether the optimum of the system linearised here leaves far more over than errors as stated.
/// Under a model error so much too small, large residuals bend directions that hardly anything but
/// the prior holds: it is then found before the first step, too.
bool leaves_far_more(const detail::IdentificationProblem& problem, const Parameters& parameters) {
    constexpr double far = 5;  // deviations
    const double left =
        total_loss(problem, parameters) - Steps(problem, linearise(problem, parameters)).gain();
    return left > far * far * static_cast<double>(problem.observation_count());
}

/// Whether their model errors and sizes are the same within 5 %: parameters and deviations depend
/// on them far less.
bool is_alike(const Campaign& a, const Campaign& b) {
    const auto is_near = [](double x, double y) { return std::abs(x - y) <= 0.05 * x; };
    const VectorXd before = robot_error_sizes(a.spread, a.robot);
    const VectorXd after = robot_error_sizes(b.spread, b.robot);
    return is_near(a.model_error, b.model_error) &&
           is_near(a.model_error_orientation, b.model_error_orientation) &&
           ((before - after).array().abs() <= 0.05 * before.array()).all();
}

/// Whether what is left over may be the robot's own. Gross errors in the measurements leave more,
/// and sizes learned from them would let the robot bend to them.
bool is_credible(const Campaign& stated, const Campaign& found) {
    constexpr double credible = 20;
    return found.model_error <= credible * stated.model_error &&
           found.model_error_orientation <= credible * stated.model_error_orientation;
}

/// Under which model error the first step is taken, where that is to be found.
enum class FirstError { Stated, Found };

/// identify() that begins as `first` says. Sets `first` to Stated where nothing was found before
/// the first step, since little is left over.
Estimate identify_from(const Campaign& campaign, const Measurements& measurements,
                       const Parameters& start, const LevenbergMarquardtOptions& options,
                       FirstError& first) {
    const Campaign stated = detail::weighed_campaign(campaign, options.loss);
    Campaign found = stated;
    detail::IdentificationProblem problem = detail::make_problem(found, measurements);
    Estimate estimate = begin_estimate(problem, start);
    problem.loss = detail::complete_loss(options.loss, campaign);
    if (estimate.ending == Ending::NotIdentifiable) return estimate;
    const bool finds_error = options.finds_model_error && detail::is_model_error_open(campaign);
    const bool learns = options.finds_model_error && detail::are_sizes_open(campaign, options.loss);
    const bool is_open = finds_error || learns;
    detail::LinearisedSystem system;
    constexpr int rounds = 5;
    bool stays = !is_open;
    for (int round = 1; round == 1 || (!stays && round <= rounds); ++round) {
        if (round == 1 && !(is_open && first == FirstError::Found &&
                            leaves_far_more(problem, estimate.parameters))) {
            first = FirstError::Stated;
        } else if (is_open) {
            Campaign better =
                finds_error ? find_model_error(problem, estimate.parameters, stated) : stated;
            if (learns && is_credible(stated, better)) {
                better.spread = detail::learn_sizes(problem, estimate.parameters, stated.spread);
            }
            stays = round > 1 && is_alike(found, better);
            found = better;  // problem refers to it
            problem.units = detail::ParameterUnits(found);
        }
        estimate.ending = Ending::NotRun;
        system = search(problem, options, estimate, !stays && round < rounds);
        if (estimate.ending != Ending::Converged) break;
    }
    finish(problem, system, estimate);
    if (learns) {
        estimate.spread = found.spread;
        estimate.spread->is_open = false;
    }
    return estimate;
}

}  // namespace

Estimate identify(const Campaign& campaign, const Measurements& measurements,
                  const Parameters& start, const LevenbergMarquardtOptions& options) {
    constexpr double plainly = 0.5;
    FirstError first = FirstError::Found;
    Estimate estimate = identify_from(campaign, measurements, start, options, first);
    if (first == FirstError::Stated || !estimate.undetermined.empty()) return estimate;
    // Beside a few gross errors that is all. Where everything is far off, a joint's zero by 90 deg,
    // small errors stated lead farther.
    first = FirstError::Stated;
    const Estimate other = identify_from(campaign, measurements, start, options, first);
    return other.fit.rms() < plainly * estimate.fit.rms() ? other : estimate;
}

}  // namespace posewise
