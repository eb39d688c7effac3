#include "left_out.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/elementary.hpp"
#include "core/statistics.hpp"
#include "measurement/noise.hpp"
#include "planning_problem.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::detail {
namespace {

/// The richer campaign with weights as the poorer one has them.
Campaign weighed_as(const Campaign& poorer, Campaign richer) {
    richer.model_error = poorer.model_error;
    richer.model_error_orientation = poorer.model_error_orientation;
    richer.model_error_common = common_part(poorer);
    return richer;
}

/// What a plan's poses and those measured already show of a campaign's parameters: rows over their
/// noise, columns scaled.
MatrixXd shown_rows(const PlanningProblem& problem, const Plan& plan, const PlanningOptions& made) {
    const MatrixXd poses = blocks_of(problem, plan.poses).matrix;
    if (!made.held) return poses;
    const MatrixXd held = make_blocks(problem.campaign, problem.campaign.nominal,
                                      made.held->configurations, times_seen(*made.held))
                              .matrix;
    MatrixXd rows(poses.rows() + held.rows(), poses.cols());
    rows << poses, held;
    return rows;
}

}  // namespace

void judge_left_out(Planning& planning, const PlanningOptions& options) {
    const Plan& plan = planning.plan;
    if (!options.richer || !plan.request.sources.estimate.empty() || !plan.predicted) return;
    const std::vector<OtherCampaign> campaigns = options.richer();
    if (campaigns.empty()) return;
    const auto& [key, richest] = campaigns.back();
    const Campaign& poorer = planning.campaign;
    PlanningOptions made = options_of(plan, options);
    const PlanningProblem problem = state_planning(poorer, made);
    made.workspace = workspace_of(problem, made);  // drawn once for all three
    PlanningProblem weighed = state_planning(weighed_as(poorer, richest), made);
    draw_workspace(weighed, made);
    const MatrixXd B0 = shown_rows(problem, plan, made);
    const MatrixXd B = shown_rows(weighed, plan, made);
    const MatrixXd& C0 = planning.errors.by_parameters.matrix;
    const MatrixXd& C = weighed.errors.by_parameters.matrix;
    const Index begin = base_parameter_count(richest);
    const Index count = richest.robot.parameter_count();

    const MatrixXd K = planning.information.llt().solve(C0.transpose());
    const MatrixXd of_noise = planning.information - prior_information(poorer);
    const MatrixXd off =
        C.middleCols(begin, count) - K.transpose() * (B0.transpose() * B.middleCols(begin, count));
    const double positions = static_cast<double>(C.rows()) / 3;
    const double bias = std::sqrt(off.squaredNorm() / positions);
    const double noise = std::sqrt(K.cwiseProduct(of_noise * K).sum() / positions);

    ErrorsLeftOut left_out;
    left_out.key = key;
    left_out.error_count = parameter_count(richest) - parameter_count(poorer);
    left_out.promised = predict_total(*plan.predicted).rms;
    const auto with_sizes = [&](double factor) {
        return std::hypot(factor * bias, noise, plan.predicted->left_over);
    };
    const double most = power(richest.known_within.error_size, normal_quantile(0.95));
    left_out.expected = with_sizes(1);
    left_out.lower = with_sizes(1 / most);
    left_out.upper = with_sizes(most);
    left_out.with_them = predict_total(*judge_again(plan, richest, made).plan.predicted).rms;
    if (left_out.expected > 1.1 * left_out.promised) planning.left_out = left_out;
}

}  // namespace posewise::detail
