// Programs with few digits: what 200 simulated calibrations lose, against what is predicted.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/sent_plan.hpp"

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
/// to `there`, by someone who takes them to be at `believed`.
double simulated_rms(const Campaign& campaign, const RowMatrixXd& there,
                     const RowMatrixXd& believed, const RowMatrixXd& workspace) {
    std::vector<double> squares(trials, 0.0);
#pragma omp parallel for schedule(dynamic)
    for (Index trial = 0; trial < trials; ++trial) {
        const auto seed = static_cast<std::uint64_t>(trial);
        const Parameters truth = draw_truth(campaign, seed);
        Measurements measured = simulate_measurements(campaign, truth, there, 1, 1000 + seed);
        measured.configurations = believed;
        const Parameters found = identify(campaign, measured, campaign.nominal).parameters;
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
    const RowMatrixXd planned = configurations_of(plan);
    const ControllerJoints controller(campaign.robot);

    // Sent joints are known: rounding costs nothing but the other place, with both numbers of
    // digits.
    RowMatrixXd sent[2];
    constexpr double steps[2] = {1e-4, 1e-6};
    for (int k = 0; k < 2; ++k) {
        const Plan rounded = sent_plan(plan, campaign, controller, VectorXd::Constant(6, steps[k]));
        sent[k] = configurations_of(rounded);
        const RoundingLoss loss = rounding_loss(plan, rounded, campaign, options);
        const double simulated = simulated_rms(campaign, sent[k], sent[k], options.workspace);
        fmt::print("{:g} rad, as sent: predicted {:.3f} um, simulated {:.3f} um\n", steps[k],
                   1e6 * *loss.sent_rms, 1e6 * simulated);
        EXPECT_NEAR(simulated / *loss.sent_rms, 1, 0.06) << steps[k];
        EXPECT_NEAR(*loss.sent_rms / *loss.planned_rms, 1, 1e-3);
    }

    // Who calibrates with the planned joints has their rounding as noise of the joints, uniform in
    // one step.
    for (int k = 0; k < 2; ++k) {
        Campaign noisy = campaign;
        noisy.joint_repeatability = VectorXd::Constant(6, steps[k] / std::sqrt(12.0));
        const RoundingLoss loss = rounding_loss(plan, plan, noisy, options);
        // Without the repeatability at one visit, which is no error of the calibration.
        const double simulated = simulated_rms(campaign, sent[k], planned, options.workspace);
        fmt::print("{:g} rad, as planned: predicted {:.3f} um, simulated {:.3f} um\n", steps[k],
                   1e6 * *loss.planned_rms, 1e6 * simulated);
        if (k == 0) {
            EXPECT_GT(simulated,
                      1.3 * simulated_rms(campaign, sent[k], sent[k], options.workspace));
        }
    }
}

}  // namespace
}  // namespace posewise
