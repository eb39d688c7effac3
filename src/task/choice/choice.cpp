#include "posewise/task/choice.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <utility>

#include "choice_problem.hpp"
#include "measurement/feasible.hpp"
#include "measurement/noise.hpp"
#include "model/halton.hpp"
#include "posewise/jacobian/identification.hpp"
#include "task/calibration/inputs.hpp"

namespace posewise {
namespace {

using detail::ChoiceProblem;

std::vector<PlannedPose> poses_of(const ChoiceProblem& problem, const std::vector<Index>& chosen) {
    std::vector<PlannedPose> poses;
    for (std::size_t i = 0; i < chosen.size(); ++i) {
        const Index candidate = chosen[i];
        if (i > 0 && candidate == chosen[i - 1]) {
            ++poses.back().times;
            continue;
        }
        PlannedPose& pose = poses.emplace_back();
        pose.id = problem.ids[static_cast<std::size_t>(candidate)];
        if (problem.configurations.rows() > 0) {
            pose.configuration = problem.configurations.row(candidate);
        }
        for (Index target = 0; target < problem.share.cols(); ++target) {
            if (problem.share(candidate, target) > 0) pose.targets.push_back(target);
        }
    }
    return poses;
}

Plan solve(ChoiceProblem& problem, const ChoiceOptions& options) {
    problem.options.stop = options.stop;
    problem.options.progress = options.progress;
    const Choice choice = detail::compute_from(detail::name_of(problem.request.sources), [&] {
        return determined(select_poses(problem.blocks, problem.options));
    });
    Plan plan;
    plan.poses = poses_of(problem, choice.poses);
    plan.request = problem.request;
    plan.request.starts = choice.starts;
    plan.value = choice.value;
    plan.kind = problem.kind;
    plan.candidate_count = problem.blocks.count();
    plan.checksum = problem.checksum;
    plan.choice_value = choice.value;
    plan.bound = choice.bound;
    plan.efficiency = choice.efficiency;
    plan.certificate = choice.certificate;
    plan.starts_at_best = choice.starts_at_best;
    plan.tried = choice.tried;
    plan.ending = choice.ending;
    return plan;
}

/// Nothing where base and targets are not determined.
std::optional<PredictedAccuracy> predict(const Campaign& campaign, const ChoiceProblem& problem,
                                         const std::vector<PlannedPose>& poses) {
    const MatrixXd M = information_of(problem, poses);
    if (Eigen::LLT<MatrixXd>(M).info() != Eigen::Success) return std::nullopt;
    const std::vector<Index> chosen = candidates_of(problem, poses);
    const RowMatrixXd repeats =
        problem.request.repeats * RowMatrixXd(problem.share(chosen, Eigen::all));
    Campaign registered = campaign;
    registered.nominal = problem.parameters;
    return predict_accuracy(
        make_position_errors(registered, workspace_of(problem)), M, campaign,
        information_by_noise(campaign, problem.parameters,
                             RowMatrixXd(problem.configurations(chosen, Eigen::all)), repeats));
}

/// Plan::value_rms. Where whitening divided every coordinate of every target at every test pose by
/// the same length, the value is a mean square of positions in units of that.
std::optional<double> value_rms(const Campaign& campaign, const ChoiceProblem& problem,
                                const RowMatrixXd& test_poses, double value) {
    constexpr double rounding = 1e-9;
    if (problem.reading_deviation) {
        const Sensor& sensor = *campaign.sensor;
        const bool are_positions = !sensor.has_angles() && sensor.lengths_per_target() == 3 &&
                                   !sensor.is_combined() && (problem.share.array() == 1).all();
        if (!are_positions || !needs_test_poses(problem.request.criterion)) return std::nullopt;
        return *problem.reading_deviation /
               std::sqrt(value * static_cast<double>(sensor.target_count()));
    }
    const bool are_candidates = problem.test_poses == nullptr;
    if (!needs_test_poses(problem.request.criterion) || !detail::has_constant_noise(campaign) ||
        (are_candidates && (problem.share.array() != 1).any())) {
        return std::nullopt;
    }
    const RowMatrixXd first = (are_candidates ? problem.configurations : test_poses).topRows(1);
    const RowMatrixXd positions =
        make_prediction_blocks(campaign, problem.parameters, first).matrix;
    const RowMatrixXd whitened = (are_candidates ? problem.blocks : *problem.test_poses)[0];
    if (whitened.rows() != positions.rows()) return std::nullopt;
    const double unit = positions.norm() / whitened.norm();
    if ((positions - unit * whitened).norm() > rounding * positions.norm()) return std::nullopt;
    return unit / std::sqrt(value * static_cast<double>(campaign.sensor->target_count()));
}

}  // namespace

double mean_repeats(const Measurements& measurements) {
    return static_cast<double>(measurements.observations.rows()) /
           static_cast<double>(measurements.configuration_count());
}

Candidates measured_candidates(Measurements measured) {
    Candidates candidates{CandidateKind::Measurements, measured.ids, measured.configurations,
                          share_seen(measured),        std::nullopt, std::nullopt};
    candidates.measured = std::move(measured);
    return candidates;
}

Candidates random_candidates(const Campaign& campaign, Index count, std::uint64_t seed) {
    detail::check_torques_known(campaign);
    detail::check_memory(campaign, count, "count");
    Candidates candidates;
    candidates.kind = CandidateKind::Random;
    candidates.seed = seed;
    candidates.ids = detail::number_ids(count);
    detail::ShownPoses poses =
        detail::draw_feasible(campaign, count, [&](const Chain& robot, Index drawn) {
            return detail::halton_configurations(robot, drawn, {{}, 1, seed});
        });
    candidates.configurations = std::move(poses.configurations);
    candidates.share = times_seen(poses.is_seen, 1);
    return candidates;
}

Plan choose(const Campaign& campaign, Candidates candidates, const ChoiceOptions& options) {
    check_knowable(campaign, options.stop);
    if (campaign.spread.is_prior) {  // else selection says if they are too few
        detail::compute_from(options.sources.campaign, [&] {
            detail::check_enough_poses(campaign, options.pose_count,
                                       options.held ? options.held->configuration_count() : 0,
                                       options.stop);
        });
    }
    const std::optional<Measurements> measured = candidates.measured;
    ChoiceProblem problem = detail::state_choice(campaign, std::move(candidates), options,
                                                 options.stop.with_half_the_time());
    detail::judge_candidates(campaign, measured, options);
    Plan plan = solve(problem, options);
    plan.campaign = campaign.name;
    plan.columns = configuration_columns(campaign);
    plan.cell_doubts = problem.cell_doubts;
    plan.assumptions = assumptions_of(campaign);
    plan.predicted = predict(campaign, problem, plan.poses);
    plan.value_rms = value_rms(campaign, problem, options.test_poses, plan.value);
    return plan;
}

Plan choose(Blocks candidates, const ChoiceOptions& options) {
    ChoiceProblem problem = detail::state_choice(std::move(candidates), options);
    return solve(problem, options);
}

Plan judge_again(const Plan& plan, const Campaign& campaign, Candidates candidates,
                 const ChoiceOptions& options) {
    const ChoiceProblem problem = detail::state_choice(campaign, std::move(candidates), options);
    Plan judged = plan;
    judged.predicted = predict(campaign, problem, plan.poses);
    judged.value_rms = value_rms(campaign, problem, options.test_poses, plan.value);
    return judged;
}

}  // namespace posewise
