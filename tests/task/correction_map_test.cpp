#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/task/correction.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

/// A robot that bends, whose drives have periodic errors.
Campaign bending_campaign() {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.robot = with_harmonics(with_torque_shapes(campaign.robot), {1, 2});
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return campaign;
}

TEST(CorrectionMap, HoldsWhatTheGeometryCannot) {
    const Campaign campaign = bending_campaign();
    const Parameters found = draw_truth(campaign, 3);
    const CorrectionMap map = correction_map(campaign, found);
    EXPECT_GT(map.geometry_alone.rms, 1e-3);
    EXPECT_GT(map.geometry_alone.largest, map.geometry_alone.p95);
    EXPECT_GT(map.geometry_alone.p95, map.geometry_alone.rms);
    // Within the amounts that are left out, at the reach of the arm.
    EXPECT_LT(map.with_map.largest, 6 * 1e-7 * 4);
    EXPECT_LT(map.with_map.orientation, 6 * 1e-7);
    EXPECT_LT(map.terms.size(), 600U);
    MapOptions coarse;
    coarse.negligible = 1e-5;
    const CorrectionMap rough = correction_map(campaign, found, coarse);
    EXPECT_LT(rough.terms.size(), map.terms.size());
    EXPECT_GT(rough.with_map.rms, map.with_map.rms);
    EXPECT_LT(rough.with_map.largest, 6 * 1e-5 * 4);
    // The same sums from definitions, at a pose of no grid.
    VectorXd q(6);
    q << 0.3, -0.2, 0.5, 1.1, -0.7, 2.2;
    VectorXd constant = found.robot;
    for (Index k = 0; k < constant.size(); ++k) {
        if (campaign.robot.parameter_term(k) != nullptr) constant[k] = 0;
    }
    const VectorXd seems = q + value_at(map, q);
    const Isometry3d left = campaign.robot.base_from_flange(q, found.robot).inverse() *
                            campaign.robot.base_from_flange(seems, constant);
    EXPECT_LT(left.translation().norm(), 1e-6);
}

TEST(CorrectionMap, HasScalesAndPeriodsOfSlides) {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    std::vector<Joint> joints = campaign.robot.joints();
    joints.insert(joints.begin(), Joint{"track", 0, 2, Motion::Translation, 0.1});
    std::vector<Element> elements;
    elements.push_back(testing::driven(Motion::Translation, Axis::X, 0));
    for (Element element : campaign.robot.elements()) {
        for (JointTerm& term : element.joints) ++term.joint;
        elements.push_back(element);
    }
    campaign.robot = with_gains(with_harmonics(Chain(joints, elements), {1}));
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    const CorrectionMap map = correction_map(campaign, draw_truth(campaign, 3));
    EXPECT_GT(map.geometry_alone.rms, 1e-4);
    EXPECT_LT(map.with_map.largest, 6 * 1e-7 * 4);
}

TEST(CorrectionMap, IsRefusedWhereThereIsNothing) {
    const Campaign campaign = testing::tracked_campaign(testing::fanuc());
    EXPECT_THROW(correction_map(campaign, draw_truth(campaign, 3)), InputError);
}

}  // namespace
}  // namespace posewise
