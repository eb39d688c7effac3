// Programs with few digits: what 200 simulated calibrations lose, against what is predicted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {
namespace {

/// A UR5 whose errors are geometric, seen by a precise tracker; no model error, so that the joints
/// are what is left.
constexpr const char* ur5 = R"(name: UR5
robot:
  errors: geometric
  dh:
    convention: standard
    rows:
      - {a_mm: 0, alpha_deg: 90, d_mm: 89.159, theta_deg: 0, joint: q1, limits_deg: [-180, 180]}
      - {a_mm: -425, alpha_deg: 0, d_mm: 0, theta_deg: 0, joint: q2, limits_deg: [-150, -30]}
      - {a_mm: -392.25, alpha_deg: 0, d_mm: 0, theta_deg: 0, joint: q3, limits_deg: [-150, 150]}
      - {a_mm: 0, alpha_deg: 90, d_mm: 109.15, theta_deg: 0, joint: q4, limits_deg: [-180, 180]}
      - {a_mm: 0, alpha_deg: -90, d_mm: 94.65, theta_deg: 0, joint: q5, limits_deg: [-120, 120]}
      - {a_mm: 0, alpha_deg: 0, d_mm: 82.3, theta_deg: 0, joint: q6, limits_deg: [-180, 180]}
sensor:
  kind: points
  sigma_mm: 0.01
  targets: {position_mm: [[60, 0, 40], [-30, 50, 40], [-30, -50, 60]]}
model_error_mm: 0
base: {position_mm: [3000, 0, 0], rpy_deg: [0, 0, 180]}
)";

constexpr Index trials = 200;

RowMatrixXd configurations_of(const Plan& plan) {
    RowMatrixXd configurations(std::ssize(plan.poses), plan.poses[0].configuration.size());
    for (std::size_t i = 0; i < plan.poses.size(); ++i) {
        configurations.row(static_cast<Index>(i)) = plan.poses[i].configuration.transpose();
    }
    return configurations;
}

/// RMS position error of the targets over the workspace after calibrations of robots that were sent
/// to `there`, by someone who takes them to be where they were before rounding to steps of `step`,
/// another place for each robot, and reckons with what `fitted` says of the noise.
double simulated_rms(const Campaign& campaign, const Campaign& fitted, const RowMatrixXd& there,
                     double step, const RowMatrixXd& workspace) {
    std::vector<double> squares(trials, 0.0);
#pragma omp parallel for schedule(dynamic)
    for (Index trial = 0; trial < trials; ++trial) {
        const auto seed = static_cast<std::uint64_t>(trial);
        const Parameters truth = draw_truth(campaign, seed);
        Measurements measured = simulate_measurements(campaign, truth, there, 1, 1000 + seed);
        RandomStream stream(7, seed);
        for (double& value : measured.configurations.reshaped()) {
            value += step * (stream.uniform() - 0.5);
        }
        const Parameters found = identify(fitted, measured, campaign.nominal).parameters;
        double sum = 0;
        for (Index i = 0; i < workspace.rows(); ++i) {
            const VectorXd q = workspace.row(i).transpose();
            const Isometry3d is = world_from_flange(campaign, truth, q);
            const Isometry3d predicted = world_from_flange(campaign, found, q);
            for (Index target = 0; target < 3; ++target) {
                sum += (is * campaign.sensor->target_position(target, truth.sensor) -
                        predicted * campaign.sensor->target_position(target, found.sensor))
                           .squaredNorm();
            }
        }
        squares[static_cast<std::size_t>(trial)] = sum / static_cast<double>(3 * workspace.rows());
    }
    double sum = 0;
    for (const double square : squares) sum += square;
    return std::sqrt(sum / trials);
}

TEST(RoundedJoints, LoseWhatIsPredicted) {
    io::CampaignFile campaign = io::parse_campaign(ur5, "ur5.yaml");
    io::set_prior(campaign, false);
    PlanningOptions options(24);
    options.criterion = Criterion::V;
    options.pool_count = 500;
    options.starts = 1;
    options.workspace = detail::random_configurations(campaign.robot, 200, 3);
    const Plan plan = make_plan(campaign, options).plan;
    const ControllerJoints controller(campaign.robot);

    // Sent joints are known: rounding costs nothing but the other place, with both numbers of
    // digits.
    RowMatrixXd sent[2];
    constexpr double steps[2] = {1e-4, 1e-6};
    for (int k = 0; k < 2; ++k) {
        const Plan rounded = sent_plan(plan, campaign, controller, VectorXd::Constant(6, steps[k]));
        sent[k] = configurations_of(rounded);
        const RoundingLoss loss = rounding_loss(plan, rounded, campaign, options);
        const double simulated = simulated_rms(campaign, campaign, sent[k], 0, options.workspace);
        fmt::print("{:g} rad, as sent: predicted {:.3f} um, simulated {:.3f} um\n", steps[k],
                   1e6 * *loss.sent_rms, 1e6 * simulated);
        EXPECT_NEAR(simulated / *loss.sent_rms, 1, 0.06) << steps[k];
        EXPECT_NEAR(*loss.sent_rms / *loss.planned_rms, 1, 1e-3);
    }

    // Who calibrates with the planned joints has the rounding as noise of the joints, uniform
    // within one step: predicted if it is stated, and worse if not.
    Campaign noisy = campaign;
    noisy.joint_repeatability = VectorXd::Constant(6, steps[0] / std::sqrt(12.0));
    const double predicted = *rounding_loss(plan, plan, noisy, options).planned_rms;
    const double told = simulated_rms(campaign, noisy, sent[0], steps[0], options.workspace);
    const double untold = simulated_rms(campaign, campaign, sent[0], steps[0], options.workspace);
    fmt::print(
        "{:g} rad, as planned: predicted {:.3f} um, simulated {:.3f} um, {:.3f} um if "
        "nobody reckons with it\n",
        steps[0], 1e6 * predicted, 1e6 * told, 1e6 * untold);
    EXPECT_NEAR(told / predicted, 1, 0.06);
    EXPECT_GT(untold, 1.3 * told);
}

}  // namespace
}  // namespace posewise
