#include "posewise/task/study.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/checksum.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/selection/choice.hpp"
#include "posewise/task/doubts.hpp"
#include "study_cases.hpp"
#include "task/calibration/calibration_options.hpp"
#include "task/calibration/identify_anew.hpp"
#include "task/calibration/inputs.hpp"

namespace posewise {
namespace {

using detail::MeasuredCase;

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

/// Why not even all configurations identify the model; empty: they do.
std::string describe_undetermined(const Campaign& campaign, const Measurements& measurements,
                                  const Registration& registration, const StudyOptions& options) {
    if (!registration.is_determined()) return registration.undetermined;
    return detail::judge_measured(campaign, measurements, options.judge, options.stop);
}

double holdout_of(const StudyOptions& options) { return options.holdout.value_or(0.3); }

void check_options(const StudyOptions& options) {
    if (options.random_subsets < 0 || options.starts < 0) {
        throw InputError("random subsets and starts must not be negative, are " +
                         std::to_string(options.random_subsets) + " and " +
                         std::to_string(options.starts));
    }
    if (options.splits && *options.splits < 0) {
        throw InputError("splits are " + std::to_string(*options.splits) + ", must be at least 0");
    }
    if (const double holdout = holdout_of(options); !(holdout > 0 && holdout < 1)) {
        throw InputError(fmt::format("holdout is {:g}, must be above 0 and below 1", holdout));
    }
}

/// Configurations that a split judges on.
Index test_count(Index all, double holdout) {
    return std::clamp<Index>(std::lround(holdout * static_cast<double>(all)), 1, all - 1);
}

/// Of a study with splits; beyond a third of the pool all subsets are much the same.
std::vector<Index> split_counts(Index pool, Index least) {
    return detail::usual_counts(least, pool / 3);
}

/// Of a study without splits, whose subsets are judged on what they leave: of few configurations
/// the largest subsets would be judged on one, two or three, which say little of others.
Index largest_count(Index all, Index least) {
    constexpr Index many = 50;
    const Index most = all < many ? all - std::max<Index>(least_judged, all / 5) : all - 1;
    return most < least ? all - 1 : most;
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
    std::vector<Index> counts = is_split ? split_counts(all, least) : std::vector<Index>{};
    if (!counts.empty()) return counts;
    for (Index count = least; count <= largest_count(all, least); ++count) counts.push_back(count);
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
    const Index pool = all - test_count(all, holdout_of(options));
    if (options.pose_counts.empty()) {
        return split_counts(pool, least).empty() ? 0 : splits;
    }
    const auto& counts = options.pose_counts;
    return 3 * *std::max_element(counts.begin(), counts.end()) <= pool ? splits : 0;
}

std::vector<Split> make_splits(Index all, Index count, const StudyOptions& options) {
    std::vector<Split> splits;
    for (Index s = 0; s < count; ++s) {
        Split split;
        // Streams of cases begin at 2^32.
        split.test = RandomStream(options.seed.value(), static_cast<std::uint64_t>(s))
                         .subset(all, test_count(all, holdout_of(options)));
        split.pool = all_but(all, split.test);
        splits.push_back(std::move(split));
    }
    if (splits.empty()) splits.push_back({all_but(all, {}), {}, {}, {}});
    return splits;
}

/// Of the split's configurations; none if no choice identifies the model.
std::vector<Index> choose_poses(const Setting& setting, const MeasuredCase& job, Index pose_count,
                                const Split& split) {
    const auto all = static_cast<Index>(split.pool.size());
    if (job.is_random) {
        // The stream depends on size and number only, so more subsets or sizes change no other.
        const auto item = (static_cast<std::uint64_t>(pose_count) << 32) + job.number;
        return RandomStream(setting.options.seed.value(), item).subset(all, pose_count);
    }
    SelectOptions options =
        detail::study_selection(setting.options, setting.campaign, job.number, pose_count, all);
    options.positions = split.positions;
    return select_poses(split.blocks, options).poses;
}

/// A case that is "not identified" if its poses cannot be found or do not identify the model: that
/// is what a study is to show.
StudyCase run(const Setting& setting, const MeasuredCase& job, Index pose_count) {
    StudyCase result;
    const Split& split = setting.splits[static_cast<std::size_t>(job.split)];
    for (const Index chosen : choose_poses(setting, job, pose_count, split)) {
        result.poses.push_back(split.pool[static_cast<std::size_t>(chosen)]);
    }
    if (result.poses.empty()) return result;
    const Measurements& measurements = setting.measurements;
    const auto estimate = detail::identify_anew(setting.campaign, take(measurements, result.poses));
    if (!estimate) return result;
    const auto judged =
        split.test.empty() ? all_but(measurements.configuration_count(), result.poses) : split.test;
    if (!judged.empty()) {
        const Measurements others = take(measurements, judged);
        const Metrics metrics =
            make_metrics(mean_residuals(setting.campaign, estimate->parameters, others),
                         *setting.campaign.sensor);
        const bool has_lengths = metrics.coordinate_count > 0;
        result.held_out = {metrics.point_count, metrics.rms(),
                           has_lengths ? metrics.distance_p95 : metrics.orientation_p95,
                           has_lengths ? metrics.distance_max : metrics.orientation_max};
        result.expected = expected_error(setting.campaign, *estimate, others).total();
    }
    result.identified = true;
    return result;
}

/// Of what the cases depend on beside what their series says.
std::string checksum_of(const Setting& setting) {
    const StudyOptions& options = setting.options;
    detail::Checksum checksum;
    checksum.add(setting.measurements.configurations);
    checksum.add(setting.measurements.observations);
    for (const Split& split : setting.splits) checksum.add(split.blocks.matrix);
    checksum.add(fmt::format("{} {} {} {}", holdout_of(options), options.least_distance,
                             options.starts, setting.campaign.spread.is_prior));
    return checksum.text();
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

/// One model's study before any case is run.
struct Prepared {
    Setting setting;
    TrialSeries cases;         ///< none if the model is not identified
    std::string undetermined;  ///< why it is not
};

/// With pose counts from `least` if none are asked for.
Prepared prepare(Index least, const RobotModel& model, const Measurements& measurements,
                 const StudyOptions& options) {
    const Campaign& campaign = model.campaign;
    const Registration registration = register_base_and_targets(campaign, measurements);
    check_is_of_robot(campaign, measurements, registration);
    check_options(options);
    const Index all = measurements.configuration_count();
    const Index split_count = options.splits.value_or(usual_splits(all, least, options));
    if (split_count == 0 && options.holdout) {
        throw InputError(
            "`holdout` is of splits, and none are made unless `splits` asks for them, since no "
            "pose count is up to a third of the configurations to choose from; must be left out");
    }
    if (split_count > 0 && all < 2) {
        throw InputError("there is 1 configuration, splits need at least 2");
    }
    Prepared prepared{{campaign, measurements, options, make_splits(all, split_count, options)},
                      {},
                      describe_undetermined(campaign, measurements, registration, options)};
    std::vector<Split>& splits = prepared.setting.splits;
    const auto counts =
        choose_pose_counts(options.pose_counts, static_cast<Index>(splits.front().pool.size()),
                           least, split_count > 0);
    TrialSeries& cases = prepared.cases;
    cases.campaign = campaign.name;
    cases.variation = model.name;
    cases.seed = options.seed.value();
    cases.criteria = options.criteria.value();
    cases.random_subsets = options.random_subsets;
    cases.splits = split_count;
    cases.test_count = static_cast<Index>(splits.front().test.size());
    cases.ids = measurements.ids;
    cases.units = &campaign.sensor->main_units();
    if (!prepared.undetermined.empty()) return prepared;
    cases.pose_counts = counts;
    check_some_are_left(counts, measurements.configuration_count());
    const Blocks blocks = detail::measured_blocks(campaign, registration.parameters, measurements);
    const RowMatrixXd positions =
        detail::turning_joints(campaign.robot, measurements.configurations);
    for (Split& split : splits) {
        split.blocks = take(blocks, split.pool);
        if (options.least_distance != 0) split.positions = positions(split.pool, Eigen::all);
    }
    cases.checksum = checksum_of(prepared.setting);
    return prepared;
}

}  // namespace

Study study(const Campaign& campaign, const Measurements& measurements,
            const StudyOptions& options) {
    return compare_models({{"", campaign}}, measurements, options).front();
}

std::vector<Study> compare_models(const std::vector<RobotModel>& models,
                                  const Measurements& measurements, const StudyOptions& asked) {
    if (models.empty()) return {};
    StudyOptions options = asked;
    detail::complete(options, models.front().campaign);
    const Index least = largest_least_count(models, options);
    std::vector<Prepared> prepared;
    std::vector<TrialSeries> series;
    std::vector<std::vector<MeasuredCase>> cases;
    std::vector<Index> counts;
    for (const RobotModel& model : models) {
        prepared.push_back(prepare(least, model, measurements, options));
        series.push_back(prepared.back().cases);
        cases.push_back(detail::list_cases(series.back()));
        counts.push_back(static_cast<Index>(cases.back().size()));
    }
    const auto compute = [&](const TrialId& id) {
        const auto s = static_cast<std::size_t>(id.series);
        const MeasuredCase& one = cases[s][static_cast<std::size_t>(id.number)];
        std::vector<double> values;
        detail::append_case(run(prepared[s].setting, one, series[s].pose_counts[one.row]), values);
        return values;
    };
    std::vector<Study> studies;
    options.crew(compute, [&](const RunTrials& run_trials) {
        detail::TrialRuns runs(series, options);
        runs.run(run_trials, counts);
        for (std::size_t s = 0; s < series.size(); ++s) {
            Study& study = studies.emplace_back(runs.study_of_all(s));
            study.undetermined = prepared[s].undetermined;
            study.ending = study.undetermined.empty() ? options.stop.ending_or(Ending::Converged)
                                                      : Ending::NotIdentifiable;
        }
    });
    if (options.stop.is_set() || options.shard.count > 1) keep_common(studies);
    return studies;
}

}  // namespace posewise
