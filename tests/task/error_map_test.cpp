#include <gtest/gtest.h>

#include <cmath>

#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/scene.hpp"
#include "support/cells.hpp"

namespace posewise {
namespace {

double rms_of(const ErrorMap& map) {
    double sum = 0;
    for (const MappedError& error : map) sum += error.predicted * error.predicted;
    return std::sqrt(sum / static_cast<double>(map.size()));
}

class MapErrors : public ::testing::Test {
  protected:
    MapErrors() {
        campaign_.cell = testing::demo_cell();
        campaign_.spread.is_prior = true;
        options_.pose_count = 4;
        options_.pool_count = 120;
        options_.starts = 1;
        options_.criterion = Criterion::D;
        options_.workspace_count = 10;
    }
    Campaign campaign_ = testing::cell_campaign();
    PlanningOptions options_;
};

TEST_F(MapErrors, OfAPlanIsWhatItPredicts) {
    const Plan plan = make_plan(campaign_, options_).plan;
    const ErrorMap map = map_errors(plan, campaign_, options_);
    ASSERT_EQ(map.size(), 10U);
    EXPECT_NEAR(rms_of(map), plan.predicted->rms, 1e-9 * plan.predicted->rms);
    const MappedError& one = map.front();
    EXPECT_FALSE(one.displacement);
    const Isometry3d flange = world_from_flange(campaign_, campaign_.nominal, one.configuration);
    EXPECT_TRUE(one.position.isApprox(flange * campaign_.nominal.sensor.head<3>(), 1e-12));

    PlanningOptions repair = options_;
    repair.repaired = plan;
    repair.dropped = {plan.poses[1].id};
    repair.workspace_target = 2;
    const Plan repaired = make_plan(campaign_, repair).plan;
    const ErrorMap of_repaired = map_errors(repaired, campaign_, repair);
    EXPECT_NEAR(rms_of(of_repaired), repaired.predicted->rms, 1e-9 * repaired.predicted->rms);
    const Vector3d second = world_from_flange(campaign_, campaign_.nominal, one.configuration) *
                            campaign_.nominal.sensor.segment<3>(3);
    EXPECT_TRUE(of_repaired.front().position.isApprox(second, 1e-12)) << "the target that counts";
}

TEST_F(MapErrors, OfAChoiceIsWhatItPredicts) {
    const Candidates candidates = random_candidates(campaign_, 30, 1);
    ChoiceOptions options;
    options.pose_count = 6;
    options.starts = 1;
    options.proof = 0;
    const Plan plan = choose(campaign_, candidates, options);
    const ErrorMap map = map_errors(plan, campaign_, candidates, options);
    EXPECT_EQ(map.size(), 30U);
    EXPECT_NEAR(rms_of(map), plan.predicted->rms, 1e-9 * plan.predicted->rms);
}

TEST_F(MapErrors, OfAnEstimateIsByItsCovarianceAndAgainstTheNominalRobot) {
    campaign_.cell = {};
    campaign_.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 5e-5);
    campaign_.nominal.sensor.conservativeResize(3);
    const Simulation simulation = simulate(campaign_, {.pose_count = 20});
    CalibrationOptions calibrating;
    calibrating.folds = 0;
    const Calibration found = calibrate(campaign_, simulation.measurements, calibrating);
    const GeometryOptions options{{}, 40};
    const ErrorMap map = map_errors(found.campaign, found.estimate, options);
    ASSERT_EQ(map.size(), 40U);
    double squares = 0;
    for (const MappedError& error : map) {
        const Blocks J = make_position_blocks(campaign_, found.estimate.parameters,
                                              error.configuration.transpose());
        const MatrixXd covariance = J.matrix * found.estimate.covariance * J.matrix.transpose();
        EXPECT_NEAR(error.predicted, std::sqrt(covariance.trace()), 1e-9 * error.predicted);
        squares += error.displacement.value().squaredNorm();
    }
    const PositionLoss nominal = nominal_loss(found.campaign, found.estimate.parameters, options);
    EXPECT_NEAR(std::sqrt(squares / 40), nominal.rms, 1e-12);
    EXPECT_GT(nominal.rms, 1e-4);
}

}  // namespace
}  // namespace posewise
