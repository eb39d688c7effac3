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
#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/trials.hpp"

namespace posewise {

/// Distances that a calibrated robot is off by at configurations it was not calibrated with, m.
struct HeldOut {
    Index point_count = 0;  ///< 0: there were none
    double distance_rms = 0;
    double distance_p95 = 0;
    double distance_max = 0;
};

/// How well one subset calibrates the robot.
struct StudyCase {
    std::vector<Index> poses;
    bool identified = false;  ///< false: these poses cannot identify the model
    /// Means of the configurations held out of the split, else of all that were not chosen (so that
    /// repeat noise does not blur the comparison); no points if none is left.
    HeldOut held_out;
    double expected = 0;  ///< what the calibration says held_out.distance_rms will be
    Index split = 0;
};

/// Cases in order. Those of simulated studies, of which there may be millions, are not in memory:
/// each is read when it is asked for.
class StudyCases {
  public:
    using Read = std::function<StudyCase(std::size_t)>;  ///< the case of that number

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

/// All subsets of one size, of those splits that are finished.
struct StudyRow {
    Index pose_count = 0;
    StudyCases optimal;  ///< of each asked criterion one for each split
    StudyCases random;   ///< in turn of each split
};
/// How many splits are finished, of a study of so many criteria; 1 if nothing is held out.
Index split_count(const StudyRow& row, std::size_t criterion_count);

struct StudyOptions {
    std::vector<Criterion> criteria{Criterion::D};
    /// Empty: from the least identifying count to all but one; with splits 8, 12, 16, 20, 30, 50
    /// up to a third of what there is to choose from.
    std::vector<Index> pose_counts;
    Index random_subsets = 100;
    /// Splits of the configurations at random into those to choose from and those to judge all
    /// subsets on. 0: none, each subset is judged on all that it leaves, so that a plan that takes
    /// the telling configurations is judged on easier ones than others are. Nothing: 10, if what a
    /// split leaves to choose from is three times the largest pose count, else 0.
    std::optional<Index> splits{};
    double holdout = 0.3;       ///< part of the configurations that a split judges on
    double least_distance = 0;  ///< rad, of any two in a planned subset, as PlanRequest has it
    Index starts = 4;           ///< of the exchange
    std::uint64_t seed = 1;
    /// Of measured configurations: what all of them calibrate, before any case is run.
    JudgeCalibration judge = refuse_faults;
    TrialStore store{};               ///< of cases that are finished; none: they are run anew
    TrialCrew crew = run_on_threads;  ///< runs the cases
    Shard shard{};                    ///< of the cases that are run
    StopSignal stop{};                ///< ends it with the splits that are finished
    ProgressCallback progress{};      ///< of the cases
};

/// Accuracy against number of poses.
struct Study {
    std::string campaign;             ///< its name
    std::vector<std::string> ids;     ///< of the configurations
    std::vector<Criterion> criteria;  ///< by which were chosen, as StudyRow::optimal has them
    std::vector<StudyRow> rows;       ///< none if there is nothing to study
    Ending ending = Ending::NotRun;
    /// Where it is NotIdentifiable, why not even all configurations identify the model.
    std::string undetermined;
    Index splits = 0;           ///< 0: each subset was judged on what it leaves
    Index test_count = 0;       ///< configurations that each split judges on
    std::string model{};        ///< which of several error models (compare_models()), or variations
    bool is_simulated = false;  ///< a split is a robot that was drawn (simulate_study())
};

/// Chooses k of the measured configurations by each criterion and at random, calibrates with them
/// from registration on, and judges on configurations held out: the same ones for all subsets of a
/// split. The same result for any number of threads.
/// Throws InputError for measurements of another robot (check_is_of_robot()), for those that are no
/// calibration (StudyOptions::judge), for a pose count that
/// is not in [1, configurations], for a least distance that as many configurations do not keep, and
/// for other options out of range.
Study study(const Campaign& campaign, const Measurements& measurements,
            const StudyOptions& options = {});

/// The study that the finished trials of a series make which a store has; they may be fewer than
/// the series has. Splits of measured configurations that are not finished are left out, and pose
/// counts without any. Throws InputError for trials that are none of it.
Study study_of_trials(const TrialSeries& series, const TrialStore& store);

/// Leaves those pose counts and splits that all of the studies have.
void keep_common(std::vector<Study>& studies);

/// A robot with one of the error models to compare.
struct RobotModel {
    std::string name;
    Campaign campaign;
};
/// The same study with each error model of one robot: the same splits and random subsets, and the
/// same pose counts (by default from the largest of the models' least ones). One study each, in
/// that order; if it is stopped, with the splits that are finished in all. Throws as study() does.
std::vector<Study> compare_models(const std::vector<RobotModel>& models,
                                  const Measurements& measurements,
                                  const StudyOptions& options = {});

/// The planned subsets against random ones.
struct Advantage {
    double ratio = 1;  ///< geometric mean over the splits, planned / median of the random ones
    double lower = 1;  ///< its 95 % interval, by Student's t of the logarithms; of one split the
    double upper = 1;  ///< ratio itself

    bool is_of_one_split() const { return lower == upper; }
};
/// Of the criterion of that number in one row of a study with splits. Nothing where a planned
/// subset or half of the random ones of a split do not identify the model.
std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion);

/// The same against the random subsets of another row, that of another error model, over the splits
/// that both have.
std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion, const StudyRow& other_row);

/// What an advantage says, its whole interval: below 1, above 1, or neither.
enum class Verdict { Better, WithinChance, Loses };
Verdict verdict_of(const Advantage& advantage);
/// "better", "within chance", "loses".
std::string_view verdict_name(Verdict verdict);

/// The planned cases of one of so many criteria in a row.
StudyCases planned_cases(const StudyRow& row, std::size_t criterion, std::size_t criterion_count);

/// The p-quantile (0..1, linear between order statistics) of the held-out distance RMS. Cases that
/// are not identified count as worse than any other, so that dropping them cannot flatter the rest;
/// nothing if the quantile falls among them or nothing was left out.
std::optional<double> held_out_quantile(const StudyCases& cases, double p);

/// The median of StudyCase::expected over those that are identified, m; nothing if none is.
std::optional<double> median_expected(const StudyCases& cases);

/// How many cases are not identified.
Index count_unidentified(const StudyCases& cases);

}  // namespace posewise
