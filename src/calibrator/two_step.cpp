#include <fmt/format.h>

#include "core/decompositions.hpp"
#include "least_squares.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

/// Splits the unknowns as the two steps do: base and targets, and the robot's parameters between.
struct Split {
    Index base;
    Index robot;
    Index sensor;

    MatrixXd base_and_targets(const MatrixXd& J) const {
        MatrixXd columns(J.rows(), base + sensor);
        columns << J.leftCols(base), J.rightCols(sensor);
        return columns;
    }
    VectorXd base_and_target_step(const VectorXd& d) const {
        VectorXd step = VectorXd::Zero(base + robot + sensor);
        step.head(base) = d.head(base);
        step.tail(sensor) = d.tail(sensor);
        return step;
    }
    VectorXd robot_step(const VectorXd& d) const {
        VectorXd step = VectorXd::Zero(base + robot + sensor);
        step.segment(base, robot) = d;
        return step;
    }
};

/// Both steps once [Wu et al. 2015, sec. 3.3]. The registration that `parameters` come from was a
/// step 1 (base and targets), so a cycle is step 2 (robot), then step 1. Step 1 is linear in the
/// targets and in the base's motion about its present pose, and is linearised anew in every cycle.
Parameters cycle(const detail::IdentificationProblem& problem, const Split& split,
                 Parameters parameters, double alpha) {
    if (split.robot > 0) {
        const detail::LinearisedSystem system = linearise(problem, parameters);
        const VectorXd step = detail::solve_least_squares(
            MatrixXd(system.J().middleCols(split.base, split.robot)), VectorXd(system.r()));
        parameters = advance(problem.campaign, parameters,
                             problem.units.step(split.robot_step(alpha * step)));
    }
    const detail::LinearisedSystem system = linearise(problem, parameters);
    const VectorXd step =
        detail::solve_least_squares(split.base_and_targets(system.J()), VectorXd(system.r()));
    return advance(problem.campaign, parameters,
                   problem.units.step(split.base_and_target_step(step)));
}

}  // namespace

Estimate identify_two_step(const Campaign& campaign, const Measurements& measurements,
                           const Parameters& start, const TwoStepOptions& options) {
    if (!(options.alpha > 0 && options.alpha <= 1)) {
        throw InputError(fmt::format("alpha is {:g}, must be in (0, 1]", options.alpha));
    }
    const detail::IdentificationProblem problem = detail::make_problem(campaign, measurements);
    const Split split{base_parameter_count(campaign), start.robot.size(), start.sensor.size()};
    Estimate estimate = begin_estimate(problem, start);
    if (estimate.ending == Ending::NotIdentifiable) return estimate;
    double cost = total_loss(problem, start);
    estimate.ending = Ending::IterationLimit;
    while (estimate.iterations < options.iteration_limit) {
        if (options.stop.is_set()) {
            estimate.ending = options.stop.ending_or(estimate.ending);
            break;
        }
        const Parameters moved = cycle(problem, split, estimate.parameters, options.alpha);
        const double moved_cost = total_loss(problem, moved);
        if (!(moved_cost < cost)) {
            estimate.ending = Ending::Converged;
            break;
        }
        const bool small = cost - moved_cost <= options.relative_tolerance * cost;
        estimate.parameters = moved;
        cost = moved_cost;
        ++estimate.iterations;
        if (small) {
            estimate.ending = Ending::Converged;
            break;
        }
    }
    finish(problem, linearise(problem, estimate.parameters), estimate);
    return estimate;
}

}  // namespace posewise
