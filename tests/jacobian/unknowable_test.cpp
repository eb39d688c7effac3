#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "support/campaigns.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace testing;

using Words = std::vector<std::string>;

/// One joint that turns, or slides.
Chain one_axis(Motion motion) {
    return Chain({{"q1", -1, 1}}, {driven(motion, Axis::Z, 0), translation(Axis::X, 0.5)});
}

Chain plain_gantry() {
    return Chain({{"q1", 0, 1}, {"q2", 0, 1}, {"q3", 0, 1}},
                 {driven(Motion::Translation, Axis::X, 0), driven(Motion::Translation, Axis::Y, 1),
                  driven(Motion::Translation, Axis::Z, 2)});
}

/// The base's frame parallel to the instrument's, as most are stated.
Campaign upright(const Chain& robot) {
    Campaign campaign = tracked_campaign(robot);
    campaign.nominal.world_from_base.linear().setIdentity();
    return campaign;
}

TEST(Unknowable, IsNothingOfARobotWhoseAxesCross) {
    EXPECT_TRUE(find_unknowable(tracked_campaign(fanuc())).parameters.empty());
    EXPECT_NO_THROW(check_knowable(tracked_campaign(ur_type())));
}

TEST(Unknowable, IsTheHeightOfARobotWithParallelAxes) {
    const Campaign campaign = upright(scara());
    const Unknowable found = find_unknowable(campaign);
    EXPECT_EQ(found.parameters.size(), 1U);
    EXPECT_EQ(describe_cures(found, campaign),
              "known: [z], keys base.known or sensor.targets.known");
    EXPECT_NE(input_error_of([&] { check_knowable(campaign); }).find("known: [z], keys base.known"),
              std::string::npos);
}

TEST(Unknowable, IsThePlaceOfAGantryThatTurnsNothing) {
    const Campaign campaign = upright(plain_gantry());
    const Unknowable found = find_unknowable(campaign);
    EXPECT_EQ(found.parameters.size(), 3U);
    EXPECT_EQ(describe_cures(found, campaign),
              "known: [x, y, z], keys base.known or sensor.targets.known");
}

/// The campaign with what a cure says is known.
Campaign with_known(Campaign campaign, const KnownAxes& known) {
    const auto has = [](const Words& words, const std::string& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    };
    const Words names{"x", "y", "z", "rx", "ry", "rz"};
    std::array<bool, 3> is_known{};
    for (std::size_t k = 0; k < names.size(); ++k) {
        campaign.base_is_known[k] = has(known.base, names[k]);
        if (k < 3) is_known[k] = has(known.targets, names[k]);
    }
    std::vector<Vector3d> places;
    std::vector<double> unknowns;
    for (Index t = 0; t < 3; ++t) {
        places.emplace_back(campaign.nominal.sensor.segment<3>(3 * t));
        for (std::size_t k = 0; k < 3; ++k) {
            if (!is_known[k]) unknowns.push_back(places.back()[static_cast<Index>(k)]);
        }
    }
    campaign.sensor =
        std::make_shared<PointSensor>(Targets(places, {3, is_known}), IsotropicNoise{5e-5});
    campaign.nominal.sensor = Eigen::Map<VectorXd>(unknowns.data(), std::ssize(unknowns));
    return campaign;
}

TEST(Unknowable, IsCuredByEachStatementItNames) {
    for (const Chain& robot : {scara(), one_axis(Motion::Rotation), one_axis(Motion::Translation),
                               plain_gantry(), planar_arm({1, 0.8})}) {
        const Campaign campaign = upright(robot);
        const Unknowable found = find_unknowable(campaign);
        ASSERT_FALSE(found.cures.empty());
        for (const KnownAxes& known : found.cures) {
            EXPECT_TRUE(find_unknowable(with_known(campaign, known)).parameters.empty());
        }
    }
}

}  // namespace
}  // namespace posewise
