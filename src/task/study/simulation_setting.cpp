#include "simulation_setting.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/checksum.hpp"
#include "core/text.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/planning.hpp"
#include "posewise/task/planning.hpp"
#include "study_cases.hpp"
#include "task/calibration/inputs.hpp"
#include "task/plan/planning_problem.hpp"
#include "task/plan/workspace.hpp"

namespace posewise::detail {
namespace {

/// The robot that is drawn, in the same place as the other.
Campaign true_campaign(const SimulatedCampaign& given, const Campaign& campaign) {
    if (!given.truth) return campaign;
    Campaign truth = *given.truth;
    const auto differs = [&](const char* what, Index has, Index must) {
        if (has == must) return;
        throw InputError(fmt::format("{}: the truth has {} {}, must have {} as {}", truth.name, has,
                                     what, must, campaign.name));
    };
    differs("joints", truth.robot.joint_count(), campaign.robot.joint_count());
    for (std::size_t j = 0; j < truth.robot.joints().size(); ++j) {
        const std::string& has = truth.robot.joints()[j].name;
        const std::string& must = campaign.robot.joints()[j].name;
        if (has == must) continue;
        throw InputError(fmt::format("{}: joint {} of the truth is {}, must be {} as of {}",
                                     truth.name, j + 1, quote(has), quote(must), campaign.name));
    }
    differs("targets", truth.sensor->target_count(), campaign.sensor->target_count());
    differs("numbers an observation", truth.sensor->row_count(), campaign.sensor->row_count());
    if (!truth.has_nominal_base) truth.nominal.world_from_base = campaign.nominal.world_from_base;
    const bool has_same_unknowns =
        truth.sensor->unknown_names() == campaign.sensor->unknown_names();
    if (!truth.has_nominal_targets && has_same_unknowns) {
        truth.nominal.sensor = campaign.nominal.sensor;
    }
    return truth;
}

std::vector<Index> pose_counts(const SimulatedStudyOptions& options, const Campaign& campaign,
                               const Pool& pool) {
    std::vector<Index> counts = options.pose_counts;
    if (counts.empty()) {
        const Index least = least_calibration_count(campaign);
        const Index most = pool.configurations.rows();
        counts = usual_counts(least, most);
        if (counts.empty()) counts.push_back(std::min(least, most));
    }
    std::sort(counts.begin(), counts.end());
    counts.erase(std::unique(counts.begin(), counts.end()), counts.end());
    if (counts.front() < 1) {
        throw InputError(fmt::format("a pose count is {}, must be at least 1", counts.front()));
    }
    check_pool_size(pool, counts.back());
    return counts;
}

/// Poses for the nominal robot; none if they do not identify the model. A deadline does not cut the
/// search: trials must be the same however much time they have.
Subset plan_subset(const SimulationSetting& setting, const SimulatedStudyOptions& options,
                   const Blocks& blocks, const Blocks& prediction, const RowMatrixXd& turning,
                   std::size_t criterion, Index count) {
    if (options.is_refined) {
        PlanningOptions planning(count);
        planning.criterion = options.criteria.value()[criterion];
        planning.pool_count = options.pool_count;
        planning.repeats = static_cast<double>(options.repeats);
        planning.seed = options.seed;
        planning.stop.interrupted = options.stop.interrupted;
        const Plan plan = make_plan(setting.campaign, planning).plan;
        Subset subset{configurations_of(plan.poses, setting.pool.configurations.cols()), {}};
        subset.is_seen.resize(count, setting.pool.is_seen.cols());
        for (Index i = 0; i < count; ++i) {
            subset.is_seen.row(i) = seen_targets(plan.poses[static_cast<std::size_t>(i)].targets,
                                                 subset.is_seen.cols());
        }
        return subset;
    }
    SelectOptions selection = study_selection(options, setting.campaign, criterion, count,
                                              setting.pool.configurations.rows());
    if (needs_test_poses(selection.criterion)) selection.test_poses = &prediction;
    if (options.least_distance > 0) selection.positions = turning;
    selection.stop.interrupted = options.stop.interrupted;
    const Choice choice = select_poses(blocks, selection);
    if (choice.ending == Ending::NotIdentifiable) return {};
    return take(setting.pool, choice.poses);
}

/// A number for all that trials depend on.
std::string checksum_of(const SimulationSetting& setting, const SimulatedStudyOptions& options,
                        const Blocks& blocks) {
    Checksum checksum;
    checksum.add(setting.pool.configurations);
    checksum.add(blocks.matrix);
    checksum.add(setting.test);
    checksum.add(setting.H);
    const auto ends = std::min<Index>(setting.test.rows(), 20);
    const Campaign& truth = setting.truth;
    for (const Campaign* campaign : {&setting.campaign, &truth}) {
        checksum.add(make_blocks(*campaign, campaign->nominal, setting.test.topRows(ends)).matrix);
        checksum.add(RowMatrixXd(parameter_scale(*campaign).transpose()));
        for (const std::string& name : parameter_names(*campaign)) checksum.add(name);
        checksum.add(fmt::format("{} {} {} {} {}", campaign->model_error,
                                 campaign->model_error_orientation,
                                 campaign->known_within.error_size,
                                 campaign->known_within.model_error, campaign->spread.is_prior));
        checksum.add(RowMatrixXd(campaign->joint_repeatability.transpose()));
        if (campaign->prior) checksum.add(RowMatrixXd(campaign->prior->covariance));
    }
    checksum.add(fmt::format("{} {} {} {}", options.repeats, options.starts, options.least_distance,
                             options.is_refined));
    return checksum.text();
}

}  // namespace

Subset take(const Pool& pool, const std::vector<Index>& chosen) {
    return {pool.configurations(chosen, Eigen::all), pool.is_seen(chosen, Eigen::all)};
}

void check_simulation(const SimulatedStudyOptions& options) {
    const auto check = [](const char* name, Index value, Index least) {
        if (value >= least) return;
        throw InputError(fmt::format("{} {}, must be at least {}", name, value, least));
    };
    check("trials are", options.trials, 1);
    check("random subsets are", options.random_subsets, 0);
    check("starts are", options.starts, 0);
    check("configurations to choose from are", options.pool_count, 1);
    check("configurations to judge at are", options.test_count, 1);
    check("repeats are", options.repeats, 1);
    if (options.criteria.value().empty() && options.random_subsets == 0) {
        throw InputError("neither planned nor random poses are asked for");
    }
    if (!(options.precision >= 0 && options.precision < 1)) {
        throw InputError(fmt::format(
            "precision is {:g}, must be at least 0 (all trials) and below 1", options.precision));
    }
    if (options.precision > 0 && options.shard.count > 1) {
        throw InputError(
            "a precision needs all trials, a shard has a part of them; state how many trials");
    }
}

SimulationSetting make_setting(const SimulatedCampaign& given,
                               const SimulatedStudyOptions& options) {
    PlanningOptions planning(1);
    planning.seed = options.seed;
    planning.workspace_count = options.test_count;
    planning.repeats = static_cast<double>(options.repeats);
    if (given.campaign.sensor->has_contacts()) {
        throw InputError(given.campaign.name +
                         ": robots that touch sockets cannot be simulated at poses that were "
                         "chosen for another one; the sensor must be of another kind");
    }
    PlanningProblem problem = state_planning(given.campaign, planning);
    SimulationSetting setting;
    setting.campaign = problem.campaign;
    setting.truth = true_campaign(given, problem.campaign);
    setting.pool =
        make_pool(problem.constraints, options.pool_count, options.seed.value(), options.stop);
    draw_workspace(problem, planning);
    // Not those that V is taken over.
    setting.test = workspace_configurations(problem.campaign, std::nullopt, options.test_count,
                                            options.seed.value() + 2);
    const Blocks tested =
        make_position_blocks(problem.campaign, problem.campaign.nominal, setting.test);
    const auto positions = static_cast<double>(tested.matrix.rows()) / 3;
    setting.H = tested.matrix.transpose() * tested.matrix / positions;

    TrialSeries& series = setting.series;
    series.is_simulated = true;
    series.campaign = given.campaign.name;
    series.variation = given.variation;
    series.seed = options.seed.value();
    series.criteria = options.criteria.value();
    series.pose_counts = pose_counts(options, problem.campaign, setting.pool);
    series.random_subsets = options.random_subsets;
    series.test_count = setting.test.rows();
    const Blocks blocks =
        make_blocks(problem.campaign, problem.campaign.nominal, setting.pool.configurations,
                    times_seen(setting.pool.is_seen, static_cast<double>(options.repeats)));
    series.checksum = checksum_of(setting, options, blocks);
    const RowMatrixXd turning = turning_joints(problem.campaign.robot, setting.pool.configurations);
    for (const Index count : series.pose_counts) {
        std::vector<Subset>& planned = setting.planned.emplace_back();
        for (std::size_t c = 0; c < series.criteria.size(); ++c) {
            planned.push_back(plan_subset(setting, options, blocks, problem.errors.by_parameters,
                                          turning, c, count));
            options.stop.check("poses to measure were chosen");
        }
    }
    return setting;
}

}  // namespace posewise::detail
