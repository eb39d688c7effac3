#include "posewise/task/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "../core/checksum.hpp"
#include "inputs.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/selection/exchange.hpp"
#include "posewise/task/doubts.hpp"
#include "study_cases.hpp"

namespace posewise {
namespace {

/// Configurations to choose from, and those that all subsets are judged on (none: on the rest).
struct Split {
    std::vector<Index> pool;
    std::vector<Index> test;
    Blocks blocks;          ///< of the pool, at the registered parameters
    RowMatrixXd positions;  ///< of the pool, for distances; empty if none must be kept
};

/// What every case of a study shares.
struct Setting {
    const Campaign& campaign;
    const Measurements& measurements;
    const StudyOptions& options;
    std::vector<Split> splits;  ///< one of all configurations if nothing is held out
};

/// One subset to be chosen, calibrated with and judged; cases are independent of each other.
struct Job {
    Index pose_count = 0;
    StudyCase* result = nullptr;
    bool is_random = false;
    std::size_t number = 0;  ///< which criterion, or which random subset
};

/// Why not even all configurations identify the model; empty: they do.
std::string describe_undetermined(const Campaign& campaign, const Measurements& measurements,
                                  const Registration& registration) {
    if (!registration.is_determined()) return registration.undetermined;
    return identify(campaign, measurements, registration.parameters).undetermined;
}

void check_options(const StudyOptions& options) {
    if (options.random_subsets < 0 || options.starts < 1) {
        throw InputError("random subsets and starts must be at least 0 and 1, are " +
                         std::to_string(options.random_subsets) + " and " +
                         std::to_string(options.starts));
    }
    if (options.splits && *options.splits < 0) {
        throw InputError("splits are " + std::to_string(*options.splits) + ", must be at least 0");
    }
    if (!(options.holdout > 0 && options.holdout < 1)) {
        throw InputError(
            fmt::format("holdout is {:g}, must be above 0 and below 1", options.holdout));
    }
}

/// Configurations that a split judges on.
Index test_count(Index all, double holdout) {
    return std::clamp<Index>(std::lround(holdout * static_cast<double>(all)), 1, all - 1);
}

/// Of a study with splits, up to a third of the pool: beyond it all subsets are much the same.
std::vector<Index> usual_counts(Index pool, Index least) {
    std::vector<Index> counts;
    for (const Index count : {8, 12, 16, 20, 30, 50}) {
        if (count >= least && 3 * count <= pool) counts.push_back(count);
    }
    return counts;
}

/// `least`: that identify the model, looked at where none are asked for.
std::vector<Index> choose_pose_counts(const std::vector<Index>& asked, Index all, Index least,
                                      bool is_split) {
    for (const Index count : asked) {
        if (count < 1 || count > all) {
            throw InputError("a pose count is " + std::to_string(count) +
                             ", must be from 1 to the number of configurations" +
                             (is_split ? " to choose from, " : ", ") + std::to_string(all));
        }
    }
    if (!asked.empty()) return asked;
    std::vector<Index> counts = is_split ? usual_counts(all, least) : std::vector<Index>{};
    if (!counts.empty()) return counts;
    for (Index count = least; count < all; ++count) counts.push_back(count);
    if (counts.empty()) {
        throw InputError("a study needs " + std::to_string(least + 1) +
                         " configurations, as many as identify the model and one to judge on; " +
                         "there " + (all == 1 ? "is " : "are ") + std::to_string(all));
    }
    return counts;
}

/// Among several counts one may take all configurations; alone it would tell nothing.
void check_some_are_left(const std::vector<Index>& counts, Index all) {
    if (*std::min_element(counts.begin(), counts.end()) < all) return;
    throw InputError("the pose count is " + std::to_string(all) +
                     ", all configurations; must be less, so that some are left to judge on");
}

/// Splits if nobody states how many.
Index usual_splits(Index all, Index least, const StudyOptions& options) {
    constexpr Index splits = 10;
    if (all < 2) return 0;
    const Index pool = all - test_count(all, options.holdout);
    if (options.pose_counts.empty()) {
        return usual_counts(pool, least).empty() ? 0 : splits;
    }
    const auto& counts = options.pose_counts;
    return 3 * *std::max_element(counts.begin(), counts.end()) <= pool ? splits : 0;
}

std::vector<Split> make_splits(Index all, Index count, const StudyOptions& options) {
    std::vector<Split> splits;
    for (Index s = 0; s < count; ++s) {
        Split split;
        // Streams of cases begin at 2^32.
        split.test = RandomStream(options.seed, static_cast<std::uint64_t>(s))
                         .subset(all, test_count(all, options.holdout));
        split.pool = all_but(all, split.test);
        splits.push_back(std::move(split));
    }
    if (splits.empty()) splits.push_back({all_but(all, {}), {}, {}, {}});
    return splits;
}

/// Of the split's configurations; none if no choice identifies the model.
std::vector<Index> choose_poses(const Setting& setting, const Job& job, const Split& split) {
    const auto all = static_cast<Index>(split.pool.size());
    if (job.is_random) {
        // The stream depends on size and number only, so more subsets or sizes change no other.
        const auto item = (static_cast<std::uint64_t>(job.pose_count) << 32) + job.number;
        return RandomStream(setting.options.seed, item).subset(all, job.pose_count);
    }
    SelectOptions options =
        detail::study_selection(setting.options, setting.campaign, job.number, job.pose_count, all);
    options.positions = split.positions;
    return select_poses(split.blocks, options).poses;
}

/// A case that is "not identified" if its poses cannot be found or do not identify the model: that
/// is what a study is to show.
StudyCase run(const Setting& setting, const Job& job) {
    StudyCase result;
    result.split = job.result->split;
    const Split& split = setting.splits[static_cast<std::size_t>(result.split)];
    for (const Index chosen : choose_poses(setting, job, split)) {
        result.poses.push_back(split.pool[static_cast<std::size_t>(chosen)]);
    }
    if (result.poses.empty()) return result;
    const Measurements& measurements = setting.measurements;
    const auto estimate =
        detail::calibrate_subset(setting.campaign, take(measurements, result.poses));
    if (!estimate) return result;
    const auto judged =
        split.test.empty() ? all_but(measurements.configuration_count(), result.poses) : split.test;
    if (!judged.empty()) {
        const Measurements others = take(measurements, judged);
        const Metrics metrics =
            make_metrics(mean_residuals(setting.campaign, estimate->parameters, others),
                         setting.campaign.sensor->lengths_per_target());
        result.held_out = {metrics.point_count, metrics.distance_rms, metrics.distance_p95,
                           metrics.distance_max};
        result.expected = expected_error(setting.campaign, *estimate, others).total();
    }
    result.identified = true;
    return result;
}

/// The cases of all rows; pointers into `rows`, which must not be resized any more.
std::vector<Job> list_jobs(std::vector<StudyRow>& rows, std::size_t split_count) {
    std::vector<Job> jobs;
    for (StudyRow& row : rows) {
        for (std::size_t i = 0; i < row.optimal.size(); ++i) {
            row.optimal[i].split = static_cast<Index>(i % split_count);
            jobs.push_back({row.pose_count, &row.optimal[i], false, i / split_count});
        }
        for (std::size_t i = 0; i < row.random.size(); ++i) {
            row.random[i].split = static_cast<Index>(i % split_count);
            jobs.push_back({row.pose_count, &row.random[i], true, i});
        }
    }
    return jobs;
}

std::vector<StudyRow> make_rows(const std::vector<Index>& counts, const StudyOptions& options,
                                std::size_t split_count) {
    std::vector<StudyRow> rows;
    for (const Index count : counts) {
        StudyRow row;
        row.pose_count = count;
        row.optimal.resize(options.criteria.size() * split_count);
        row.random.resize(static_cast<std::size_t>(options.random_subsets));
        rows.push_back(std::move(row));
    }
    return rows;
}

/// Runs all cases; of a study that is stopped, or of a part of the cases, those rows stay that are
/// complete. False in a process that does not lead.
bool run_all(const Setting& setting, const TrialSeries& cases, std::vector<StudyRow>& rows) {
    const std::vector<Job> jobs = list_jobs(rows, setting.splits.size());
    const auto compute = [&](const TrialId& id) {
        std::vector<double> values;
        detail::append_case(run(setting, jobs[static_cast<std::size_t>(id.number)]), values);
        return values;
    };
    bool has_led = false;
    setting.options.crew(compute, [&](const RunTrials& run_trials) {
        const std::vector<TrialSeries> series{cases};
        detail::TrialRuns runs(series, setting.options);
        runs.run(run_trials, {static_cast<Index>(jobs.size())});
        std::set<Index> open;
        for (std::size_t k = 0; k < jobs.size(); ++k) {
            const auto found = runs.finished(0).find(static_cast<Index>(k));
            if (found == runs.finished(0).end()) {
                open.insert(jobs[k].pose_count);
                continue;
            }
            const Index split = jobs[k].result->split;
            *jobs[k].result = detail::read_case(found->second.data(), found->second.size());
            jobs[k].result->split = split;
        }
        std::erase_if(rows, [&](const StudyRow& row) { return open.contains(row.pose_count); });
        has_led = true;
    });
    return has_led;
}

/// What the cases depend on, in words and numbers.
TrialSeries series_of(const Study& study, const Setting& setting) {
    const StudyOptions& options = setting.options;
    TrialSeries series;
    series.campaign = study.campaign;
    series.variation = study.model;
    series.seed = options.seed;
    series.criteria = study.criteria;
    for (const StudyRow& row : study.rows) series.pose_counts.push_back(row.pose_count);
    series.random_subsets = options.random_subsets;
    series.splits = study.splits;
    series.test_count = study.test_count;
    series.ids = study.ids;
    detail::Checksum checksum;
    checksum.add(setting.measurements.configurations);
    checksum.add(setting.measurements.observations);
    for (const Split& split : setting.splits) checksum.add(split.blocks.matrix);
    checksum.add(fmt::format("{} {} {} {}", options.holdout, options.least_distance, options.starts,
                             setting.campaign.spread.is_prior));
    series.checksum = checksum.text();
    return series;
}

/// The least pose count that the defaults begin at; 0 if pose counts are asked for.
Index largest_least_count(const std::vector<RobotModel>& models, const StudyOptions& options) {
    Index least = 0;
    if (!options.pose_counts.empty()) return least;
    for (const RobotModel& model : models) {
        least = std::max(least, least_calibration_count(model.campaign));
    }
    return least;
}

/// With pose counts from `least` if none are asked for.
Study study_from(Index least, const RobotModel& model, const Measurements& measurements,
                 const StudyOptions& options) {
    const Campaign& campaign = model.campaign;
    const Registration registration = register_base_and_targets(campaign, measurements);
    check_is_of_robot(campaign, measurements, registration);
    check_options(options);
    const Index all = measurements.configuration_count();
    const Index split_count = options.splits.value_or(usual_splits(all, least, options));
    if (split_count > 0 && all < 2) {
        throw InputError("there is 1 configuration, splits need at least 2");
    }
    std::vector<Split> splits = make_splits(all, split_count, options);
    const auto counts =
        choose_pose_counts(options.pose_counts, static_cast<Index>(splits.front().pool.size()),
                           least, split_count > 0);
    Study study;
    study.campaign = campaign.name;
    study.model = model.name;
    study.ids = measurements.ids;
    study.criteria = options.criteria;
    study.ending = Ending::NotIdentifiable;
    study.splits = split_count;
    study.test_count = static_cast<Index>(splits.front().test.size());
    study.undetermined = describe_undetermined(campaign, measurements, registration);
    if (!study.undetermined.empty()) return study;
    check_some_are_left(counts, measurements.configuration_count());
    const Blocks blocks = detail::measured_blocks(campaign, registration.parameters, measurements);
    const RowMatrixXd positions =
        detail::turning_joints(campaign.robot, measurements.configurations);
    for (Split& split : splits) {
        split.blocks = take(blocks, split.pool);
        if (options.least_distance != 0) split.positions = positions(split.pool, Eigen::all);
    }
    const Setting setting{campaign, measurements, options, std::move(splits)};
    study.rows = make_rows(counts, options, setting.splits.size());
    if (!run_all(setting, series_of(study, setting), study.rows)) {
        study.ending = Ending::NotRun;
        return study;
    }
    study.ending = options.stop.ending_or(Ending::Converged);
    return study;
}

/// Of studies that were stopped, those rows stay that are complete in all.
void keep_common_rows(std::vector<Study>& studies) {
    std::map<Index, std::set<const Study*>> having;
    for (const Study& study : studies) {
        for (const StudyRow& row : study.rows) having[row.pose_count].insert(&study);
    }
    for (Study& study : studies) {
        std::erase_if(study.rows, [&](const StudyRow& row) {
            return having[row.pose_count].size() < studies.size();
        });
    }
}

}  // namespace

Study study(const Campaign& campaign, const Measurements& measurements,
            const StudyOptions& options) {
    return compare_models({{"", campaign}}, measurements, options).front();
}

std::vector<Study> compare_models(const std::vector<RobotModel>& models,
                                  const Measurements& measurements, const StudyOptions& options) {
    const Index least = largest_least_count(models, options);
    const auto count = static_cast<Index>(models.size());
    std::vector<Study> studies;
    for (Index before = 0; before < count; ++before) {
        const RobotModel& model = models[static_cast<std::size_t>(before)];
        StudyOptions of_model = options;
        of_model.progress = [&](const Progress& progress) {
            if (!options.progress) return;
            options.progress({before * progress.total + progress.done, count * progress.total});
        };
        studies.push_back(study_from(least, model, measurements, of_model));
    }
    if (options.stop.is_set()) keep_common_rows(studies);
    return studies;
}

}  // namespace posewise
