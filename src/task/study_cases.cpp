#include "study_cases.hpp"

#include <algorithm>

#include "../core/progress_counter.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr double proof_seconds = 0.01;

/// Of many candidates two kicks find choices as good as any, for all that calibrating can tell; of
/// few more are needed, and take no longer.
Index kick_count(Index candidates) {
    return std::clamp<Index>(2000 / candidates, 2, SelectOptions{}.kicks);
}

}  // namespace

std::vector<Index> usual_counts(Index least, Index most) {
    std::vector<Index> counts;
    for (const Index count : {8, 12, 16, 20, 30, 50}) {
        if (count >= least && count <= most) counts.push_back(count);
    }
    return counts;
}

SelectOptions study_selection(const StudyOptions& options, const Campaign& campaign,
                              std::size_t criterion, Index pose_count, Index candidate_count) {
    SelectOptions selection;
    selection.criterion = options.criteria[criterion];
    selection.pose_count = pose_count;
    selection.starts = options.starts;
    selection.kicks = kick_count(candidate_count);
    selection.proof = proof_seconds;
    if (campaign.spread.is_prior) selection.held = prior_information(campaign);
    selection.least_distance = options.least_distance;
    selection.seed = options.seed;
    return selection;
}

std::optional<Estimate> calibrate_subset(const Campaign& campaign, const Measurements& chosen) {
    const Registration start = register_base_and_targets(campaign, chosen);
    if (!start.is_determined()) return std::nullopt;
    Estimate estimate = identify(campaign, chosen, start.parameters);
    if (estimate.ending == Ending::NotIdentifiable) return std::nullopt;
    return estimate;
}

void append_case(const StudyCase& study_case, std::vector<double>& values) {
    const HeldOut& held_out = study_case.held_out;
    values.insert(
        values.end(),
        {study_case.identified ? 1.0 : 0.0, static_cast<double>(held_out.point_count),
         held_out.distance_rms, held_out.distance_p95, held_out.distance_max, study_case.expected});
    for (const Index pose : study_case.poses) values.push_back(static_cast<double>(pose));
}

StudyCase read_case(const double* values, std::size_t width) {
    StudyCase study_case;
    study_case.identified = values[0] != 0;
    study_case.held_out.point_count = static_cast<Index>(values[1]);
    study_case.held_out.distance_rms = values[2];
    study_case.held_out.distance_p95 = values[3];
    study_case.held_out.distance_max = values[4];
    study_case.expected = values[5];
    for (std::size_t k = case_width; k < width; ++k) {
        study_case.poses.push_back(static_cast<Index>(values[k]));
    }
    return study_case;
}

std::vector<MeasuredCase> list_cases(const TrialSeries& series) {
    const auto splits = static_cast<std::size_t>(std::max<Index>(1, series.splits));
    std::vector<MeasuredCase> cases;
    for (std::size_t row = 0; row < series.pose_counts.size(); ++row) {
        for (std::size_t i = 0; i < series.criteria.size() * splits; ++i) {
            cases.push_back({row, false, i / splits, static_cast<Index>(i % splits)});
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(series.random_subsets); ++i) {
            cases.push_back({row, true, i, static_cast<Index>(i % splits)});
        }
    }
    return cases;
}

TrialRuns::TrialRuns(const std::vector<TrialSeries>& series, const StudyOptions& options)
    : series_(series), options_(options), finished_(series.size()) {
    const Shard& shard = options.shard;
    if (shard.count < 1 || shard.number < 1 || shard.number > shard.count) {
        throw InputError("shard " + std::to_string(shard.number) + " of " +
                         std::to_string(shard.count) + ": must be from 1 to as many as there are");
    }
    if (!options.store.finished) return;
    for (std::size_t s = 0; s < series.size(); ++s) {
        for (Trial& trial : options.store.finished(series[s])) {
            finished_[s][trial.number] = std::move(trial.values);
        }
    }
}

void TrialRuns::run(const RunTrials& run_trials, const std::vector<Index>& counts) {
    std::vector<TrialId> open;
    Index asked = 0;
    for (std::size_t s = 0; s < series_.size(); ++s) {
        for (Index i = 0; i < counts[s]; ++i) {
            if (!options_.shard.has(i)) continue;
            ++asked;
            if (!finished_[s].contains(i)) open.push_back({static_cast<Index>(s), i});
        }
    }
    if (open.empty()) return;
    Progress begin{.total = asked};
    begin.done = asked - static_cast<Index>(open.size());
    ProgressCounter counter(options_.progress, begin);
    const auto accept = [&](std::size_t position, std::vector<double> values) {
        const TrialId& id = open[position];
        const auto s = static_cast<std::size_t>(id.series);
        Trial trial{id.number, std::move(values)};
        if (options_.store.keep) options_.store.keep(series_[s], trial);
        finished_[s][id.number] = std::move(trial.values);
        counter.count();
    };
    run_trials(open, accept, options_.stop);
}

std::vector<Trial> TrialRuns::list(std::size_t series, Index count) const {
    std::vector<Trial> trials;
    for (const auto& [number, values] : finished_[series]) {
        if (number < count) trials.push_back({number, values});
    }
    return trials;
}

std::vector<Trial> TrialRuns::release(std::size_t series) {
    auto& finished = finished_[series];
    std::vector<Trial> trials;
    trials.reserve(finished.size());
    while (!finished.empty()) {
        auto first = finished.extract(finished.begin());
        trials.push_back({first.key(), std::move(first.mapped())});
    }
    return trials;
}

}  // namespace posewise::detail
