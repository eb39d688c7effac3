// Plans of continuous poses from the pool to the calibration made with them.
#include <gtest/gtest.h>

#include <cmath>

#include "../../src/planner/tour.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaign_from.hpp"
#include "support/cell_recheck.hpp"
#include "support/fanuc_planning.hpp"
#include "support/parameter_error.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

io::CampaignFile demo() { return design_campaign("cell_demo/campaign.yaml"); }

/// The demonstration cell where each pose must show all targets, as calibrate needs them.
io::CampaignFile demo_showing_all() {
    io::CampaignFile file = demo();
    file.cell.sight->least_visible.reset();
    file.cell.sight->acceptance_half_angle = 60 * degree;
    return file;
}

PlannedPoses plan_in_cell(const Campaign& campaign, const Constraints& constraints,
                          Index pose_count, Criterion criterion = Criterion::D) {
    PlanOptions options;
    options.criterion = criterion;
    options.pose_count = pose_count;
    options.starts = 1;
    options.bound_iterations = 0;
    return plan_poses(campaign, constraints, make_pool(constraints, 4000, 1), 1, options);
}

TEST(APlanInTheDemonstrationCell, SatisfiesEveryConstraintByASeparateDenseCheck) {
    const io::CampaignFile file = demo();
    const Constraints constraints(file, file.cell);
    for (const Criterion criterion : {Criterion::D, Criterion::V}) {
        const PlannedPoses plan = plan_in_cell(file, constraints, 16, criterion);
        EXPECT_GT(plan.value, plan.pool_choice.value);
        CellRecheck recheck(file, file.cell);
        for (Index i = 0; i < plan.configurations.rows(); ++i) {
            const VectorXd q = plan.configurations.row(i).transpose();
            const auto violations = recheck.violations(q);
            EXPECT_TRUE(violations.empty()) << "pose " << i << ": " << violations.front();
            for (Index k = 0; k < i; ++k) {
                EXPECT_GE(
                    (plan.configurations.row(k) - plan.configurations.row(i)).cwiseAbs().maxCoeff(),
                    5 * degree - 1e-9);
            }
        }
    }
}

/// Calibrations simulated, POSEWISE_SWEEP_COUNT of them or 2 000.
TEST(APlanInTheDemonstrationCell, PredictsTheCovarianceThatSimulatedCalibrationsHave) {
    io::CampaignFile file = demo_showing_all();
    Campaign& campaign = file;
    campaign.model_error = 1e-5;  // so that the tracker's noise dominates
    campaign.joint_repeatability = VectorXd::Constant(6, 5e-6);
    const Constraints constraints(campaign, file.cell);
    const PlannedPoses plan = plan_in_cell(campaign, constraints, 16);
    const Index L = parameter_count(campaign);
    const VectorXd scale = parameter_scale(campaign);
    const MatrixXd covariance = scale.asDiagonal() *
                                plan.information.llt().solve(MatrixXd::Identity(L, L)) *
                                scale.asDiagonal();
    const Eigen::LLT<MatrixXd> cholesky(covariance);

    const Index trials = 2 * sweep_count();
    std::vector<VectorXd> errors(static_cast<std::size_t>(trials));
#pragma omp parallel for schedule(dynamic)
    for (Index trial = 0; trial < trials; ++trial) {
        const auto seed = static_cast<std::uint64_t>(trial);
        const Parameters truth = draw_truth(campaign, seed);
        const Measurements measured =
            simulate_measurements(campaign, truth, plan.configurations, 1, 100000 + seed);
        errors[static_cast<std::size_t>(trial)] =
            error_of(identify(campaign, measured, campaign.nominal).parameters, truth);
    }
    double distance = 0;
    VectorXd variance = VectorXd::Zero(L);
    for (const VectorXd& error : errors) {
        distance += cholesky.matrixL().solve(error).squaredNorm();
        variance += error.cwiseAbs2();
    }
    const auto n = static_cast<double>(trials);
    const double freedom = n * static_cast<double>(L);
    // Normal limit of chi-square; the truth moves the Jacobian by about a thousandth.
    EXPECT_NEAR(distance / freedom, 1, 4 * std::sqrt(2 / freedom) + 0.005);
    for (Index k = 0; k < L; ++k) {
        EXPECT_NEAR(variance[k] / n / covariance(k, k), 1, 4.5 * std::sqrt(2 / n) + 0.01)
            << parameter_names(campaign)[static_cast<std::size_t>(k)];
    }
}

TEST(APlanForTheTrackersNoise, BeatsOneForIsotropicNoiseOfEqualTrace) {
    io::CampaignFile file = demo_showing_all();
    Campaign& tracker = file;
    tracker.model_error = 0;
    const Constraints constraints(tracker, file.cell);
    const auto& points = dynamic_cast<const PointSensor&>(*tracker.sensor);
    double mean_square = 0;  // over the poses that are possible
    const RowMatrixXd pool = make_pool(constraints, 4000, 1).configurations;
    for (Index i = 0; i < pool.rows(); ++i) {
        const Isometry3d flange =
            world_from_flange(tracker, tracker.nominal, pool.row(i).transpose());
        mean_square += points.covariance(flange, tracker.nominal.sensor).trace() /
                       static_cast<double>(points.row_count() * pool.rows());
    }
    Campaign isotropic = tracker;
    isotropic.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), std::sqrt(mean_square));
    const auto judged = [&](const Campaign& planned_for) {
        const RowMatrixXd poses =
            plan_in_cell(planned_for, constraints, 16, Criterion::A).configurations;
        return evaluate(Criterion::A, information(make_blocks(tracker, tracker.nominal, poses)),
                        16);
    };
    EXPECT_GT(judged(tracker), judged(isotropic));
}

TEST(TheOrderOfTheFanucPlan, IsAQuarterShorterThanAsPlannedAndNeverLongerThanNearestFirst) {
    const Campaign campaign = fanuc_planning_campaign();
    Cell cell;
    cell.home = VectorXd::Zero(6);
    const Constraints constraints(campaign, cell);
    PlanOptions options;
    options.criterion = Criterion::D;
    options.pose_count = 24;
    options.starts = 1;
    options.bound_iterations = 0;
    for (const std::uint64_t seed : {1, 2, 3}) {
        const PlannedPoses plan =
            plan_poses(campaign, constraints, make_pool(constraints, 1000, seed), 1, options);
        const Tour tour = plan_tour(constraints, plan.configurations);
        EXPECT_LE(tour.time, tour.nearest_neighbour_time);
        EXPECT_LE(tour.time, 0.75 * tour.planning_order_time) << "seed " << seed;
        EXPECT_EQ(tour.visits.size(), 24U);
    }
}

}  // namespace
}  // namespace posewise
