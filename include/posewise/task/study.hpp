#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/core/types.hpp"
#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/selection/choice.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"

namespace posewise {

/// Trials that differ only in their number: of one campaign, with the same options and seed. Two
/// series are equal if all of this is; each trial then has the same result, wherever it runs.
struct TrialSeries {
    bool is_simulated = false;        ///< simulated robots; else subsets of what was measured
    std::string campaign;             ///< its name
    std::string variation;            ///< "sensor.sigma_mm=0.05"; empty: none
    std::string checksum;             ///< for all else that a trial's numbers depend on
    std::uint64_t seed = 1;           ///< trial i draws from streams of `seed` and i
    std::vector<Criterion> criteria;  ///< by which poses are chosen
    std::vector<Index> pose_counts;   ///< in increasing order
    Index random_subsets = 0;         ///< for each count: in all, or (simulated) in each trial
    Index splits = 0;                 ///< for measured configurations
    Index test_count = 0;             ///< configurations that a trial is judged on
    std::vector<std::string> ids;     ///< measured configurations
    /// Of the errors that trials find.
    const AmountUnits* units = &length_units;

    bool operator==(const TrialSeries&) const = default;
};

/// Result of one trial.
struct Trial {
    Index number = 0;  ///< in its series, from 0
    std::vector<double> values;
};

using VisitTrial = std::function<void(const Trial&)>;

/// Where finished trials are kept, so that they never run again. All functions throw if they fail;
/// they are called by one thread at a time.
struct TrialStore {
    /// Visits all finished trials of the series, in the order of their numbers.
    std::function<void(const TrialSeries&, const VisitTrial&)> finished;
    /// Once this returns, the trial is kept, whatever happens to the process.
    std::function<void(const TrialSeries&, const Trial&)> keep;
};

/// The share of all trials to run: numbers `number` - 1, `number` - 1 + `count`, ...
struct Shard {
    Index number = 1;
    Index count = 1;

    bool has(Index trial) const { return trial % count == number - 1; }
};

/// One of the trials to run: its series, by position in a list, and its number there.
struct TrialId {
    Index series = 0;
    Index number = 0;
};

/// Runs one trial; called by any thread, of any process of the crew.
using ComputeTrial = std::function<std::vector<double>(const TrialId&)>;
/// Receives the result of the trial at that position of a list; called by one thread at a time.
using AcceptTrial = std::function<void(std::size_t position, std::vector<double> values)>;
/// Runs trials in any order; returns when all are accepted or, if stopped, after those in flight.
/// What one throws is thrown here.
using RunTrials =
    std::function<void(const std::vector<TrialId>&, const AcceptTrial&, const StopSignal& stop)>;

/// Who runs the trials of a study. It calls `lead` in the leading process, with a function to run
/// trials by; other processes compute what the leader hands them until it returns. All processes
/// must come here with the same `compute`, and only once: those that do not lead may end here.
using TrialCrew = std::function<void(const ComputeTrial& compute,
                                     const std::function<void(const RunTrials&)>& lead)>;

/// The crew of one process: its threads.
void run_on_threads(const ComputeTrial& compute, const std::function<void(const RunTrials&)>& lead);

/// How far a calibrated robot is off at configurations it was not calibrated with: distances, m;
/// where no length is measured, angles, rad, or distances in a camera's image, 1000 px.
struct HeldOut {
    Index point_count = 0;  ///< 0: there were none
    double rms = 0;
    double p95 = 0;
    double max = 0;
};

/// How well one subset calibrates the robot.
struct StudyCase {
    std::vector<Index> poses;
    bool identified = false;  ///< false: these poses cannot identify the model
    /// Means of the configurations that the split holds out, else of all that were not chosen;
    /// means, so that repeat noise does not blur the comparison. No points if none is left.
    HeldOut held_out;
    double expected = 0;  ///< held_out.rms as the calibration expects it
    Index split = 0;
};

/// Cases in order. Those of simulated studies, perhaps millions, are not in memory: each is read on
/// demand.
class StudyCases {
  public:
    using Read = std::function<StudyCase(std::size_t)>;  ///< the case with that number

    StudyCases() = default;
    StudyCases(std::vector<StudyCase> cases);
    StudyCases(std::initializer_list<StudyCase> cases) : StudyCases(std::vector(cases)) {}
    StudyCases(std::size_t size, Read read) : size_(size), read_(std::move(read)) {}

    std::size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    StudyCase operator[](std::size_t number) const { return read_(number); }

    class Iterator {
      public:
        using iterator_category = std::input_iterator_tag;
        using value_type = StudyCase;
        using difference_type = std::ptrdiff_t;
        using pointer = const StudyCase*;
        using reference = StudyCase;

        Iterator() = default;
        Iterator(const StudyCases& cases, std::size_t number) : cases_(&cases), number_(number) {}
        StudyCase operator*() const { return (*cases_)[number_]; }
        Iterator& operator++() {
            ++number_;
            return *this;
        }
        Iterator operator++(int) { return std::exchange(*this, Iterator(*cases_, number_ + 1)); }
        bool operator==(const Iterator&) const = default;

      private:
        const StudyCases* cases_ = nullptr;
        std::size_t number_ = 0;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, size_}; }

  private:
    std::size_t size_ = 0;
    Read read_;
};

/// All subsets of one size, from the splits that are finished.
struct StudyRow {
    Index pose_count = 0;
    StudyCases optimal;  ///< for each criterion, one per split
    StudyCases random;   ///< for each split in turn
};
/// Number of finished splits, in a study of `criterion_count` criteria; 1 if nothing is held out.
Index split_count(const StudyRow& row, std::size_t criterion_count);

/// Fewer poses to judge on say little of others.
constexpr Index least_judged = 4;

struct StudyOptions {
    /// By which poses are chosen; nothing: the campaign's. An empty list: random subsets only.
    std::optional<std::vector<Criterion>> criteria{};
    /// Empty: from the least identifying count to all but one (of fewer than 50 configurations: all
    /// but a fifth, at least 4, where that many identify); with splits 8, 12, 16, 20, 30, 50 up
    /// to a third of the configurations to choose from.
    std::vector<Index> pose_counts;
    Index random_subsets = 100;
    /// Random splits of the configurations into those to choose from and those to judge all subsets
    /// on. 0: none; each subset is judged on all that it leaves, so a plan that takes the
    /// informative configurations is judged on easier ones. Nothing: 10 if a split leaves three
    /// times the largest pose count to choose from, else 0.
    std::optional<Index> splits{};
    /// Share of the configurations that a split judges on; nothing: 0.3.
    std::optional<double> holdout{};
    double least_distance = 0;  ///< rad, between any two in a planned subset, see PlanRequest
    Index starts = 0;           ///< 0: 4, or 1 where a split has over 200 candidates
    std::optional<std::uint64_t> seed{};  ///< for all draws; nothing: the campaign's
    /// For measured configurations: judges the calibration with all of them, before any case is
    /// run.
    JudgeCalibration judge = refuse_faults;
    TrialStore store{};               ///< keeps finished cases; none: they are run anew
    TrialCrew crew = run_on_threads;  ///< runs the cases
    Shard shard{};                    ///< share of the cases to run
    StopSignal stop{};                ///< ends it with the finished splits
    ProgressCallback progress{};      ///< counts cases
};

/// Accuracy against number of poses.
struct Study {
    std::string campaign;             ///< its name
    std::vector<std::string> ids;     ///< names of the configurations
    std::vector<Criterion> criteria;  ///< that chose poses, in StudyRow::optimal's order
    std::vector<StudyRow> rows;       ///< none if there is nothing to study
    Ending ending = Ending::NotRun;
    /// If it is NotIdentifiable: why not even all configurations identify the model.
    std::string undetermined;
    Index splits = 0;           ///< 0: each subset was judged on the rest
    Index test_count = 0;       ///< configurations that each split judges on
    std::string model{};        ///< which of several error models (compare_models()) or variations
    bool is_simulated = false;  ///< each split is a simulated robot (simulate_study())
    const AmountUnits* units = &length_units;  ///< of the errors
};

/// Chooses k of the measured configurations by each criterion and at random, calibrates with them
/// from registration on, and judges on held-out configurations: the same ones for all subsets of a
/// split. Independent of the number of threads. Throws InputError for measurements of another robot
/// (check_is_of_robot()), for those that are no calibration (StudyOptions::judge), for a pose count
/// that is not in [1, configurations], for a least distance that so large a plan cannot keep, and
/// for other options out of range.
Study study(const Campaign& campaign, const Measurements& measurements,
            const StudyOptions& options = {});

/// Builds a study from the finished trials of a series in a store, which may be fewer than the
/// series has. Unfinished splits of measured configurations are left out, and pose counts without
/// any. Throws InputError for trials that do not belong to it.
Study study_of_trials(const TrialSeries& series, const TrialStore& store);

/// Keeps only the pose counts and splits that all studies have; no change if one is simulated.
void keep_common(std::vector<Study>& studies);

/// A robot with one of the error models to compare.
struct RobotModel {
    std::string name;
    Campaign campaign;
};
/// The study with each error model of one robot: same splits and random subsets, and same pose
/// counts (by default from the largest of the models' least ones). One study each, in that order;
/// if it is stopped, with the splits that are finished in all. Throws as study() does.
std::vector<Study> compare_models(const std::vector<RobotModel>& models,
                                  const Measurements& measurements,
                                  const StudyOptions& options = {});

/// Planned subsets against random ones.
struct Advantage {
    double ratio = 1;  ///< geometric mean over the splits of planned / median of random
    /// 95 % interval of the ratio, by Student's t of the logarithms; for one split the ratio
    /// itself.
    double lower = 1;
    double upper = 1;  ///< upper end
    /// Splits that it is not over: half of their random subsets do not identify the model.
    Index left_out = 0;

    bool is_of_one_split() const { return lower == upper; }
};
/// For the criterion of that number in one row of a study with splits. Nothing if a planned subset
/// does not identify the model, or if all splits are left out.
std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion);

/// As above, against the random subsets of another row (of another error model), over the splits
/// that both have.
std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion, const StudyRow& other_row);

/// What the whole interval of an advantage says: below 1, above 1, or neither (as with one split).
enum class Verdict { Better, WithinChance, Loses };
Verdict verdict_of(const Advantage& advantage);
/// "better", "within chance", "loses".
std::string_view verdict_name(Verdict verdict);

/// The planned cases of one criterion in a row, out of `criterion_count` criteria.
StudyCases planned_cases(const StudyRow& row, std::size_t criterion, std::size_t criterion_count);

/// p-quantile (0..1, linear between order statistics) of the held-out RMS. Unidentified
/// cases count as worse than any other, so that dropping them cannot flatter the rest. Nothing if
/// the quantile falls among them or nothing was held out.
std::optional<double> held_out_quantile(const StudyCases& cases, double p);

/// Median of StudyCase::expected over the identified cases; nothing if there is none.
std::optional<double> median_expected(const StudyCases& cases);

/// Number of cases that are not identified.
Index count_unidentified(const StudyCases& cases);

/// A campaign to simulate, one of several variations.
struct SimulatedCampaign {
    std::string variation;  ///< what is its own: "sensor.sigma_mm=0.05"; empty: it is alone
    Campaign campaign;      ///< what poses are chosen for and robots are calibrated with
    /// Robots are drawn from this campaign. It may have errors that the other does not know,
    /// but the same joints and targets. It takes base and targets from the other if it states none.
    /// Nothing: the other.
    std::optional<Campaign> truth{};
};

/// Ignores StudyOptions::splits and holdout; random_subsets are those of each trial.
struct SimulatedStudyOptions : StudyOptions {
    SimulatedStudyOptions() { random_subsets = 1; }
    /// Number of simulated robots; with a precision, at most.
    Index trials = 100;
    /// Relative half width of the 95 % interval of planned against random that every pose count and
    /// criterion must reach (without random subsets, that of the planned error's geometric mean).
    /// The trials of a campaign end when it is reached. 0: all trials are run.
    double precision = 0;
    Index pool_count = 2000;  ///< configurations to choose from, minus those the cell forbids
    Index test_count = 200;   ///< workspace configurations that each robot is judged at
    Index repeats = 1;        ///< samples per configuration
    bool is_refined = false;  ///< planned like make_plan(), not only chosen from the pool
};

/// Accuracy against number of poses for a robot that nobody has measured yet. Draws robots
/// (draw_robot()), measures each at configurations chosen for the nominal one by each criterion and
/// at equally many random ones, calibrates, and judges target positions at workspace configurations
/// that were not chosen for: true positions, with model error and repeatability of one visit,
/// against the calibrated model's. The poses to choose from are those that the cell allows.
///
/// One study per campaign, in their order, with one split per robot; robots are as alike as the
/// campaigns are, draw by draw. Campaigns stopped before their first robot are left out, unless all
/// were. Empty in a process of a crew that does not lead. The same result for any crew, shards and
/// order. Throws InputError for options out of range, for a campaign that make_plan() would refuse
/// or whose sensor has contacts, if the truth is another robot, and if the nominal poses do not
/// identify the model for any pose count.
std::vector<Study> simulate_study(const std::vector<SimulatedCampaign>& campaigns,
                                  const SimulatedStudyOptions& options = {});

/// Candidates that somebody else chose, by index; one listed twice is measured twice.
struct OwnSubset {
    std::string name;
    std::vector<Index> poses;
};

/// What is asked of plain blocks. ChoiceOptions::criterion and pose_count are not looked at.
struct BlocksStudyOptions : ChoiceOptions {
    std::vector<Criterion> criteria{Criterion::D};
    /// The numbers K of poses. The sizes of `subsets` are added to them.
    std::vector<Index> pose_counts{};
    Index random_subsets = 200;  ///< for each count; 0: none
    std::vector<OwnSubset> subsets{};
};

/// How much some subset tells.
struct SubsetValue {
    double value = 0;       ///< criterion; minus infinity: parameters are not identified
    double efficiency = 0;  ///< against the bound for its count, see Choice::efficiency
};

/// Quantiles of random subsets, each of value and of efficiency.
struct RandomBand {
    Index subsets = 0;       ///< how many were drawn; 0: none, and no quantiles
    Index unidentified = 0;  ///< how many of them do not identify the parameters
    SubsetValue p5, p50, p95;
};

/// What K poses can tell by one criterion.
struct BlocksStudyRow {
    Index pose_count = 0;
    Criterion criterion = Criterion::D;
    Choice chosen;  ///< without poses if no K candidates identify the parameters
    RandomBand random;
    /// BlocksStudy::subsets with as many poses, by number, and their values.
    std::vector<std::pair<std::size_t, SubsetValue>> own;
};

/// Value and efficiency against the number of poses.
struct BlocksStudy {
    Index candidate_count = 0;
    Index parameter_count = 0;
    PlanRequest request;  ///< complete, but for criterion and pose count
    std::vector<Criterion> criteria;
    std::vector<OwnSubset> subsets;
    std::vector<BlocksStudyRow> rows;  ///< by pose count, then in the order of the criteria
    Ending ending = Ending::NotRun;
};

/// For each count and criterion: the best choice with its proven bound, as select_poses() finds it,
/// random subsets (the same ones for all criteria) and the caller's own ones. Independent of the
/// number of threads. If it is stopped, with the counts that are finished. Throws InputError for
/// options as choose() does, for groups and a least distance, which random subsets do not keep, for
/// own subsets that are no choice of these candidates, and if no count identifies the parameters.
BlocksStudy study(Blocks candidates, const BlocksStudyOptions& options);

}  // namespace posewise
