#include <gtest/gtest.h>

#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/doubts.hpp"
#include "support/campaigns.hpp"
#include "support/sensors.hpp"

// Of several cameras one that is at fault is named, and not the robot.

namespace posewise {
namespace {

using namespace testing;

constexpr Index corner_count = 12;

Campaign rig() {
    CameraSetup setup = fixed_camera();
    setup.others = {setup};
    Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    campaign.spread = population_spread(campaign.robot);
    return campaign;
}

/// What is said after `spoil(row)` of each observation of the second camera.
template <typename Spoil>
std::optional<Misfit> misfit_after(const Campaign& campaign, const Spoil& spoil) {
    Measurements measured = simulate(campaign, {.pose_count = 25, .repeats = 1}).measurements;
    spoil(measured);
    const Registration registered = register_base_and_targets(campaign, measured);
    EXPECT_TRUE(registered.is_determined()) << registered.undetermined;
    return find_misfit(campaign, measured, registered.parameters);
}

TEST(CameraMisfit, IsNoneWhereAllIsWell) {
    EXPECT_FALSE(misfit_after(rig(), [](Measurements&) {}));
}

TEST(CameraMisfit, IsOfTheCameraWhoseColumnsAreExchanged) {
    const Campaign campaign = rig();
    const auto misfit = misfit_after(campaign, [](Measurements& measured) {
        for (Index k = 0; k < corner_count; ++k) {
            const Index u = 2 * (corner_count + k);
            measured.observations.col(u).swap(measured.observations.col(u + 1));
        }
    });
    ASSERT_TRUE(misfit);
    ASSERT_EQ(misfit->camera, 1);
    EXPECT_GT(misfit->distance, 3 * misfit->others);
    const std::string words = describe_misfit(campaign, *misfit);
    EXPECT_EQ(words.rfind("camera 2 is at fault: the nominal robot misses half", 0), 0U) << words;
}

TEST(CameraMisfit, IsOfTheCameraWhoseViewsComeLate) {
    const auto misfit = misfit_after(rig(), [](Measurements& measured) {
        const RowMatrixXd seen = measured.observations.rightCols(2 * corner_count);
        const Seen is_seen = measured.is_seen.rightCols(corner_count);
        const Index last = seen.rows() - 1;
        measured.observations.bottomRightCorner(last, 2 * corner_count) = seen.topRows(last);
        measured.is_seen.bottomRightCorner(last, corner_count) = is_seen.topRows(last);
        measured.is_seen.topRightCorner(1, corner_count).setConstant(false);
    });
    ASSERT_TRUE(misfit);
    EXPECT_EQ(misfit->camera, 1);
}

TEST(CameraMisfit, IsNotJudgedOfACameraThatShowsTooLittle) {
    const auto misfit = misfit_after(rig(), [](Measurements& measured) {
        measured.configurations.col(2) *= -1;
        measured.is_seen.bottomRightCorner(measured.is_seen.rows() - 1, corner_count)
            .setConstant(false);
    });
    ASSERT_TRUE(misfit);
    EXPECT_FALSE(misfit->camera || misfit->is_between_cameras);
}

TEST(CameraMisfit, IsOfNoneAloneWhereOneNumbersTheBoardFromItsOtherEnd) {
    const Campaign campaign = rig();
    const auto misfit = misfit_after(campaign, [](Measurements& measured) {
        const RowMatrixXd seen = measured.observations.rightCols(2 * corner_count);
        const Seen is_seen = measured.is_seen.rightCols(corner_count);
        for (Index k = 0; k < corner_count; ++k) {
            const Index other = corner_count - 1 - k;
            measured.observations.middleCols(2 * (corner_count + k), 2) =
                seen.middleCols(2 * other, 2);
            measured.is_seen.col(corner_count + k) = is_seen.col(other);
        }
    });
    ASSERT_TRUE(misfit);
    EXPECT_FALSE(misfit->camera);
    EXPECT_TRUE(misfit->is_between_cameras);
    EXPECT_NE(describe_misfit(campaign, *misfit).find("number the corners alike"),
              std::string::npos);
}

}  // namespace
}  // namespace posewise
