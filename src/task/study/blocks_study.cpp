#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "core/decompositions.hpp"
#include "core/parallel.hpp"
#include "core/statistics.hpp"
#include "core/text.hpp"
#include "criteria/row_value.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/task/study.hpp"
#include "selection/bound.hpp"
#include "selection/validation.hpp"
#include "task/calibration/inputs.hpp"
#include "task/choice/choice_problem.hpp"

namespace posewise {
namespace {

using detail::ChoiceProblem;

/// Stated for the first criterion that looks at test poses; the others do not see them.
ChoiceProblem state(Blocks candidates, const BlocksStudyOptions& options) {
    if (options.criteria.empty()) throw InputError("criteria are none; must be at least one");
    if (options.random_subsets < 0) {
        throw InputError(
            fmt::format("random subsets are {}, must be at least 0", options.random_subsets));
    }
    if (!options.groups.empty() || options.least_distance > 0) {
        throw InputError(
            "random subsets keep neither groups nor a least distance; leave them out of a study");
    }
    ChoiceOptions choice = options;
    const auto tested = std::ranges::find_if(options.criteria, needs_test_poses);
    choice.criterion = tested == options.criteria.end() ? options.criteria.front() : *tested;
    return detail::state_choice(std::move(candidates), choice);
}

/// Throws unless the limits of the study allow the choice, so that its bound holds for it.
void check_subset(const OwnSubset& subset, const ChoiceProblem& problem) {
    const auto error = [&](const std::string& what) {
        return InputError(fmt::format("subset {} {}", detail::quote(subset.name), what));
    };
    if (subset.poses.empty()) throw error("is empty; must have poses");
    std::map<Index, Index> times;
    for (const Index pose : subset.poses) {
        if (pose < 0 || pose >= problem.blocks.count()) {
            throw error(fmt::format("has candidate {}; must be from 0 to {}", pose,
                                    problem.blocks.count() - 1));
        }
        if (std::ranges::find(problem.options.excluded, pose) != problem.options.excluded.end()) {
            throw error(fmt::format("has candidate {}, which is excluded", pose));
        }
        if (++times[pose] > problem.options.repeat_limit) {
            throw error(fmt::format("has candidate {} {} times; the repeat limit is {}", pose,
                                    times[pose], problem.options.repeat_limit));
        }
    }
}

std::set<Index> counts_of(const BlocksStudyOptions& options) {
    std::set<Index> counts(options.pose_counts.begin(), options.pose_counts.end());
    for (const OwnSubset& subset : options.subsets) counts.insert(std::ssize(subset.poses));
    if (counts.empty()) throw InputError("pose counts are none; must be at least one");
    return counts;
}

/// The options of one choice.
SelectOptions options_of(const ChoiceProblem& problem, Criterion criterion, Index pose_count) {
    SelectOptions options = problem.options;
    options.criterion = criterion;
    options.pose_count = pose_count;
    if (!needs_test_poses(criterion)) options.test_poses = nullptr;
    return options;
}

/// The values of some subsets of one size against the bound for it.
class SubsetJudge {
  public:
    SubsetJudge(const ChoiceProblem& problem, const SelectOptions& options, double bound)
        : problem_(problem),
          options_(options),
          objective_(detail::make_objective(problem.blocks, options)),
          bound_(bound) {}

    SubsetValue judge(const std::vector<Index>& poses) const {
        const double value = detail::evaluate_rows(
            objective_, detail::stack(options_.held_rows, take(problem_.blocks, poses).matrix));
        if (!std::isfinite(value)) return {value, 0};
        return {value, detail::efficiency(options_.criterion, value, bound_,
                                          problem_.blocks.parameter_count())};
    }

    RandomBand judge_all(const std::vector<std::vector<Index>>& subsets) const {
        RandomBand band;
        band.subsets = std::ssize(subsets);
        if (subsets.empty()) return band;
        VectorXd values(band.subsets), efficiencies(band.subsets);
        detail::for_each_index(band.subsets, [&](Index i) {
            const SubsetValue one = judge(subsets[static_cast<std::size_t>(i)]);
            values[i] = one.value;
            efficiencies[i] = one.efficiency;
        });
        band.unidentified = band.subsets - values.array().isFinite().count();
        const auto quantile = [&](double p) {
            return SubsetValue{detail::quantile(values, p, detail::QuantileRule::Linear),
                               detail::quantile(efficiencies, p, detail::QuantileRule::Linear)};
        };
        band.p5 = quantile(0.05);
        band.p50 = quantile(0.5);
        band.p95 = quantile(0.95);
        return band;
    }

  private:
    const ChoiceProblem& problem_;
    const SelectOptions& options_;
    detail::Objective objective_;
    double bound_;
};

/// Of candidates that are not excluded, each at most once; none where these are too few. The stream
/// depends on size and number only, so more subsets or sizes change no other.
std::vector<std::vector<Index>> draw_subsets(const ChoiceProblem& problem, Index pose_count,
                                             Index subset_count) {
    const std::vector<Index> pool = all_but(problem.blocks.count(), problem.options.excluded);
    std::vector<std::vector<Index>> subsets;
    if (pose_count > std::ssize(pool)) return subsets;
    for (Index i = 0; i < subset_count; ++i) {
        const auto item =
            (static_cast<std::uint64_t>(pose_count) << 32) + static_cast<std::uint64_t>(i);
        std::vector<Index>& subset = subsets.emplace_back(
            RandomStream(problem.options.seed, item).subset(std::ssize(pool), pose_count));
        for (Index& pose : subset) pose = pool[static_cast<std::size_t>(pose)];
    }
    return subsets;
}

BlocksStudyRow make_row(const ChoiceProblem& problem, const SelectOptions& options,
                        const std::vector<std::vector<Index>>& random,
                        const std::vector<OwnSubset>& subsets) {
    BlocksStudyRow row;
    row.pose_count = options.pose_count;
    row.criterion = options.criterion;
    row.chosen = select_poses(problem.blocks, options);
    const SubsetJudge judge(problem, options, row.chosen.bound);
    row.random = judge.judge_all(random);
    for (std::size_t s = 0; s < subsets.size(); ++s) {
        if (std::ssize(subsets[s].poses) != row.pose_count) continue;
        row.own.emplace_back(s, judge.judge(subsets[s].poses));
    }
    return row;
}

/// Throws if no count identifies the parameters.
void check_any_identifies(const std::vector<BlocksStudyRow>& rows) {
    const auto identifies = [](const BlocksStudyRow& row) { return !row.chosen.poses.empty(); };
    if (rows.empty() || std::ranges::any_of(rows, identifies)) return;
    throw InputError(rows.back().chosen.undetermined);
}

}  // namespace

BlocksStudy study(Blocks candidates, const BlocksStudyOptions& options) {
    const ChoiceProblem problem = state(std::move(candidates), options);
    const std::string& name = detail::name_of(problem.request.sources);
    BlocksStudy study;
    study.candidate_count = problem.blocks.count();
    study.parameter_count = problem.blocks.parameter_count();
    study.request = problem.request;
    study.criteria = options.criteria;
    study.subsets = options.subsets;
    const std::set<Index> counts = counts_of(options);
    for (const OwnSubset& subset : options.subsets) check_subset(subset, problem);
    detail::compute_from(name, [&] {
        for (const Index end : {*counts.begin(), *counts.rbegin()}) {
            detail::validate(problem.blocks, options_of(problem, options.criteria.front(), end));
        }
    });
    const auto total = std::ssize(counts) * std::ssize(options.criteria);
    for (const Index count : counts) {
        const auto random = draw_subsets(problem, count, options.random_subsets);
        std::vector<BlocksStudyRow> rows;
        for (const Criterion criterion : options.criteria) {
            SelectOptions one = options_of(problem, criterion, count);
            one.stop = options.stop;
            rows.push_back(detail::compute_from(
                name, [&] { return make_row(problem, one, random, options.subsets); }));
            if (options.stop.is_set()) break;
            if (options.progress) {
                options.progress({std::ssize(study.rows) + std::ssize(rows), total});
            }
        }
        if (options.stop.is_set()) break;  // not the best, perhaps
        std::ranges::move(rows, std::back_inserter(study.rows));
    }
    study.ending = options.stop.ending_or(Ending::Converged);
    detail::compute_from(name, [&] { check_any_identifies(study.rows); });
    return study;
}

}  // namespace posewise
