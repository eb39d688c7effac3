#include <fmt/format.h>
#include <gtest/gtest.h>

#include <iostream>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/choice.hpp"
#include "support/campaign_from.hpp"
#include "support/combined.hpp"
#include "support/coverage.hpp"
#include "task/calibration/expected_distance.hpp"
#include "task/plan/workspace.hpp"

namespace posewise {
namespace {

/// `height`: of the robot's base, along the board's z, which points into the table, mm.
io::CampaignFile hand_eye(int height = 0) {
    return testing::campaign_from("name: hand and eye\nrobot:\n  errors: none\n" +
                                  testing::small_arm + R"(sensor:
  kind: camera
  camera: flange
  image_px: [1280, 960]
  sigma_px: 0.3
  intrinsics: {fx_px: 1500, fy_px: 1490, cx_px: 655, cy_px: 470}
  board: {columns: 8, rows: 5, square_mm: 25}
  place: {position_mm: [30, 40, 60], rpy_deg: [0, 0, 0]}
  view: {most_tilt_deg: 55, least_corners: 20}
base: {rpy_deg: [180, 0, 90], position_mm: [87, 550, )" +
                                  std::to_string(height) + "]}\n");
}

/// Of the robot's poses one in a hundred shows the board. Where a corner is out of view it may be
/// near the camera's plane, where its place in the image moves beyond all that is seen.
TEST(HandEye, IsKnowableWhereFewPosesShowTheBoard) {
    const io::CampaignFile campaign = hand_eye();
    EXPECT_EQ(find_unknowable(campaign).parameters, std::vector<std::string>{});
    EXPECT_EQ(find_identifiable(campaign).kept.size(), 12U);
}

/// A few of the robot's poses show the board to a camera that stands still: how many are enough is
/// counted of those.
TEST(HandEye, TakesAFewViewsHoweverFewPosesShowTheBoard) {
    const io::CampaignFile campaign = testing::campaign_from(
        "name: fixed\nrobot:\n  errors: none\n" + testing::small_arm + R"(sensor:
  kind: camera
  camera: fixed
  image_px: [1280, 960]
  sigma_px: 0.3
  intrinsics: {fx_px: 900, fy_px: 900, cx_px: 655, cy_px: 470}
  board: {columns: 8, rows: 5, square_mm: 25}
  place: {position_mm: [-80, -50, 40], rpy_deg: [90, 0, 0]}
  view: {most_tilt_deg: 55, least_corners: 20}
base: {position_mm: [0, 900, 1800], rpy_deg: [-90, 0, 90]}
)");
    EXPECT_EQ(least_calibration_count(campaign), 3);
    EXPECT_EQ(least_calibration_count(hand_eye()), 3);
}

/// From 5 m below the table the camera sees the back of its board.
TEST(HandEye, SaysWhereNoPoseShowsTheBoard) {
    const io::CampaignFile campaign = hand_eye(5000);
    try {
        random_candidates(campaign, 50, 1);
        FAIL() << "drawn";
    } catch (const InputError& error) {
        EXPECT_NE(
            std::string(error.what()).find("no pose looks at the board, so relax sensor.view"),
            std::string::npos)
            << error.what();
    }
    const Estimate estimate = detail::uncalibrated(campaign, campaign.nominal);
    EXPECT_FALSE(detail::expected_workspace_error(campaign, estimate));
}

/// Of the base, the robot's errors, the camera's place and its lens.
struct HandEyeCoverage {
    testing::Share base, robot, place, lens;
};

/// Campaigns of 25 views of 40 corners, intrinsics unknown, each with a robot and noise of its own.
HandEyeCoverage coverage_of(const Campaign& campaign, Index campaigns) {
    HandEyeCoverage coverage;
    const Index base = base_parameter_count(campaign);
    const Index robot = campaign.robot.parameter_count();
    for (Index run = 0; run < campaigns; ++run) {
        const auto seed = 2 * static_cast<std::uint64_t>(run);
        const Simulation simulated = simulate(
            campaign, {.pose_count = 25, .repeats = 1, .truth_seed = seed, .seed = seed + 1});
        const Estimate estimate =
            identify(campaign, simulated.measurements,
                     register_base_and_targets(campaign, simulated.measurements).parameters);
        const VectorXd errors = step_between(campaign, simulated.truth, estimate.parameters);
        const VectorXd deviations = standard_deviations(estimate);
        for (Index k = 0; k < errors.size(); ++k) {
            testing::Share& share = k < base               ? coverage.base
                                    : k < base + robot     ? coverage.robot
                                    : k < base + robot + 6 ? coverage.place
                                                           : coverage.lens;
            share.add(errors[k], deviations[k]);
        }
        for (testing::Share* share :
             {&coverage.base, &coverage.robot, &coverage.place, &coverage.lens}) {
            share->end_campaign();
        }
    }
    return coverage;
}

TEST(HandEye, IsWithinItsIntervalsAsOftenAsStated) {
    const HandEyeCoverage coverage =
        coverage_of(testing::design_campaign("camera/campaign.yaml"), 24);
    for (const testing::Share& share :
         {coverage.base, coverage.robot, coverage.place, coverage.lens}) {
        EXPECT_NEAR(share.value(), 0.95, 0.01 + 3 * share.deviation());
        EXPECT_LT(share.deviation(), 0.04);
    }
}

/// The figures themselves, in some minutes: run it with --gtest_also_run_disabled_tests.
TEST(HandEye, DISABLED_CoverageIsPrintedOfManyCampaigns) {
    constexpr Index campaigns = 1825;  // tells 94 and 96 % apart
    const HandEyeCoverage coverage =
        coverage_of(testing::design_campaign("camera/campaign.yaml"), campaigns);
    const auto print = [](const char* what, const testing::Share& share) {
        std::cout << fmt::format("{:20} {:5.2f} +- {:4.2f} %\n", what, 100 * share.value(),
                                 100 * share.deviation());
    };
    print("base", coverage.base);
    print("robot errors", coverage.robot);
    print("camera's place", coverage.place);
    print("lens", coverage.lens);
}

}  // namespace
}  // namespace posewise
