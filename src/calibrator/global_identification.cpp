#include "global_identification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.hpp"
#include "core/progress_counter.hpp"
#include "covariance_adaptation.hpp"
#include "least_squares.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {

VectorXd error_bounds(const Chain& robot, const GlobalOptions& options) {
    VectorXd bounds = VectorXd::Zero(robot.parameter_count());
    for (Index k = 0; k < bounds.size(); ++k) {
        if (robot.parameter_term(k) != nullptr) continue;
        const Element& element = robot.parameter_element(k);
        bounds[k] =
            element.motion == Motion::Rotation
                ? options.angle
                : std::max(options.length_share * std::abs(element.value), options.least_length);
    }
    return bounds;
}

Registration register_roughly_with_errors(const Campaign& campaign,
                                          const Measurements& measurements,
                                          const VectorXd& robot_errors) {
    std::vector<Element> elements = campaign.robot.elements();
    Index next = 0;
    for (Element& element : elements) {
        if (!element.parameter.empty()) element.value += robot_errors[next++];
        next += static_cast<Index>(element.terms.size());
    }
    const Chain moved = campaign.robot.with_elements(std::move(elements));
    Registration registered = register_roughly(with_robot(campaign, moved), measurements);
    registered.parameters.robot = robot_errors;
    return registered;
}

}  // namespace posewise::detail

namespace posewise {
namespace {

/// Starts run together; fixed, so that what comes out does not depend on the number of threads.
constexpr Index batch_size = 8;

void check_options(const Campaign& campaign, const GlobalOptions& options) {
    const auto check = [](const char* name, double value, double most) {
        if (value >= 0 && value <= most) return;
        throw InputError(fmt::format("{} is {}, must be from 0 to {}", name, value, most));
    };
    check("length_share", options.length_share, 1);
    check("least_length", options.least_length, 10);
    check("angle", options.angle, std::numbers::pi);
    if (options.start_limit < 1 || options.agreeing_starts < 1 || options.evaluation_limit < 1) {
        throw InputError("start_limit, agreeing_starts and evaluation_limit must be at least 1");
    }
    if (campaign.spread.is_prior) {
        throw InputError(
            "expected sizes are priors, which say that errors are small; a global search, for a "
            "robot that is far from nominal, must be without them (prior: false)");
    }
}

/// The nominal robot, then random ones or those that a search with another seed finds.
VectorXd draw_errors(const detail::IdentificationProblem& problem, const VectorXd& bounds,
                     const GlobalOptions& options, Index start) {
    VectorXd errors = VectorXd::Zero(bounds.size());
    if (start == 0) return errors;
    RandomStream stream(options.seed, static_cast<std::uint64_t>(start));
    if (options.search == StartSearch::CmaEs) {
        return detail::adapt_covariance(problem.campaign, problem.means, bounds,
                                        options.evaluation_limit, stream);
    }
    for (Index k = 0; k < bounds.size(); ++k) errors[k] = stream.uniform(-bounds[k], bounds[k]);
    return errors;
}

/// One run from a start.
struct Run {
    Estimate estimate;
    double cost = std::numeric_limits<double>::infinity();  ///< where it could not be identified
};

Run run_from(const detail::IdentificationProblem& problem, const VectorXd& errors,
             const LevenbergMarquardtOptions& options) {
    Run run;
    Registration start =
        detail::register_roughly_with_errors(problem.campaign, problem.measurements, errors);
    if (!start.is_determined()) {
        run.estimate.ending = Ending::NotIdentifiable;
        run.estimate.undetermined = std::move(start.undetermined);
        return run;
    }
    run.estimate = identify(problem.campaign, problem.measurements, start.parameters, options);
    if (run.estimate.ending != Ending::NotIdentifiable) {
        run.cost = total_loss(problem, run.estimate.parameters);
    }
    return run;
}

}  // namespace

GlobalEstimate identify_globally(const Campaign& campaign, const Measurements& measurements,
                                 const GlobalOptions& options) {
    check_options(campaign, options);
    const detail::IdentificationProblem problem = detail::make_problem(campaign, measurements);
    const VectorXd bounds = detail::error_bounds(campaign.robot, options);
    detail::ProgressCounter counter(options.progress, options.start_limit);
    std::vector<Run> runs;
    GlobalEstimate result;
    result.estimate.undetermined = describe_missing_equations(problem);
    if (!result.estimate.undetermined.empty()) {
        result.estimate.ending = Ending::NotIdentifiable;
        return result;
    }
    const auto is_open = [&] {
        return result.starts < options.start_limit &&
               result.starts_at_best < options.agreeing_starts &&
               (result.starts == 0 || !options.start_options.stop.is_set());
    };
    while (is_open()) {
        const Index count = std::min(batch_size, options.start_limit - result.starts);
        runs.resize(static_cast<std::size_t>(result.starts + count));
        detail::for_each_index(count, [&](Index k) {
            const Index i = result.starts + k;
            runs[static_cast<std::size_t>(i)] =
                run_from(problem, draw_errors(problem, bounds, options, i), options.start_options);
            counter.count();
        });
        result.starts += count;
        const Run& best = *std::min_element(
            runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.cost < b.cost; });
        result.estimate = std::isfinite(best.cost) ? best.estimate : runs.front().estimate;
        if (!std::isfinite(best.cost)) continue;
        const double alike = best.cost * (1 + 1e-6) + 1e-12;
        result.starts_at_best = std::count_if(
            runs.begin(), runs.end(), [alike](const Run& run) { return run.cost <= alike; });
    }
    return result;
}

}  // namespace posewise
