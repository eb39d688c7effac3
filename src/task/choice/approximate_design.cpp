#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "choice_problem.hpp"
#include "core/decompositions.hpp"
#include "criteria/information_function.hpp"
#include "criteria/prediction.hpp"
#include "criteria/row_value.hpp"
#include "posewise/core/errors.hpp"
#include "selection/bound.hpp"
#include "selection/relaxation.hpp"
#include "selection/validation.hpp"
#include "task/calibration/inputs.hpp"

namespace posewise {
namespace {

using detail::ChoiceProblem;

/// Heaviest first.
std::vector<WeightedCandidate> list_weights(const ChoiceProblem& problem, const VectorXd& weights) {
    std::vector<WeightedCandidate> list;
    for (Index i = 0; i < weights.size(); ++i) {
        if (weights[i] > 0) list.push_back({problem.ids[static_cast<std::size_t>(i)], weights[i]});
    }
    std::stable_sort(list.begin(), list.end(),
                     [](const auto& a, const auto& b) { return a.weight > b.weight; });
    return list;
}

double value_of(const ChoiceProblem& problem, const detail::Objective& objective,
                const VectorXd& weights) {
    return evaluate_rows(objective, detail::stack(problem.options.held_rows,
                                                  detail::weighted_rows(problem.blocks, weights)));
}

/// O2 and O4 are not concave, so that an ascent may end below a mere choice: that choice, and where
/// an ascent from it ends.
std::vector<VectorXd> weights_by_choice(const ChoiceProblem& problem,
                                        const detail::Objective& objective) {
    const Choice choice = select_poses(problem.blocks, problem.options);
    if (choice.poses.empty()) return {};
    VectorXd weights = VectorXd::Zero(problem.blocks.count());
    for (const Index pose : choice.poses) weights[pose] += 1;
    return {weights, relax(objective, problem.blocks, problem.options, weights).weights};
}

ApproximateDesign weigh(ChoiceProblem& problem, const ChoiceOptions& options) {
    if (!options.groups.empty() || options.least_distance > 0) {
        throw InputError(
            "weights keep neither groups nor a least distance; leave them out, or choose poses");
    }
    SelectOptions& stated = problem.options;
    stated.stop = options.stop;
    detail::validate(problem.blocks, stated);
    const std::string reason = detail::describe_unidentified(problem.blocks, stated);
    if (!reason.empty()) throw InputError(reason);
    const detail::Objective objective = detail::make_objective(problem.blocks, stated);
    const detail::Relaxation relaxation = relax(objective, problem.blocks, stated);
    ApproximateDesign design;
    design.request = problem.request;
    design.candidate_count = problem.blocks.count();
    VectorXd weights = relaxation.weights;
    design.value = value_of(problem, objective, weights);
    if (!detail::has_information_function(stated.criterion)) {
        for (const VectorXd& others : weights_by_choice(problem, objective)) {
            const double value = value_of(problem, objective, others);
            if (!(value > design.value)) continue;
            design.value = value;
            weights = others;
        }
    }
    design.weights = list_weights(problem, weights);
    if (!std::isfinite(design.value)) {
        throw InputError(fmt::format(
            "no weights were found that identify all {} parameters; scale columns to about one "
            "size, add candidates or state a prior",
            problem.blocks.parameter_count()));
    }
    design.bound = std::max(relaxation.bound, design.value);
    design.efficiency = detail::efficiency(
        stated.criterion, design.value, design.bound,
        problem.blocks.parameter_count() - static_cast<Index>(stated.nuisance.size()));
    design.ending = options.stop.ending_or(Ending::Converged);
    return design;
}

}  // namespace

ApproximateDesign relax_choice(const Campaign& campaign, Candidates candidates,
                               const ChoiceOptions& options) {
    const std::optional<Measurements> measured = candidates.measured;
    ChoiceProblem problem = detail::state_choice(campaign, std::move(candidates), options,
                                                 options.stop.with_half_the_time());
    detail::judge_candidates(campaign, measured, options);
    ApproximateDesign design = detail::compute_from(detail::name_of(problem.request.sources),
                                                    [&] { return weigh(problem, options); });
    design.campaign = campaign.name;
    return design;
}

ApproximateDesign relax_choice(Blocks candidates, const ChoiceOptions& options) {
    ChoiceProblem problem = detail::state_choice(std::move(candidates), options);
    return detail::compute_from(detail::name_of(problem.request.sources),
                                [&] { return weigh(problem, options); });
}

}  // namespace posewise
