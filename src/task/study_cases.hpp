#pragma once

#include <map>
#include <optional>
#include <vector>

#include "posewise/selection/exchange.hpp"
#include "posewise/task/study.hpp"

/// What studies of measured and of simulated configurations share.
namespace posewise::detail {

/// The pose counts that studies look at, those from `least` to `most`.
std::vector<Index> usual_counts(Index least, Index most);

/// How a study chooses from so many candidates: quickly, for one case of many.
SelectOptions study_selection(const StudyOptions& options, const Campaign& campaign,
                              std::size_t criterion, Index pose_count, Index candidate_count);

/// Calibrated from registration on; nothing if the measurements do not identify the model.
std::optional<Estimate> calibrate_subset(const Campaign& campaign, const Measurements& chosen);

/// Of at least one ratio, whose logarithms are given.
Advantage geometric_mean(const std::vector<double>& logarithms);

/// A case as numbers to keep: case_width of them and its poses.
inline constexpr std::size_t case_width = 6;
void append_case(const StudyCase& study_case, std::vector<double>& values);
/// The case whose numbers begin there; its poses are as many as fill `width`.
StudyCase read_case(const double* values, std::size_t width);

/// One case of a series of measured configurations, which is one trial of it.
struct MeasuredCase {
    std::size_t row = 0;  ///< of its pose count
    bool is_random = false;
    std::size_t number = 0;  ///< which criterion, or which random subset
    Index split = 0;
};
/// In the order of their trials.
std::vector<MeasuredCase> list_cases(const TrialSeries& series);

/// Trials of some series: those that a store has, and those that are run.
class TrialRuns {
  public:
    /// Reads what the store has. Both must live as long as this.
    TrialRuns(const std::vector<TrialSeries>& series, const StudyOptions& options);

    /// Runs those among the first counts[s] trials of each series that are not finished and of the
    /// shard.
    void run(const RunTrials& run_trials, const std::vector<Index>& counts);

    /// The finished ones of the first `count` trials of a series, by number.
    std::vector<Trial> list(std::size_t series, Index count) const;
    /// All that are finished; they are here no more: there may be millions.
    std::vector<Trial> release(std::size_t series);

  private:
    const std::vector<TrialSeries>& series_;
    const StudyOptions& options_;
    std::vector<std::map<Index, std::vector<double>>> finished_;
};

}  // namespace posewise::detail
