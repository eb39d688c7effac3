#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/choice.hpp"
#include "support/campaign_from.hpp"
#include "task/calibration/expected_distance.hpp"
#include "task/plan/workspace.hpp"

namespace posewise {
namespace {

/// `height`: of the robot's base, along the board's z, which points into the table, mm.
io::CampaignFile hand_eye(int height = 0) {
    return testing::campaign_from(R"(
name: hand and eye
robot:
  errors: none
  joints:
    q1: {limits_deg: [-180, 180]}
    q2: {limits_deg: [-180, 0]}
    q3: {limits_deg: [-150, 150]}
    q4: {limits_deg: [-180, 180]}
    q5: {limits_deg: [-180, 180]}
    q6: {limits_deg: [-180, 180]}
  elements:
    [Rz q1, Tz 89.2 mm, Rx 90 deg, Rz q2, Tx -425 mm, Rz q3, Tx -392 mm, Rz q4, Tz 109.3 mm,
     Rx 90 deg, Rz q5, Tz 94.75 mm, Rx -90 deg, Rz q6, Tz 82.5 mm]
sensor:
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

}  // namespace
}  // namespace posewise
