#include "study_cases.hpp"

#include <algorithm>

#include "measurement/prior_rows.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr Index few_candidates = 200;

/// Among many candidates one start with few kicks finds choices whose criterion is half a percent
/// lower in the mean, which no calibration shows. Few candidates need more, and take no longer.
Index kick_count(Index candidates) {
    return std::clamp<Index>(2000 / candidates, 4, SelectOptions{}.kicks);
}
Index start_count(Index asked, Index candidates) {
    if (asked > 0) return asked;
    return candidates > few_candidates ? 1 : 4;
}

}  // namespace

std::vector<Index> usual_counts(Index least, Index most) {
    std::vector<Index> counts;
    for (const Index count : {8, 12, 16, 20, 30, 50}) {
        if (count >= least && count <= most) counts.push_back(count);
    }
    return counts;
}

void complete(StudyOptions& options, const Campaign& campaign) {
    options.criteria = options.criteria.value_or(std::vector{campaign.criterion});
    options.seed = options.seed.value_or(campaign.seed);
}

SelectOptions study_selection(const StudyOptions& options, const Campaign& campaign,
                              std::size_t criterion, Index pose_count, Index candidate_count) {
    SelectOptions selection;
    selection.criterion = options.criteria.value()[criterion];
    selection.pose_count = pose_count;
    selection.starts = start_count(options.starts, candidate_count);
    selection.kicks = kick_count(candidate_count);
    if (candidate_count <= few_candidates) {
        selection.proof = 0.01;  // often ends the search
    } else {
        selection.proof = 0;  // nobody asks for the bound
        selection.gap = 1e-3;
    }
    if (prior_count(campaign) > 0) selection.held_rows = detail::prior_rows(campaign);
    selection.least_distance = options.least_distance;
    selection.seed = options.seed.value();
    return selection;
}

void append_case(const StudyCase& study_case, std::vector<double>& values) {
    const HeldOut& held_out = study_case.held_out;
    values.insert(values.end(),
                  {study_case.identified ? 1.0 : 0.0, static_cast<double>(held_out.point_count),
                   held_out.rms, held_out.p95, held_out.max, study_case.expected});
    for (const Index pose : study_case.poses) values.push_back(static_cast<double>(pose));
}

StudyCase read_case(const double* values, std::size_t width) {
    StudyCase study_case;
    study_case.identified = values[0] != 0;
    study_case.held_out.point_count = static_cast<Index>(values[1]);
    study_case.held_out.rms = values[2];
    study_case.held_out.p95 = values[3];
    study_case.held_out.max = values[4];
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

namespace {

/// Split after split, so that a study that is stopped has some of them for all pose counts.
void order_by_split(const std::vector<TrialSeries>& series, std::vector<TrialId>& trials) {
    std::vector<std::vector<MeasuredCase>> cases;
    for (const TrialSeries& one : series) {
        cases.push_back(one.is_simulated ? std::vector<MeasuredCase>() : list_cases(one));
    }
    std::ranges::stable_sort(trials, {}, [&](const TrialId& id) {
        const auto& of_series = cases[static_cast<std::size_t>(id.series)];
        return of_series.empty() ? 0 : of_series[static_cast<std::size_t>(id.number)].split;
    });
}

}  // namespace

TrialRuns::TrialRuns(const std::vector<TrialSeries>& series, const StudyOptions& options)
    : series_(series), options_(options) {
    const Shard& shard = options.shard;
    if (shard.count < 1 || shard.number < 1 || shard.number > shard.count) {
        throw InputError("shard " + std::to_string(shard.number) + " of " +
                         std::to_string(shard.count) + ": must be from 1 to as many as there are");
    }
    const auto file = std::make_shared<ScratchFile>();
    for (const TrialSeries& one : series) {
        const auto table = std::make_shared<TrialTable>(file, trial_width(one));
        finished_.push_back(table);
        if (!options.store.finished) continue;
        options.store.finished(one, [&](const Trial& trial) { put_trial(one, trial, *table); });
    }
}

void TrialRuns::run(const RunTrials& run_trials, const std::vector<Index>& counts) {
    // Trials that are run at a time: of millions not even the numbers should be in memory.
    constexpr std::size_t most = std::size_t{1} << 16;
    const auto visit_open = [&](const std::function<void(const TrialId&)>& visitor) {
        Index asked = 0;
        for (std::size_t s = 0; s < series_.size(); ++s) {
            for (Index i = options_.shard.number - 1; i < counts[s]; i += options_.shard.count) {
                ++asked;
                if (!finished_[s]->has(i)) visitor({static_cast<Index>(s), i});
            }
        }
        return asked;
    };
    Index open_count = 0;
    Progress begin{.total = visit_open([&](const TrialId&) { ++open_count; })};
    begin.done = begin.total - open_count;
    ProgressCounter counter(options_.progress, begin);
    std::vector<TrialId> open;
    const auto run_open = [&] {
        order_by_split(series_, open);
        run_some(run_trials, open, counter);
        open.clear();
    };
    visit_open([&](const TrialId& id) {
        open.push_back(id);
        if (open.size() == most) run_open();
    });
    run_open();
}

void TrialRuns::run_some(const RunTrials& run_trials, const std::vector<TrialId>& open,
                         ProgressCounter& counter) {
    if (open.empty() || options_.stop.is_set()) return;
    const auto accept = [&](std::size_t position, std::vector<double> values) {
        const auto s = static_cast<std::size_t>(open[position].series);
        const Trial trial{open[position].number, std::move(values)};
        if (options_.store.keep) options_.store.keep(series_[s], trial);
        finished_[s]->put(trial);
        counter.count();
    };
    run_trials(open, accept, options_.stop);
}

Study TrialRuns::study_of_first(std::size_t series, Index count) const {
    return study_of_table(series_[series], finished_[series], count);
}

Study TrialRuns::study_of_all(std::size_t series) const {
    if (series_[series].is_simulated) finished_[series]->close_ranks();
    return study_of_table(series_[series], finished_[series], finished_[series]->count());
}

}  // namespace posewise::detail
