#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <memory>

#include "posewise/core/errors.hpp"
#include "posewise/task/study.hpp"
#include "study_cases.hpp"

namespace posewise {
namespace {

using detail::case_width;
using detail::MeasuredCase;
using detail::TrialTable;

InputError wrong_trial(const TrialSeries& series, const Trial& trial, const std::string& fault) {
    return InputError(fmt::format("trial {} of {} {}", trial.number, series.campaign, fault));
}

std::vector<StudyRow> measured_rows(const TrialSeries& series, const TrialTable& table) {
    const std::vector<MeasuredCase> cases = detail::list_cases(series);
    const auto splits = static_cast<std::size_t>(std::max<Index>(1, series.splits));
    struct Row {
        std::vector<StudyCase> optimal, random;  // in the order of their trials
        std::vector<Index> open;                 // cases, of each split
    };
    std::vector<Row> rows(series.pose_counts.size(), {{}, {}, std::vector<Index>(splits)});
    std::size_t next = 0;
    const auto take = [&](const MeasuredCase& one, const StudyCase& found) {
        (one.is_random ? rows[one.row].random : rows[one.row].optimal).push_back(found);
        (one.is_random ? rows[one.row].random : rows[one.row].optimal).back().split = one.split;
    };
    const auto take_open_before = [&](std::size_t number) {
        for (; next < number; ++next) {
            take(cases[next], {});
            ++rows[cases[next].row].open[static_cast<std::size_t>(cases[next].split)];
        }
    };
    table.for_each([&](const Trial& trial) {
        take_open_before(static_cast<std::size_t>(trial.number));
        take(cases[next++], detail::read_case(trial.values.data(), trial.values.size()));
    });
    take_open_before(cases.size());
    std::vector<StudyRow> finished;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        auto& [optimal, random, open] = rows[i];
        const auto is_open = [&open = open](const StudyCase& one) {
            return open[static_cast<std::size_t>(one.split)] > 0;
        };
        std::erase_if(optimal, is_open);
        std::erase_if(random, is_open);
        if (optimal.empty()) continue;
        finished.push_back({series.pose_counts[i], std::move(optimal), std::move(random)});
    }
    return finished;
}

/// A split a trial.
std::vector<StudyRow> simulated_rows(const TrialSeries& series,
                                     const std::shared_ptr<const TrialTable>& table, Index count) {
    if (count == 0) return {};
    const auto trials = static_cast<std::size_t>(count);
    // A trial has its cases one after the other; of each row those of one criterion, or random ones
    // of one number, are together.
    const auto cases_from = [&](std::size_t first, std::size_t kinds) {
        return StudyCases(kinds * trials, [=](std::size_t number) {
            std::array<double, case_width> values{};
            const auto trial = static_cast<Index>(number % trials);
            table->read(trial, (first + number / trials) * case_width, values);
            StudyCase study_case = detail::read_case(values.data(), case_width);
            study_case.split = trial;
            return study_case;
        });
    };
    const std::size_t planned = series.criteria.size();
    const auto random = static_cast<std::size_t>(series.random_subsets);
    std::vector<StudyRow> rows;
    std::size_t first = 0;
    for (const Index pose_count : series.pose_counts) {
        rows.push_back(
            {pose_count, cases_from(first, planned), cases_from(first + planned, random)});
        first += planned + random;
    }
    return rows;
}

}  // namespace

std::size_t detail::trial_width(const TrialSeries& series) {
    const std::size_t counts = series.pose_counts.size();
    if (counts == 0) return 0;
    if (!series.is_simulated) {
        return case_width + static_cast<std::size_t>(std::ranges::max(series.pose_counts));
    }
    return counts * (series.criteria.size() + static_cast<std::size_t>(series.random_subsets)) *
           case_width;
}

void detail::put_trial(const TrialSeries& series, const Trial& trial, TrialTable& table) {
    const std::size_t size = trial.values.size();
    const std::size_t width = trial_width(series);
    if (series.is_simulated && size != width) {
        throw wrong_trial(series, trial, fmt::format("has {} numbers, must have {}", size, width));
    }
    const Index of_count =
        static_cast<Index>(series.criteria.size()) * std::max<Index>(1, series.splits) +
        series.random_subsets;
    const Index cases = std::ssize(series.pose_counts) * of_count;
    const bool is_measured_case = trial.number < cases && size >= case_width && size <= width;
    if (trial.number < 0 || !(series.is_simulated || is_measured_case)) {
        throw wrong_trial(series, trial, "is none of it");
    }
    table.put(trial);
}

Study detail::study_of_table(const TrialSeries& series, std::shared_ptr<const TrialTable> table,
                             Index count) {
    Study study;
    study.campaign = series.campaign;
    study.model = series.variation;
    study.ids = series.ids;
    study.units = series.units;
    study.criteria = series.criteria;
    study.is_simulated = series.is_simulated;
    study.splits = series.is_simulated ? count : series.splits;
    study.test_count = series.test_count;
    study.ending = Ending::Converged;
    study.rows =
        series.is_simulated ? simulated_rows(series, table, count) : measured_rows(series, *table);
    return study;
}

Study study_of_trials(const TrialSeries& series, const TrialStore& store) {
    const auto table = std::make_shared<TrialTable>(std::make_shared<detail::ScratchFile>(),
                                                    detail::trial_width(series));
    store.finished(series, [&](const Trial& trial) { detail::put_trial(series, trial, *table); });
    if (series.is_simulated) table->close_ranks();
    return detail::study_of_table(series, table, table->count());
}

}  // namespace posewise
