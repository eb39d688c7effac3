#include <fmt/format.h>

#include <set>

#include "posewise/core/errors.hpp"
#include "posewise/task/study.hpp"
#include "study_cases.hpp"

namespace posewise {
namespace {

using detail::case_width;
using detail::MeasuredCase;

InputError wrong_trial(const TrialSeries& series, const Trial& trial, const std::string& fault) {
    return InputError(fmt::format("trial {} of {} {}", trial.number, series.campaign, fault));
}

/// A case of each trial of a subset, `splits` trials.
std::vector<StudyRow> empty_rows(const TrialSeries& series, std::size_t random,
                                 std::size_t splits) {
    std::vector<StudyRow> rows;
    for (const Index count : series.pose_counts) {
        StudyRow& row = rows.emplace_back();
        row.pose_count = count;
        row.optimal.resize(series.criteria.size() * splits);
        row.random.resize(random);
    }
    return rows;
}

std::vector<StudyRow> measured_rows(const TrialSeries& series, const std::vector<Trial>& trials) {
    const std::vector<MeasuredCase> cases = detail::list_cases(series);
    const auto splits = static_cast<std::size_t>(std::max<Index>(1, series.splits));
    auto rows = empty_rows(series, static_cast<std::size_t>(series.random_subsets), splits);
    std::vector<std::size_t> open(rows.size(),
                                  cases.size() / std::max<std::size_t>(1, rows.size()));
    for (const Trial& trial : trials) {
        const auto number = static_cast<std::size_t>(trial.number);
        if (trial.number < 0 || number >= cases.size() || trial.values.size() < case_width) {
            throw wrong_trial(series, trial, "is none of it");
        }
        const MeasuredCase& one = cases[number];
        StudyRow& row = rows[one.row];
        StudyCase& result =
            one.is_random ? row.random[one.number]
                          : row.optimal[one.number * splits + static_cast<std::size_t>(one.split)];
        result = detail::read_case(trial.values.data(), trial.values.size());
        result.split = one.split;
        --open[one.row];
    }
    std::vector<StudyRow> complete;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (open[i] == 0) complete.push_back(std::move(rows[i]));
    }
    return complete;
}

/// A split a trial.
std::vector<StudyRow> simulated_rows(const TrialSeries& series, const std::vector<Trial>& trials) {
    const std::size_t planned = series.criteria.size();
    const auto random = static_cast<std::size_t>(series.random_subsets);
    const std::size_t width = series.pose_counts.size() * (planned + random) * case_width;
    auto rows = empty_rows(series, random * trials.size(), trials.size());
    for (std::size_t t = 0; t < trials.size(); ++t) {
        if (trials[t].values.size() != width) {
            throw wrong_trial(
                series, trials[t],
                fmt::format("has {} numbers, must have {}", trials[t].values.size(), width));
        }
        const double* values = trials[t].values.data();
        const auto read_next = [&](StudyCase& study_case) {
            study_case = detail::read_case(values, case_width);
            study_case.split = static_cast<Index>(t);
            values += case_width;
        };
        for (StudyRow& row : rows) {
            for (std::size_t c = 0; c < planned; ++c) read_next(row.optimal[c * trials.size() + t]);
            for (std::size_t r = 0; r < random; ++r) read_next(row.random[r * trials.size() + t]);
        }
    }
    if (trials.empty()) rows.clear();
    return rows;
}

}  // namespace

Study study_of_trials(const TrialSeries& series, const std::vector<Trial>& trials) {
    Study study;
    study.campaign = series.campaign;
    study.model = series.variation;
    study.ids = series.ids;
    study.criteria = series.criteria;
    study.is_simulated = series.is_simulated;
    study.splits = series.is_simulated ? static_cast<Index>(trials.size()) : series.splits;
    study.test_count = series.test_count;
    study.ending = Ending::Converged;
    study.rows =
        series.is_simulated ? simulated_rows(series, trials) : measured_rows(series, trials);
    return study;
}

}  // namespace posewise
