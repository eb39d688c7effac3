#include <gtest/gtest.h>

#include <cmath>

#include "../../src/measurement/noise.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/task/doubts.hpp"
#include "support/campaign_from.hpp"
#include "support/combined.hpp"
#include "support/coverage.hpp"
#include "support/slips.hpp"

/// Several instruments that see one robot, by simulated campaigns.
namespace posewise {
namespace {

using testing::Share;

struct Found {
    Share robot, sensor;
    double squares = 0;  ///< of the errors of all parameters, in the covariance's units
    double count = 0;
    int converged = 0;
};

/// Calibrates so many robots, each with poses and noise of its own, from nothing but what is
/// measured and what has no registration of its own.
Found calibrate_many(const Campaign& campaign, Index poses, std::uint64_t campaigns) {
    Found found;
    for (std::uint64_t run = 0; run < campaigns; ++run) {
        const Simulation simulated = simulate(campaign, {poses, 1, 2 * run, 2 * run + 1});
        const Registration start = register_base_and_targets(campaign, simulated.measurements);
        EXPECT_EQ(start.undetermined, "") << run;
        const Estimate estimate = identify(campaign, simulated.measurements, start.parameters);
        found.converged += estimate.ending == Ending::Converged ? 1 : 0;
        const VectorXd deviations = standard_deviations(estimate);
        const VectorXd error = step_between(campaign, simulated.truth, estimate.parameters);
        const Index robot = base_parameter_count(campaign);
        const Index sensor = robot + campaign.robot.parameter_count();
        for (Index k = 0; k < error.size(); ++k) {
            if (k >= robot && k < sensor) found.robot.add(error[k], deviations[k]);
            if (k >= sensor) found.sensor.add(error[k], deviations[k]);
        }
        found.robot.end_campaign();
        found.sensor.end_campaign();
        // A wrong minimum is far away.
        EXPECT_LT(error.cwiseQuotient(deviations).cwiseAbs().maxCoeff(), 8) << run;
        found.squares += error.dot(estimate.covariance.llt().solve(error));
        found.count += static_cast<double>(error.size());
    }
    return found;
}

void expect_covered(const Found& found, int campaigns) {
    EXPECT_EQ(found.converged, campaigns);
    for (const Share* share : {&found.robot, &found.sensor}) {
        EXPECT_NEAR(share->value(), 0.95, std::max(0.012, 4 * share->deviation()));
    }
    EXPECT_NEAR(found.squares / found.count, 1, 0.12);
}

Campaign without_model_error(const std::string& text) {
    Campaign campaign = testing::campaign_from(text);
    campaign.model_error = campaign.model_error_orientation = 0;
    return campaign;
}

TEST(CombinedSensors, OfATrackerAndACameraStateDeviationsThatHold) {
    const Found found = calibrate_many(without_model_error(testing::tracker_and_camera), 30, 60);
    expect_covered(found, 60);
}

TEST(CombinedSensors, OfACameraAndPlanesStateDeviationsThatHold) {
    const Found found = calibrate_many(without_model_error(testing::camera_and_planes), 30, 60);
    expect_covered(found, 60);
}

TEST(CombinedSensors, OfTwoBoardsBeforeOneCameraStateDeviationsThatHold) {
    const Found found = calibrate_many(without_model_error(testing::two_boards), 30, 60);
    expect_covered(found, 60);
}

/// What the camera tells comes on top: no parameter of robot, base and targets is known worse than
/// by the tracker alone at the same poses, and some clearly better.
TEST(CombinedSensors, TellNoLessThanOneOfThem) {
    const Campaign both = without_model_error(testing::tracker_and_camera);
    const Campaign alone = with_robot(without_model_error(testing::tracker_alone), both.robot);
    const Measurements measured = simulate(both, {30, 1, 1, 2}).measurements;
    const auto sigmas = [&](const Campaign& campaign) {
        RowMatrixXd times = times_seen(measured).leftCols(campaign.sensor->target_count());
        const MatrixXd M =
            information(make_blocks(campaign, campaign.nominal, measured.configurations, times));
        const MatrixXd C = M.llt().solve(MatrixXd::Identity(M.rows(), M.cols()));
        return VectorXd(C.diagonal().cwiseSqrt());
    };
    const VectorXd together = sigmas(both);
    const VectorXd by_tracker = sigmas(alone);
    const VectorXd ratio =
        together.head(by_tracker.size()).cwiseQuotient(by_tracker);  // targets come first
    EXPECT_LE(ratio.maxCoeff(), 1 + 1e-9);
    EXPECT_LT(ratio.minCoeff(), 0.95);
}

/// Alone the second board, which few views show, could be of any size: the robot would give way.
TEST(CombinedSensors, NameTheBoardWhoseSquaresAreOfAnotherSize) {
    const Campaign campaign = testing::campaign_from(testing::two_boards);
    const Measurements measured =
        simulate(campaign, {.pose_count = 40, .truth_seed = 6}).measurements;
    EXPECT_FALSE(find_camera_doubt(campaign, measured,
                                   register_base_and_targets(campaign, measured).parameters));
    for (const auto& [sensor, side, stated_side] :
         {std::tuple(1, "square_mm: 25", "square_mm: 25.4"),
          std::tuple(2, "square_mm: 30", "square_mm: 25.4")}) {
        const Campaign stated =
            testing::campaign_from(testing::replaced(testing::two_boards, side, stated_side));
        const auto doubt = find_camera_doubt(
            stated, measured, register_base_and_targets(stated, measured).parameters);
        ASSERT_TRUE(doubt) << sensor;
        EXPECT_EQ(doubt->sensor, sensor);
        EXPECT_NEAR(doubt->board_factor * 25.4, sensor == 1 ? 25 : 30, 0.15);
        EXPECT_NEAR(doubt->square, 0.0254, 1e-12);
    }
}

}  // namespace
}  // namespace posewise
