#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/criteria/criterion.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/inspection.hpp"
#include "support/held_robot.hpp"

/// calibrate() with an earlier estimate.
namespace posewise {
namespace {

using namespace testing;

TEST(EarlierEstimate, HoldsTheRobotWhileBaseAndTargetsAreFound) {
    const Campaign campaign = held_campaign();
    Parameters truth = draw_truth(campaign, 3);
    const Calibration first =
        calibrate(campaign, measure_at_random(campaign, truth, 24, 1), without_folds());
    Isometry3d move = Isometry3d::Identity();
    move.translate(Vector3d(1, -2, 0.5)).rotate(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
    const Measurements before = measure_at_random(campaign, truth, 20, 2);
    truth.world_from_base = move * truth.world_from_base;
    const Measurements after = measure_at_random(campaign, truth, 20, 2);

    CalibrationOptions options = without_folds();
    options.earlier = Earlier{first.estimate};
    options.earlier->use.only = {"base", "targets"};
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
    EXPECT_TRUE(first.sigmas_beside_held.empty());
    const VectorXd sigmas = standard_deviations(again.estimate);
    ASSERT_EQ(std::ssize(again.sigmas_beside_held), sigmas.size() - count);
    for (Index k = 0; k < sigmas.size(); ++k) {
        const auto beside =
            again.sigmas_beside_held.find(again.estimate.names[static_cast<std::size_t>(k)]);
        if (beside == again.sigmas_beside_held.end()) continue;
        EXPECT_LT(beside->second, sigmas[k]);
    }
    // Base and targets found with the robot follow what is wrong with it: together they are as sure
    // as the poses measured are.
    EXPECT_LT(again.expected.total(), 2 * first.expected.total());
    MatrixXd apart = again.estimate.covariance;
    apart.block(begin, 0, count, begin).setZero();
    apart.block(0, begin, begin, count).setZero();
    Estimate unrelated = again.estimate;
    unrelated.covariance = apart;
    EXPECT_GT(expected_error(again.campaign, unrelated, after).total(),
              1.2 * again.expected.total());

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
    judged.refitted = {"base", "targets"};
    const Measurements used = measure_at_random(campaign, first.estimate.parameters, 24, 1);
    const Calibration refitted = calibrate(campaign, used, judged);
    EXPECT_LT(refitted.validation->expected->total(), 2 * refitted.expected.total());
    const double here = refitted.validation->found.distance_rms;
    judged.validation = &moved;
    EXPECT_NEAR(calibrate(campaign, used, judged).validation->found.distance_rms, here, 1e-12);
    judged.refitted = {};
    EXPECT_GT(calibrate(campaign, used, judged).validation->found.distance_rms, 0.1);
}

TEST(EarlierEstimate, FindsTheErrorsThatAreNamed) {
    const Campaign campaign = held_campaign();
    Parameters truth = draw_truth(campaign, 4);
    CalibrationOptions options = without_folds();
    options.earlier =
        Earlier{calibrate(campaign, measure_at_random(campaign, truth, 24, 1), options).estimate};
    const std::vector<std::string> names = campaign.robot.parameter_names();
    const Index dq3 = std::find(names.begin(), names.end(), "dq3") - names.begin();
    truth.robot[dq3] += 5e-3;  // a motor was replaced
    options.earlier->use.only = {"base", "targets", "dq3"};
    const Calibration found =
        calibrate(campaign, measure_at_random(campaign, truth, 8, 2), options);
    const VectorXd change =
        found.estimate.parameters.robot - options.earlier->estimate.parameters.robot;
    EXPECT_NEAR(change[dq3], 5e-3, 2e-4);
    EXPECT_EQ((change.array() != 0).count(), 1);
}

TEST(EarlierEstimate, SaysWhatWasMovedSince) {
    const Campaign campaign = held_campaign();
    const Parameters truth = draw_truth(campaign, 6);
    CalibrationOptions options = without_folds();
    options.earlier =
        Earlier{calibrate(campaign, measure_at_random(campaign, truth, 24, 1), options).estimate,
                {.is_prior = true}};
    const auto moved_since = [&](const Parameters& now) {
        return calibrate(campaign, measure_at_random(campaign, now, 8, 2), options).moved_since;
    };
    EXPECT_FALSE(moved_since(truth));
    Parameters now = truth;
    now.world_from_base.translation().x() += 0.5;
    ASSERT_TRUE(moved_since(now));
    EXPECT_EQ(moved_since(now)->parts, std::vector<std::string>{"base"});
    EXPECT_NEAR(moved_since(now)->base, 0.5, 1e-3);
    now.sensor[4] += 0.02;
    ASSERT_TRUE(moved_since(now));
    EXPECT_EQ(moved_since(now)->parts, (std::vector<std::string>{"base", "targets"}));
    now.world_from_base = truth.world_from_base;
    ASSERT_TRUE(moved_since(now));
    EXPECT_EQ(moved_since(now)->parts, std::vector<std::string>{"targets"});
    EXPECT_NEAR(moved_since(now)->targets, 0.02, 1e-3);
    // What is identified anew may have moved, what is held may not.
    options.earlier->use = {.only = {"targets"}};
    EXPECT_FALSE(moved_since(now));
    options.earlier->use.only = {"base"};
    ASSERT_TRUE(moved_since(now));
    options.earlier->use = {.is_prior = true, .has_new_targets = true};
    EXPECT_FALSE(moved_since(now));
    now.robot[7] += 0.02;  // that is no move
    options.earlier->use = {.is_prior = true};
    now.sensor = truth.sensor;
    EXPECT_FALSE(moved_since(now));
}

/// Of measurements taken after base and targets were moved, by 1 m and 5 mm.
struct Moved {
    Estimate first;
    Parameters truth;
    Measurements measured;
};
Moved measure_moved(const Campaign& campaign, bool moves_base, bool moves_targets) {
    Moved moved;
    moved.truth = draw_truth(campaign, 3);
    moved.first =
        calibrate(campaign, measure_at_random(campaign, moved.truth, 24, 1), without_folds())
            .estimate;
    if (moves_base) moved.truth.world_from_base.pretranslate(Vector3d(1, 0, 0.2));
    if (moves_base) moved.truth.world_from_base.rotate(Eigen::AngleAxisd(0.9, Vector3d::UnitZ()));
    if (moves_targets) moved.truth.sensor.head<3>() += Vector3d(5e-3, -5e-3, 5e-3);
    moved.measured = measure_at_random(campaign, moved.truth, 12, 2);
    return moved;
}

std::vector<Campaign> campaigns_to_move() {
    Campaign poses = held_campaign();
    poses.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 5e-5);
    Isometry3d tool = Isometry3d::Identity();
    tool.translate(Vector3d(0.1, -0.02, 0.2)).rotate(Eigen::AngleAxisd(0.4, Vector3d::UnitY()));
    poses.nominal.sensor = tool_unknowns(tool);
    return {held_campaign(), poses};
}

TEST(EarlierEstimate, HoldsTargetsOrBaseAlone) {
    for (const Campaign& campaign : campaigns_to_move()) {
        const Index begin = base_parameter_count(campaign);
        const Index sensor = std::ssize(campaign.sensor->unknown_names());
        CalibrationOptions options = without_folds();
        const Moved base = measure_moved(campaign, true, false);
        options.earlier = Earlier{base.first};
        options.earlier->use.only = {"base"};
        const Calibration found = calibrate(campaign, base.measured, options);
        ASSERT_TRUE(found.is_identified()) << found.estimate.undetermined;
        EXPECT_EQ(found.estimate.names, parameter_names(campaign));
        EXPECT_EQ(found.estimate.parameters.sensor, base.first.parameters.sensor);
        EXPECT_EQ(found.estimate.covariance.bottomRightCorner(sensor, sensor),
                  base.first.covariance.bottomRightCorner(sensor, sensor));
        EXPECT_LT(found.estimate.fit.distance_rms, 5e-4);
        EXPECT_GT(found.nominal.distance_rms, 1.5 * found.estimate.fit.distance_rms);
        options.earlier->use.only = {"targets"};
        EXPECT_GT(calibrate(campaign, base.measured, options).estimate.fit.distance_rms, 0.1);

        const Moved targets = measure_moved(campaign, false, true);
        options.earlier = Earlier{targets.first};
        options.earlier->use.only = {"targets"};
        const Calibration held = calibrate(campaign, targets.measured, options);
        ASSERT_TRUE(held.is_identified());
        EXPECT_TRUE(held.estimate.parameters.world_from_base.isApprox(
            targets.first.parameters.world_from_base, 1e-15));
        EXPECT_EQ(held.estimate.covariance.topLeftCorner(begin, begin),
                  targets.first.covariance.topLeftCorner(begin, begin));
        EXPECT_LT(held.estimate.fit.distance_rms, 5e-4);
        options.earlier->use.only = {"base"};
        EXPECT_GT(calibrate(campaign, targets.measured, options).estimate.fit.distance_rms, 1e-3);

        // Judged on them, what was moved alone is refitted.
        CalibrationOptions judged = without_folds();
        const Measurements used = measure_at_random(campaign, draw_truth(campaign, 3), 24, 1);
        judged.validation = &base.measured;
        judged.refitted = {"base"};
        const double refitted = calibrate(campaign, used, judged).validation->found.distance_rms;
        EXPECT_NEAR(refitted, found.estimate.fit.distance_rms, 1e-9);
        judged.refitted = {"targets"};
        EXPECT_GT(calibrate(campaign, used, judged).validation->found.distance_rms, 0.1);
    }
}

TEST(EarlierEstimate, PlansThePosesThatReRegisterAsPredicted) {
    const Campaign campaign = held_campaign();
    Earlier earlier{calibrate(campaign, measure_at_random(campaign, draw_truth(campaign, 3), 24, 1),
                              without_folds())
                        .estimate};
    earlier.estimate.model_error = 0;  // the robot is as it was found
    earlier.use.only = {"base", "targets"};
    const Campaign held = with_earlier(campaign, earlier);
    EXPECT_EQ(parameter_count(held), 15);
    ChoiceOptions options;
    options.pose_count = 5;
    options.criterion = Criterion::V;
    const Plan plan = choose(held, random_candidates(campaign, 200, 4), options);
    RowMatrixXd configurations(5, 6);
    for (Index i = 0; i < 5; ++i) {
        configurations.row(i) = plan.poses[static_cast<std::size_t>(i)].configuration.transpose();
    }
    const MatrixXd M =
        information(make_blocks(held, held.nominal, configurations, 1.0)) + prior_information(held);
    const VectorXd scale = parameter_scale(held);
    const MatrixXd covariance =
        scale.asDiagonal() * M.llt().solve(MatrixXd::Identity(15, 15)) * scale.asDiagonal();

    constexpr int times = 600;
    const Campaign quiet = with_model_error(campaign, earlier.estimate);
    const Parameters& truth = earlier.estimate.parameters;
    MatrixXd found = MatrixXd::Zero(15, 15);
    for (int i = 0; i < times; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        const Measurements measured = simulate_measurements(quiet, truth, configurations, 1, seed);
        const Parameters start = determined(register_base_and_targets(held, measured));
        EXPECT_EQ(start.robot.size(), 0);
        const VectorXd off =
            step_between(held, held.nominal, identify(held, measured, start).parameters);
        found += off * off.transpose() / times;
    }
    // Of 600 draws: every direction's variance within 25 %, their sum within 10 %.
    const MatrixXd ratio = covariance.llt().solve(found);
    EXPECT_NEAR(ratio.trace() / 15, 1, 0.05);
    for (Index k = 0; k < 15; ++k) EXPECT_NEAR(found(k, k) / covariance(k, k), 1, 0.25) << k;
}

TEST(EarlierEstimate, TellsWhereRobotBaseAndTargetsAre) {
    const Campaign campaign = held_campaign();
    Earlier earlier{calibrate(campaign, measure_at_random(campaign, draw_truth(campaign, 3), 24, 1),
                              without_folds())
                        .estimate};
    earlier.estimate.spread = campaign.spread;
    earlier.estimate.spread->length = 3e-3;
    const Parameters& found = earlier.estimate.parameters;
    const Campaign expected = with_earlier(campaign, earlier);
    EXPECT_EQ(expected.nominal.robot, found.robot);
    EXPECT_EQ(expected.nominal.sensor, found.sensor);
    EXPECT_TRUE(expected.nominal.world_from_base.isApprox(found.world_from_base, 0));
    EXPECT_EQ(expected.model_error, earlier.estimate.model_error);
    EXPECT_EQ(expected.spread.length, 3e-3);
    EXPECT_FALSE(expected.prior);
    earlier.use.has_new_base = true;
    EXPECT_TRUE(with_earlier(campaign, earlier)
                    .nominal.world_from_base.isApprox(campaign.nominal.world_from_base, 0));

    // Measurements register the robot as it was found, no other.
    const Measurements measured = measure_at_random(campaign, draw_truth(campaign, 3), 20, 8);
    const auto missed = [&](const Campaign& one) {
        const Parameters registered = determined(register_base_and_targets(one, measured));
        return make_metrics(residuals(one, registered, measured)).distance_rms;
    };
    EXPECT_LT(missed(expected), 3e-4);
    EXPECT_GT(missed(campaign), 1e-3);
}

TEST(EarlierEstimate, ExpectsTheModelErrorThatResidualsShow) {
    const Campaign whole = held_campaign();
    const Measurements measured = measure_at_random(whole, draw_truth(whole, 3), 60, 1);
    // No error of the robot is found, and without priors no model error is either.
    const Campaign campaign = with_robot(whole, without_parameters(whole.robot));
    const Earlier earlier{calibrate(campaign, measured, without_folds()).estimate};
    const double left = earlier.estimate.fit.distance_rms / std::sqrt(3);
    EXPECT_GT(left, 5 * campaign.model_error);
    EXPECT_EQ(earlier.estimate.model_error, campaign.model_error);
    EXPECT_NEAR(with_earlier(campaign, earlier).model_error / left, 1, 0.2);
}

TEST(EarlierEstimate, HoldsWhatGivesWayUnderMeasuredTorques) {
    Campaign campaign = testing::tracked_campaign(
        with_measured_compliance(without_parameters(testing::fanuc()), {{1, 300}, {2, 200}}));
    const Parameters truth = draw_truth(campaign, 3);
    CalibrationOptions options = without_folds();
    const Measurements measured = measure_at_random(campaign, truth, 12, 1);
    options.earlier = Earlier{calibrate(campaign, measured, options).estimate};
    options.earlier->use.only = {"base", "targets"};
    const Calibration found =
        calibrate(campaign, measure_at_random(campaign, truth, 12, 2), options);
    ASSERT_TRUE(found.is_identified());
    EXPECT_EQ(found.estimate.parameters.robot, options.earlier->estimate.parameters.robot);
    EXPECT_LT(found.estimate.fit.distance_rms, 4e-4);
}

TEST(EarlierEstimate, ScalesWhatGivesWayWithTheLoad) {
    const Chain robot = with_measured_compliance(testing::fanuc(), {{1, 300}});
    const Chain lighter = with_measured_compliance(testing::fanuc(), {{1, 150}});
    const VectorXd errors = VectorXd::Constant(robot.parameter_count(), 1e-3);
    VectorXd halved = errors;
    halved[compliances(robot).front().parameter] /= 2;
    EXPECT_EQ(errors_under_loads(robot, errors, robot), errors);
    EXPECT_EQ(errors_under_loads(robot, errors, lighter), halved);
    EXPECT_THROW(errors_under_loads(robot, errors, without_parameters(robot)), InputError);
}

TEST(EarlierEstimate, RefusesWhatMakesNoSense) {
    const Campaign campaign = held_campaign();
    const Measurements measured = measure_at_random(campaign, draw_truth(campaign, 3), 12, 1);
    CalibrationOptions options = without_folds();
    options.earlier = Earlier{calibrate(campaign, measured, without_folds()).estimate};
    options.earlier->use.only = {"base", "targets", "dq9"};
    EXPECT_THROW(calibrate(campaign, measured, options), InputError);
    options.earlier->use.only = {"base"};
    options.earlier->use.has_new_targets = true;
    EXPECT_THROW(calibrate(campaign, measured, options), InputError);
    options.earlier->use = {};
    options.earlier->estimate.names.pop_back();
    EXPECT_THROW(calibrate(campaign, measured, options), InputError);
    options.earlier->estimate.names = parameter_names(campaign);
    options.method = CalibrationMethod::Global;
    EXPECT_THROW(calibrate(campaign, measured, options), InputError);
}

}  // namespace
}  // namespace posewise
