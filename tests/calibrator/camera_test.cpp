#include <gtest/gtest.h>

#include "../../src/calibrator/least_squares.hpp"
#include "../../src/calibrator/robust.hpp"
#include "../../src/measurement/feasible.hpp"
#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

/// Of a robot that is exactly as stated.
Campaign hand_eye(CameraSetup setup) {
    setup.corners = chessboard(6, 4, 0.04);
    setup.view.least_corners = 6;
    const Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    return with_robot(campaign, without_parameters(campaign.robot));
}

CameraSetup on_flange_with_lens() {
    CameraSetup setup = fixed_camera();
    setup.is_on_flange = true;
    return setup;
}

CameraSetup unknown_lens(CameraSetup setup) {
    setup.is_known.assign(setup.intrinsics.names().size(), false);
    return setup;
}

/// Errors of an estimate in its standard deviations.
VectorXd in_deviations(const Campaign& campaign, const Parameters& truth,
                       const Estimate& estimate) {
    return step_between(campaign, truth, estimate.parameters)
        .cwiseQuotient(standard_deviations(estimate));
}

/// The same without what it knows of places and of unknown intrinsic parameters.
Campaign blind(const Campaign& campaign) {
    Campaign blind = campaign;
    CameraSetup setup = dynamic_cast<const CameraSensor&>(*campaign.sensor).setup();
    VectorXd values = setup.intrinsics.values();
    for (std::size_t k = 0; k < setup.is_known.size(); ++k) {
        if (!setup.is_known[k]) values[static_cast<Index>(k)] = 0;
    }
    setup.intrinsics = setup.intrinsics.with(values);
    for (SingleCamera& other : setup.others) {
        if (!other.is_known[0]) other.intrinsics = other.intrinsics.with(0 * values);
    }
    blind.sensor = std::make_shared<CameraSensor>(setup);
    blind.nominal.world_from_base.setIdentity();
    blind.nominal.sensor.setZero();
    blind.has_nominal_base = blind.has_nominal_targets = false;
    return blind;
}

TEST(Camera, IsRegisteredFromNothing) {
    for (const CameraSetup& setup :
         {fixed_camera(), on_flange_with_lens(), unknown_lens(fixed_camera()),
          unknown_lens(on_flange_with_lens()), three_cameras()}) {
        Campaign exact = hand_eye(setup);
        exact.model_error = exact.model_error_orientation = 0;
        const Simulation simulated =
            simulate(exact, {.pose_count = 20, .repeats = 1, .truth_seed = 4, .seed = 3});
        const Registration found = register_base_and_targets(blind(exact), simulated.measurements);
        ASSERT_TRUE(found.is_determined()) << found.undetermined;
        const Estimate estimate = identify(exact, simulated.measurements, found.parameters);
        EXPECT_NEAR(estimate.variance_factor, 1,
                    5 * std::sqrt(2.0 / static_cast<double>(estimate.degrees_of_freedom)));
        EXPECT_LT(in_deviations(exact, simulated.truth, estimate).cwiseAbs().maxCoeff(), 5);
    }
}

TEST(Camera, IsRegisteredFromPartsOfTheBoard) {
    Campaign exact = hand_eye(fixed_camera());
    exact.model_error = exact.model_error_orientation = 0;
    Simulation simulated =
        simulate(exact, {.pose_count = 30, .repeats = 1, .truth_seed = 4, .seed = 3});
    Measurements& measured = simulated.measurements;
    for (Index i = 0; i < measured.is_seen.rows(); ++i) {
        for (Index k = 0; k < measured.is_seen.cols(); ++k) {
            if ((k + i) % 3 == 0) measured.is_seen(i, k) = false;
        }
    }
    measured.is_seen.row(7).setConstant(false);  // too few for a pose
    measured.is_seen.row(7).head(3).setConstant(true);
    const Registration found = register_base_and_targets(blind(exact), measured);
    ASSERT_TRUE(found.is_determined()) << found.undetermined;
    EXPECT_LT((found.parameters.sensor - simulated.truth.sensor).head<3>().norm(), 1e-3);
}

/// Of markers in no plane, few in a view, a projection leaves too much open.
TEST(Camera, IsRegisteredFromAFewMarkersInNoPlane) {
    Campaign exact = before_camera(tracked_campaign(fanuc()), camera_before_cube());
    exact = with_robot(exact, without_parameters(exact.robot));
    exact.model_error = exact.model_error_orientation = 0;
    Simulation simulated =
        simulate(exact, {.pose_count = 30, .repeats = 1, .truth_seed = 4, .seed = 3});
    Measurements& measured = simulated.measurements;
    for (Index i = 0; i < measured.is_seen.rows(); ++i) {
        measured.is_seen(i, i % 8) = measured.is_seen(i, (3 * i + 1) % 8) = false;
    }
    const Registration found = register_base_and_targets(blind(exact), measured);
    ASSERT_TRUE(found.is_determined()) << found.undetermined;
    // Markers that are wrong by a millimetre turn their own frame.
    const Index place = 3 * 8;
    const VectorXd error = found.parameters.sensor - simulated.truth.sensor;
    EXPECT_LT(error.segment<3>(place).norm(), 3e-3);
    EXPECT_LT(error.tail<3>().norm(), 0.03);
}

/// Errors of the markers' places and of the robot by one calibration, with what is known of their
/// sizes before: the squares of their errors in standard deviations.
TEST(Camera, FindsWhereMarkersAreAsItsCovarianceSays) {
    Campaign campaign = before_camera(tracked_campaign(fanuc()), camera_before_cube());
    campaign.spread.is_prior = true;
    campaign.spread.is_open = false;
    campaign.model_error = campaign.model_error_orientation = 0;
    double squares = 0;
    double count = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        const Simulation simulated =
            simulate(campaign, {.pose_count = 20, .repeats = 1, .truth_seed = seed, .seed = seed});
        const Estimate estimate = identify(campaign, simulated.measurements, simulated.truth);
        const VectorXd errors = in_deviations(campaign, simulated.truth, estimate);
        squares += errors.squaredNorm();
        count += static_cast<double>(errors.size());
        const Index markers = base_parameter_count(campaign) + campaign.robot.parameter_count();
        EXPECT_LT(standard_deviations(estimate).segment(markers, 24).mean(), 0.8e-3);
    }
    EXPECT_NEAR(squares / count, 1, 0.25);
}

/// A calibration by a view's sixteen equations is that by all of its readings.
TEST(Camera, NeedsFewEquationsAView) {
    CameraSetup setup = unknown_lens(on_flange_with_lens());
    setup.corners = chessboard(8, 5, 0.04);
    setup.view.least_corners = 6;
    Campaign campaign = before_camera(tracked_campaign(fanuc()), setup);
    campaign.spread = population_spread(campaign.robot);
    Simulation simulated =
        simulate(campaign, {.pose_count = 12, .repeats = 1, .truth_seed = 4, .seed = 3});
    Measurements& measured = simulated.measurements;
    for (Index k = 0; k < 40; ++k) measured.is_seen(3, k) = k < 4;  // fewer than unknowns
    for (const LossKind kind : {LossKind::Squares, LossKind::Cauchy}) {
        detail::IdentificationProblem problem = detail::make_problem(campaign, measured);
        problem.loss = detail::complete_loss({.kind = kind}, campaign);
        Parameters at = simulated.truth;
        at.robot.array() += 1e-4;
        const auto all = detail::linearise(problem, at, detail::Equations::All);
        const auto few = detail::linearise(problem, at);
        EXPECT_LT(few.augmented.rows(), all.augmented.rows() / 3);
        const MatrixXd expected = all.augmented.transpose() * all.augmented;
        const MatrixXd found = few.augmented.transpose() * few.augmented;
        const VectorXd scale = expected.diagonal().cwiseSqrt().cwiseInverse();
        const MatrixXd difference = scale.asDiagonal() * (found - expected) * scale.asDiagonal();
        EXPECT_LT(difference.cwiseAbs().maxCoeff(), 1e-11);
        ASSERT_EQ(few.first_row.size(), 13U);
        EXPECT_EQ(few.first_row[4] - few.first_row[3], 8);
    }
}

/// What base and tool take up is not the robot's own: of errors of its joints that of the first.
TEST(Camera, SaysWhatTheRobotAloneIsOffBy) {
    const Chain robot = detail::complete_model(without_parameters(fanuc()));
    const Campaign campaign = before_camera(tracked_campaign(robot), fixed_camera());
    const RowMatrixXd configurations = detail::random_configurations(campaign.robot, 50, 3);
    const std::vector<std::string> names = campaign.robot.parameter_names();
    Estimate estimate;
    estimate.parameters = campaign.nominal;
    estimate.variance_factor = 1;
    estimate.covariance.setZero(parameter_count(campaign), parameter_count(campaign));
    const auto with_error = [&](const std::string& name) {
        const auto k = std::ranges::find(names, name) - names.begin();
        EXPECT_LT(k, std::ssize(names)) << name;
        estimate.parameters.robot.setZero(std::ssize(names));
        estimate.parameters.robot[k] = 1e-3;
        return expected_robot_error(campaign, estimate, configurations);
    };
    EXPECT_LT(with_error("dq1").nominal, 1e-9);
    const RobotError other = with_error("dq3");
    EXPECT_GT(other.nominal, 1e-4);
    EXPECT_EQ(other.calibrated, 0);
    estimate.model_error = 2e-4;
    EXPECT_NEAR(with_error("dq1").calibrated, std::sqrt(3) * 2e-4, 1e-9);
}

TEST(Camera, SaysThatViewsShowTooLittle) {
    Campaign exact = hand_eye(fixed_camera());
    Simulation simulated =
        simulate(exact, {.pose_count = 12, .repeats = 1, .truth_seed = 4, .seed = 3});
    Measurements& measured = simulated.measurements;
    measured.is_seen.setConstant(false);
    for (Index i = 0; i < 12; ++i) {
        for (Index k = 0; k < 3; ++k) measured.is_seen(i, (5 * k + i) % 24) = true;
    }
    const std::string why = register_base_and_targets(blind(exact), measured).undetermined;
    EXPECT_NE(why.find("0 of 12 views show enough of the board"), std::string::npos) << why;
}

TEST(Camera, SaysThatCornersFitNoViewOfTheBoard) {
    for (const CameraSetup& setup : {fixed_camera(), unknown_lens(fixed_camera())}) {
        const Campaign exact = hand_eye(setup);
        Simulation simulated =
            simulate(exact, {.pose_count = 12, .repeats = 1, .truth_seed = 4, .seed = 3});
        Measurements& measured = simulated.measurements;
        RandomStream stream(6);
        for (double& place : measured.observations.reshaped()) place = stream.uniform(0, 0.9);
        std::string why;
        try {
            why = register_base_and_targets(blind(exact), measured).undetermined;
        } catch (const InputError& error) {
            why = error.what();
        }
        EXPECT_NE(why.find("12 of 12 views fit no view of such a board"), std::string::npos) << why;
    }
}

/// A third of the views is of a board that is numbered from the other end, as finders of
/// chessboards do.
TEST(Camera, IsRegisteredByTheViewsThatBelongTogether) {
    for (const CameraSetup& setup : {fixed_camera(), unknown_lens(fixed_camera())}) {
        Campaign exact = hand_eye(setup);
        exact.model_error = exact.model_error_orientation = 0;
        Simulation simulated =
            simulate(exact, {.pose_count = 30, .repeats = 1, .truth_seed = 4, .seed = 3});
        Measurements& measured = simulated.measurements;
        for (Index i = 0; i < 30; i += 3) {
            const RowMatrixXd right = measured.observations.row(i);
            const Seen seen = measured.is_seen.row(i);
            for (Index k = 0; k < 24; ++k) {
                measured.observations.row(i).segment<2>(2 * k) =
                    right.row(0).segment<2>(2 * (23 - k));
                measured.is_seen(i, k) = seen(0, 23 - k);
            }
        }
        const Registration found = register_base_and_targets(blind(exact), measured);
        ASSERT_TRUE(found.is_determined()) << found.undetermined;
        EXPECT_LT((found.parameters.sensor - simulated.truth.sensor).head<3>().norm(), 2e-3);
    }
}

TEST(Camera, MustShareViewsWithTheOthers) {
    Campaign exact = hand_eye(three_cameras());
    Simulation simulated =
        simulate(exact, {.pose_count = 20, .repeats = 1, .truth_seed = 4, .seed = 3});
    Measurements& measured = simulated.measurements;
    const Index corners = measured.is_seen.cols() / 3;
    for (Index i = 0; i < measured.is_seen.rows(); ++i) {
        const bool is_by_second = i % 2 == 0;
        measured.is_seen.row(i).head(corners).setConstant(!is_by_second);
        measured.is_seen.row(i).tail(2 * corners).setConstant(is_by_second);
    }
    try {
        register_base_and_targets(blind(exact), measured);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("camera 2 and to the first one"),
                  std::string::npos)
            << error.what();
    }
}

TEST(Camera, IsNotDeterminedByTurnsAboutOneAxis) {
    Campaign exact = hand_eye(fixed_camera());
    const Simulation simulated =
        simulate(exact, {.pose_count = 1, .repeats = 1, .truth_seed = 4, .seed = 3});
    RowMatrixXd turned = simulated.measurements.configurations.row(0).replicate(8, 1);
    for (Index i = 0; i < 8; ++i) turned(i, 5) += 0.02 * static_cast<double>(i);
    const Measurements measured = simulate_measurements(exact, simulated.truth, turned, 1, 5);
    EXPECT_FALSE(register_base_and_targets(blind(exact), measured).is_determined());
}

/// What its covariance says: of 40 small campaigns, the squares of the errors in standard
/// deviations.
/// Between a lens that is known and one that is not.
TEST(Camera, FindsALensThatIsKnownWithDeviationsAsItsCovarianceSays) {
    CameraSetup setup = unknown_lens(fixed_camera());
    const auto deviations = [](const CameraSetup& camera) {
        Campaign campaign = hand_eye(camera);
        campaign.model_error = campaign.model_error_orientation = 0;
        double squares = 0;
        double count = 0;
        VectorXd sigmas;
        for (std::uint64_t seed = 1; seed <= 10; ++seed) {
            const Simulation simulated = simulate(
                campaign, {.pose_count = 8, .repeats = 1, .truth_seed = seed, .seed = seed});
            const Registration start = register_base_and_targets(campaign, simulated.measurements);
            const Estimate estimate = identify(campaign, simulated.measurements, start.parameters);
            const VectorXd errors = in_deviations(campaign, simulated.truth, estimate);
            squares += errors.squaredNorm();
            count += static_cast<double>(errors.size());
            sigmas = standard_deviations(estimate);
        }
        EXPECT_NEAR(squares / count, 1, 0.35);
        return sigmas;
    };
    const VectorXd unknown = deviations(setup);  // base, place, then the lens
    setup.is_known.assign(9, true);
    const VectorXd known = deviations(setup);
    setup.deviations = {1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-3, 1e-5, 1e-5, 1e-3};
    const VectorXd doubtful = deviations(setup);  // base, the lens, then the place
    EXPECT_EQ(doubtful.size(), unknown.size());
    EXPECT_GT(doubtful[2], 1.05 * known[2]);
    EXPECT_LT(doubtful[2], 0.95 * unknown[2]);
    EXPECT_LT(doubtful[6], 1e-3);
    EXPECT_LT(doubtful[6], unknown[12]);
}

TEST(Camera, FindsHandEyeAndIntrinsicsAsItsCovarianceSays) {
    Campaign campaign = hand_eye(unknown_lens(fixed_camera()));
    campaign.model_error = campaign.model_error_orientation = 0;
    double squares = 0;
    double count = 0;
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const Simulation simulated =
            simulate(campaign, {.pose_count = 12, .repeats = 1, .truth_seed = seed, .seed = seed});
        const Estimate estimate = identify(campaign, simulated.measurements, simulated.truth);
        const VectorXd errors = in_deviations(campaign, simulated.truth, estimate);
        squares += errors.squaredNorm();
        count += static_cast<double>(errors.size());
    }
    EXPECT_NEAR(squares / count, 1, 0.35);
}

}  // namespace
}  // namespace posewise
