#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/progress_counter.hpp"
#include "core/statistics.hpp"
#include "posewise/selection/choice.hpp"
#include "posewise/task/study.hpp"
#include "trial_table.hpp"

/// What studies of measured and of simulated configurations share.
namespace posewise::detail {

/// The pose counts that studies look at, those from `least` to `most`.
std::vector<Index> usual_counts(Index least, Index most);

/// Fills in criteria and seed where none are stated.
void complete(StudyOptions& options, const Campaign& campaign);

/// How a study chooses from so many candidates: quickly, for one case of many.
SelectOptions study_selection(const StudyOptions& options, const Campaign& campaign,
                              std::size_t criterion, Index pose_count, Index candidate_count);

/// Of ratios whose logarithms are visited; nothing if there are none or one is a NaN.
std::optional<Advantage> geometric_mean(const VisitNumbers& logarithms);

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

/// How many numbers a trial of the series has, at most. Of simulated ones all have as many.
std::size_t trial_width(const TrialSeries& series);

/// Puts it into the table of the series. Throws InputError if it is none of it.
void put_trial(const TrialSeries& series, const Trial& trial, TrialTable& table);

/// The study that they make, of simulated ones that of the first `count` trials, all of which must
/// be there: numbers 0, 1, ...
Study study_of_table(const TrialSeries& series, std::shared_ptr<const TrialTable> table,
                     Index count);

/// Trials of some series: those that a store has, and those that are run.
class TrialRuns {
  public:
    /// Reads what the store has. Both must live as long as this.
    TrialRuns(const std::vector<TrialSeries>& series, const StudyOptions& options);

    /// Runs those among the first counts[s] trials of each series that are not finished and of the
    /// shard.
    void run(const RunTrials& run_trials, const std::vector<Index>& counts);

    /// Of the first `count` trials of a simulated series, all of which must be finished.
    Study study_of_first(std::size_t series, Index count) const;
    /// Of all that are finished, in the end: nothing can be run any more.
    Study study_of_all(std::size_t series) const;

  private:
    void run_some(const RunTrials& run_trials, const std::vector<TrialId>& open,
                  ProgressCounter& counter);

    const std::vector<TrialSeries>& series_;
    const StudyOptions& options_;
    std::vector<std::shared_ptr<TrialTable>> finished_;
};

}  // namespace posewise::detail
