#include "../../src/calibrator/joint_signs.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/measurement/simulation.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::tracked_campaign;

Measurements reverse(Measurements measurements, const std::vector<bool>& is_reversed) {
    for (std::size_t j = 0; j < is_reversed.size(); ++j) {
        if (is_reversed[j]) measurements.configurations.col(static_cast<Index>(j)) *= -1;
    }
    return measurements;
}

/// The FANUC on a rail has no symmetry; a half turn of base and flange about the first axis
/// reverses every other joint of the seven-joint arm.
TEST(JointSigns, AreFoundForRobotsWithErrors) {
    const std::vector<std::pair<Chain, std::size_t>> robots{
        {testing::fanuc(), 1}, {testing::rail_with_fanuc(), 1}, {testing::seven_joint_arm(), 2}};
    for (const auto& [robot, symmetries] : robots) {
        Campaign campaign = tracked_campaign(robot);
        campaign = with_robot(campaign, irreducible_model(campaign));
        for (std::uint64_t item = 0; item < 3; ++item) {
            RandomStream stream(9, item);
            std::vector<bool> is_reversed;
            for (Index j = 0; j < robot.joint_count(); ++j) {
                is_reversed.push_back(stream.uniform() < 0.5);
            }
            const Simulation simulation =
                simulate(campaign, {.pose_count = 100, .truth_seed = item});
            const auto patterns =
                fit_joint_signs(campaign, reverse(simulation.measurements, is_reversed), 30)
                    .patterns;
            ASSERT_EQ(patterns.size(), std::size_t{1} << robot.joint_count());
            std::size_t alike = 0;
            while (patterns[alike].distance_rms < 1.001 * patterns[0].distance_rms) ++alike;
            EXPECT_EQ(alike, symmetries) << robot.joint_count() << ' ' << item;
            const auto end = patterns.begin() + static_cast<std::ptrdiff_t>(alike);
            EXPECT_TRUE(std::any_of(
                patterns.begin(), end,
                [&](const SignPattern& pattern) { return pattern.is_reversed == is_reversed; }))
                << robot.joint_count() << ' ' << item;
            const bool is_stated = &as_stated(patterns) < &*end;
            EXPECT_EQ(has_clear_reversal(patterns), !is_stated);
            EXPECT_EQ(alike_count(patterns), static_cast<Index>(symmetries));
            EXPECT_LT(patterns[0].distance_rms, 0.01);
            EXPECT_GT(patterns[alike].distance_rms, 5 * patterns[0].distance_rms);
        }
    }
}

/// A planar arm's mirror image is the arm seen from behind.
TEST(JointSigns, ThatMeasurementsCannotTellApartFitAlike) {
    std::vector<Element> elements = testing::planar_arm({0.5, 0.4}).elements();
    elements.push_back(testing::driven(Motion::Rotation, Axis::X, 2));
    std::vector<Joint> joints = testing::planar_arm({0.5, 0.4}).joints();
    joints.push_back({"roll", -3, 3});
    const Campaign campaign = tracked_campaign(without_parameters(Chain(joints, elements)));
    const Simulation simulation = simulate(campaign, {.pose_count = 40});
    const auto patterns = fit_joint_signs(campaign, simulation.measurements).patterns;
    EXPECT_EQ(patterns[0].is_reversed, std::vector<bool>(3, false));  // the simplest is first
    EXPECT_EQ(patterns[1].is_reversed[0], patterns[1].is_reversed[1]);
    EXPECT_NE(patterns[1].is_reversed, patterns[0].is_reversed);
    EXPECT_NEAR(patterns[1].distance_rms, patterns[0].distance_rms, 1e-6);
    EXPECT_GT(patterns[2].distance_rms, 10 * patterns[1].distance_rms);
}

TEST(JointSigns, OfMeasurementsThatNoChoiceFitsAreNotClear) {
    const Campaign campaign = tracked_campaign(testing::seven_joint_arm());
    Measurements measurements = simulate(campaign, {.pose_count = 30}).measurements;
    const RowMatrixXd observed = measurements.observations;
    for (Index i = 0; i < 30; ++i) measurements.observations.row(i) = observed.row((i + 1) % 30);
    const auto patterns = fit_joint_signs(campaign, measurements).patterns;
    EXPECT_FALSE(has_clear_reversal(patterns));
    const Registration registered = register_base_and_targets(campaign, measurements);
    const double rms =
        make_metrics(residuals(campaign, registered.parameters, measurements)).distance_rms;
    EXPECT_NEAR(as_stated(patterns).distance_rms, rms, 1e-6 * rms);
}

TEST(JointSigns, TakeAllConfigurationsWhereSomeHideATarget) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    Measurements measurements = simulate(campaign, {.pose_count = 30}).measurements;
    for (Index i = 0; i < 30; i += 2) measurements.is_seen(i, 2) = false;
    const auto patterns = fit_joint_signs(campaign, measurements, 15).patterns;
    EXPECT_EQ(patterns[0].is_reversed, std::vector<bool>(6, false));
}

TEST(JointSigns, RefuseWhatTheyCannotTry) {
    const Campaign still = tracked_campaign(testing::fanuc());
    const auto same =
        simulate_measurements(still, still.nominal, RowMatrixXd::Constant(8, 6, 0.1), 1, 3);
    const JointSigns signs = fit_joint_signs(still, same);
    EXPECT_TRUE(signs.patterns.empty());
    EXPECT_EQ(signs.undetermined.find("these 8 configurations with 24 points do not"), 0U);
    const Campaign snake = tracked_campaign(testing::planar_arm(std::vector<double>(13, 0.1)));
    const auto many = simulate(snake, {.pose_count = 20}).measurements;
    EXPECT_THROW(fit_joint_signs(snake, many), InputError);
}

}  // namespace
}  // namespace posewise
