#include <gtest/gtest.h>

#include <algorithm>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/simulation.hpp"
#include "posewise/model/transforms.hpp"
#include "posewise/task/calibration.hpp"
#include "support/campaigns.hpp"

/// calibrate() with an earlier estimate.
namespace posewise {
namespace {

Campaign held_campaign() {
    const Chain bare = without_parameters(testing::fanuc());
    Campaign campaign = with_robot(testing::tracked_campaign(bare), detail::complete_model(bare));
    campaign.spread = population_spread(bare);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 5e-5);
    return campaign;
}

Measurements measure(const Campaign& campaign, const Parameters& truth, Index count,
                     std::uint64_t seed) {
    return simulate_measurements(
        campaign, truth, detail::random_configurations(campaign.robot, count, seed), 1, seed);
}

CalibrationOptions without_folds() {
    CalibrationOptions options;
    options.folds = 0;
    return options;
}

TEST(EarlierEstimate, HoldsTheRobotWhileBaseAndTargetsAreFound) {
    const Campaign campaign = held_campaign();
    Parameters truth = draw_truth(campaign, 3);
    const Calibration first = calibrate(campaign, measure(campaign, truth, 24, 1), without_folds());
    Isometry3d move = Isometry3d::Identity();
    move.translate(Vector3d(1, -2, 0.5)).rotate(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
    const Measurements before = measure(campaign, truth, 20, 2);
    truth.world_from_base = move * truth.world_from_base;
    const Measurements after = measure(campaign, truth, 20, 2);

    CalibrationOptions options = without_folds();
    options.earlier = Earlier{first.estimate};
    options.only = {"base", "targets"};
    const Calibration again = calibrate(campaign, after, options);
    ASSERT_TRUE(again.is_identified());
    EXPECT_EQ(again.estimate.parameters.robot, first.estimate.parameters.robot);
    EXPECT_EQ(again.estimate.names, first.estimate.names);
    const Index begin = base_parameter_count(campaign);
    const Index count = campaign.robot.parameter_count();
    EXPECT_EQ(again.estimate.covariance.block(begin, begin, count, count),
              first.estimate.covariance.block(begin, begin, count, count));
    EXPECT_LT((again.estimate.parameters.world_from_base.translation() -
               (move * first.estimate.parameters.world_from_base).translation())
                  .norm(),
              1e-3);
    EXPECT_LT(again.estimate.fit.distance_rms, 4e-4);

    // Judged on poses measured before or after the move, refitted, the error is the same.
    CalibrationOptions judged = without_folds();
    // Moved exactly, since what is simulated anew has its noise in another frame.
    Measurements moved = before;
    for (Index i = 0; i < moved.observations.rows(); ++i) {
        for (Index j = 0; j < 3; ++j) {
            const Vector3d p = before.observations.row(i).segment<3>(3 * j).transpose();
            moved.observations.row(i).segment<3>(3 * j) = (move * p).transpose();
        }
    }
    judged.validation = &before;
    judged.refits_validation = true;
    const Measurements used = measure(campaign, first.estimate.parameters, 24, 1);
    const double here = calibrate(campaign, used, judged).validation->distance_rms;
    judged.validation = &moved;
    EXPECT_NEAR(calibrate(campaign, used, judged).validation->distance_rms, here, 1e-12);
    judged.refits_validation = false;
    EXPECT_GT(calibrate(campaign, used, judged).validation->distance_rms, 0.1);
}

TEST(EarlierEstimate, FindsTheErrorsThatAreNamed) {
    const Campaign campaign = held_campaign();
    Parameters truth = draw_truth(campaign, 4);
    CalibrationOptions options = without_folds();
    options.earlier =
        Earlier{calibrate(campaign, measure(campaign, truth, 24, 1), options).estimate};
    const std::vector<std::string> names = campaign.robot.parameter_names();
    const Index dq3 = std::find(names.begin(), names.end(), "dq3") - names.begin();
    truth.robot[dq3] += 5e-3;  // a motor was replaced
    options.only = {"base", "targets", "dq3"};
    const Calibration found = calibrate(campaign, measure(campaign, truth, 8, 2), options);
    const VectorXd change =
        found.estimate.parameters.robot - options.earlier->estimate.parameters.robot;
    EXPECT_NEAR(change[dq3], 5e-3, 2e-4);
    EXPECT_EQ((change.array() != 0).count(), 1);
}

TEST(EarlierEstimate, AsPriorMakesFourPosesAlmostAsGoodAsSixteen) {
    const Campaign campaign = held_campaign();
    constexpr int robots = 40;
    std::vector<double> ratios;
    Index inside = 0;
    Index intervals = 0;
    for (std::uint64_t seed = 0; seed < robots; ++seed) {
        Parameters truth = draw_truth(campaign, seed);
        CalibrationOptions options = without_folds();
        options.earlier = Earlier{
            calibrate(campaign, measure(campaign, truth, 12, seed), options).estimate, true};
        const Index count = campaign.robot.parameter_count();
        RandomStream stream(1000 + seed);
        for (Index k = 0; k < count; ++k) {
            const bool is_offset = !campaign.robot.parameter_element(k).joints.empty();
            if (is_offset) truth.robot[k] += options.earlier->drift.offset * stream.normal();
        }
        const Measurements sixteen = measure(campaign, truth, 16, 500 + seed);
        const Calibration few = calibrate(campaign, take(sixteen, {0, 1, 2, 3}), options);
        const Calibration many = calibrate(campaign, sixteen, without_folds());
        const Measurements fresh = measure(campaign, truth, 40, 900 + seed);
        const auto held_out = [&](const Calibration& calibration) {
            return make_metrics(residuals(campaign, calibration.estimate.parameters, fresh))
                .distance_rms;
        };
        ratios.push_back(held_out(few) / held_out(many));
        const Index begin = base_parameter_count(campaign);
        const VectorXd sigmas = standard_deviations(few.estimate).segment(begin, count);
        const VectorXd off = few.estimate.parameters.robot - truth.robot;
        inside += (off.array().abs() < 1.96 * sigmas.array()).count();
        intervals += count;
    }
    std::nth_element(ratios.begin(), ratios.begin() + robots / 2, ratios.end());
    // What 0.1 mrad in each of six joints has changed, four poses find in part.
    EXPECT_LE(ratios[robots / 2], 1.1);
    const double share = static_cast<double>(inside) / static_cast<double>(intervals);
    EXPECT_GE(share, 0.93);
    EXPECT_LE(share, 0.97);
    RecordProperty("median_ratio", std::to_string(ratios[robots / 2]));
    RecordProperty("coverage", std::to_string(share));
}

TEST(EarlierEstimate, RefusesWhatMakesNoSense) {
    const Campaign campaign = held_campaign();
    const Measurements measured = measure(campaign, draw_truth(campaign, 3), 12, 1);
    CalibrationOptions options = without_folds();
    options.only = {"base", "targets"};
    EXPECT_THROW(calibrate(campaign, measured, options), InputError);
    options.earlier = Earlier{calibrate(campaign, measured, without_folds()).estimate};
    for (const std::vector<std::string>& only :
         {std::vector<std::string>{"base"}, {"targets", "robot"}, {"base", "targets", "dq9"}}) {
        options.only = only;
        EXPECT_THROW(calibrate(campaign, measured, options), InputError);
    }
    options.only = {};
    options.method = CalibrationMethod::Global;
    EXPECT_THROW(calibrate(campaign, measured, options), InputError);
}

}  // namespace
}  // namespace posewise
