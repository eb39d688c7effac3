#include "support/sensors.hpp"

#include <gtest/gtest.h>

#include <map>
#include <stdexcept>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

/// The campaign with what it can identify of the FANUC's geometry.
Campaign irreducible(const Campaign& campaign) {
    return with_robot(campaign, irreducible_model(campaign));
}

TEST(EverySensor, CalibratesTheRobotToWhatItsNoiseAllows) {
    for (const auto& [name, declared] : campaigns_of_every_sensor(fanuc())) {
        SCOPED_TRACE(name);
        Campaign campaign = irreducible(declared);
        campaign.model_error = campaign.model_error_orientation = 0;
        const Index repeats = campaign.sensor->has_contacts() ? 1 : 2;
        const Simulation simulated =
            simulate(campaign, {.pose_count = 120, .repeats = repeats, .truth_seed = 6, .seed = 5});
        const Measurements& measured = simulated.measurements;
        const Estimate estimate =
            identify(campaign, measured, register_base_and_targets(campaign, measured).parameters);
        EXPECT_EQ(estimate.ending, Ending::Converged);
        // Its mean is 1; four standard deviations of chi-square over its degrees of freedom.
        EXPECT_NEAR(estimate.variance_factor, 1,
                    4 * std::sqrt(2.0 / static_cast<double>(estimate.degrees_of_freedom)));
        const VectorXd robot_sigma = standard_deviations(estimate).segment(
            base_parameter_count(campaign), campaign.robot.parameter_count());
        const VectorXd error = estimate.parameters.robot - simulated.truth.robot;
        EXPECT_LT(error.cwiseQuotient(robot_sigma).cwiseAbs().maxCoeff(), 5);
    }
}

/// A campaign of every sensor by its name, with what it can identify and no model error.
Campaign exact_campaign(const std::string& called) {
    for (const auto& [name, declared] : campaigns_of_every_sensor(fanuc())) {
        if (name != called) continue;
        Campaign campaign = irreducible(declared);
        campaign.model_error = 0;
        return campaign;
    }
    throw std::logic_error(called);
}

TEST(PlaneSensor, IsCalibratedWithWhatIsKnownOfEachPlaneAsItsCovarianceSays) {
    const Campaign campaign = exact_campaign("planes known in part");
    constexpr std::uint64_t sets = 30;
    double squares = 0;
    for (std::uint64_t i = 0; i < sets; ++i) {
        const Simulation simulated =
            simulate(campaign, {.pose_count = 60, .truth_seed = 6 + i, .seed = 100 + i});
        const Estimate estimate =
            identify(campaign, simulated.measurements,
                     register_base_and_targets(campaign, simulated.measurements).parameters);
        EXPECT_EQ(estimate.ending, Ending::Converged);
        VectorXd error(estimate.covariance.rows());
        error << estimate.parameters.robot - simulated.truth.robot,
            estimate.parameters.sensor - simulated.truth.sensor;
        squares += error.dot(estimate.covariance.llt().solve(error)) / estimate.variance_factor;
    }
    const auto count = static_cast<double>(sets * parameter_count(campaign));
    // Chi-square over all parameters of all sets, four of its standard deviations.
    EXPECT_NEAR(squares / count, 1, 4 * std::sqrt(2 / count));
}

TEST(PlaneSensor, TellsMoreWhereMoreIsKnownOfItsPlanes) {
    const Campaign open = exact_campaign("unknown planes");
    const Campaign partly = with_robot(exact_campaign("planes known in part"), open.robot);
    const Measurements measured = simulate(partly, {.pose_count = 60}).measurements;
    const auto deviations = [&](const Campaign& campaign) {
        const Estimate estimate =
            identify(campaign, measured, register_base_and_targets(campaign, measured).parameters);
        EXPECT_EQ(estimate.ending, Ending::Converged);
        const VectorXd sigmas = standard_deviations(estimate) / std::sqrt(estimate.variance_factor);
        std::map<std::string, double> by_name;
        const std::vector<std::string> names = parameter_names(campaign);
        for (std::size_t k = 0; k < names.size(); ++k) {
            by_name[names[k]] = sigmas[static_cast<Index>(k)];
        }
        return by_name;
    };
    const auto with_all = deviations(open);
    const auto with_some = deviations(partly);
    EXPECT_EQ(with_all.size(), with_some.size() + 3);
    for (const auto& [name, sigma] : with_some) EXPECT_LT(sigma, 1.01 * with_all.at(name)) << name;
    EXPECT_LT(with_some.at("plane2.tilt1"), 0.9 * with_all.at("plane2.tilt1"));
    EXPECT_LT(with_some.at("plane1.offset"), 0.9 * with_all.at("plane1.offset"));
}

/// Stated at half, at a tenth: the other kind's variance stays 1, and what is expected at new poses
/// is what is found there.
TEST(PoseSensor, HasAVarianceOfLengthsAndOneOfAngles) {
    Campaign truth = exact_campaign("pose of an unknown tool");
    truth.model_error = 2e-4;
    truth.model_error_orientation = 3e-4;
    const Simulation simulated = simulate(truth, {.pose_count = 300});
    const Parameters start = register_base_and_targets(truth, simulated.measurements).parameters;
    const auto judge = [&](double lengths, double angles) {
        Campaign stated = truth;
        stated.model_error *= lengths;
        stated.model_error_orientation *= angles;
        const Estimate estimate = identify(stated, simulated.measurements, start);
        ASSERT_EQ(estimate.variance_by_kind.size(), 2U);
        for (const bool is_angle : {false, true}) {
            const double stated_at = is_angle ? angles : lengths;
            const double factor = estimate.variance_of(is_angle).factor;
            if (stated_at == 1) {
                EXPECT_NEAR(factor, 1, 0.1);
            } else {
                EXPECT_GT(factor, 2);
            }
        }
        EXPECT_NEAR(estimate.variance_of(false).degrees_of_freedom +
                        estimate.variance_of(true).degrees_of_freedom,
                    static_cast<double>(estimate.degrees_of_freedom), 1e-6);
        const auto fresh = simulate_measurements(
            truth, simulated.truth, detail::random_configurations(truth.robot, 300, 9), 1, 77);
        const Metrics found = make_metrics(residuals(stated, estimate.parameters, fresh), 3);
        EXPECT_NEAR(expected_error(stated, estimate, fresh).total() / found.distance_rms, 1, 0.07);
        EXPECT_NEAR(expected_error(stated, estimate, fresh, true).total() / found.orientation_rms,
                    1, 0.07);
    };
    judge(1, 0.5);
    judge(1, 0.1);
    judge(0.3, 1);
}

TEST(PoseSensor, IdentifiesFourARevoluteJointAndSix) {
    for (const auto& [name, declared] : campaigns_of_every_sensor(fanuc())) {
        if (name != "pose of an unknown tool") continue;
        EXPECT_EQ(parameter_count(irreducible(declared)), 4 * 6 + 6);
    }
}

TEST(PoseSensor, IsRegisteredFromNothing) {
    for (const auto& [name, declared] : campaigns_of_every_sensor(fanuc())) {
        if (name.find("pose of") != 0) continue;
        SCOPED_TRACE(name);
        for (Index i = 0; i < sweep_count() / 20; ++i) {
            RandomStream stream(45, static_cast<std::uint64_t>(i));
            Campaign campaign = declared;
            campaign.nominal.world_from_base = random_pose(stream);
            if (campaign.nominal.sensor.size() > 0) {
                campaign.nominal.sensor = tool_unknowns(random_pose(stream));
            }
            Campaign blind = campaign;
            blind.nominal.world_from_base.setIdentity();
            blind.nominal.sensor.setZero();
            const RowMatrixXd poses =
                random_configurations(campaign.robot, 12, static_cast<std::uint64_t>(i));
            const auto measured = simulate_measurements(campaign, campaign.nominal, poses, 1, 7);
            const Parameters found = register_base_and_targets(blind, measured).parameters;
            EXPECT_LT(make_metrics(residuals(campaign, found, measured)).distance_max, 2e-3);
            EXPECT_LT(make_metrics(residuals(campaign, found, measured)).orientation_max, 2e-3);
        }
    }
}

TEST(KnownTargetCoordinate, LetsAScaraBeCalibrated) {
    Campaign campaign = tracked_campaign(scara());
    const std::vector<Vector3d> target{{0.1, 0.02, -0.05}};
    campaign = with_sensor(campaign,
                           std::make_shared<PointSensor>(Targets(target, {{false, false, true}}),
                                                         IsotropicNoise{5e-5}),
                           Eigen::Vector2d(0.1, 0.02));
    campaign = with_robot(campaign, irreducible_model(with_robot(campaign, scara())));
    const Simulation simulated = simulate(campaign, {.pose_count = 60, .truth_seed = 4, .seed = 3});
    const Parameters start = register_base_and_targets(campaign, simulated.measurements).parameters;
    const Estimate estimate = identify(campaign, simulated.measurements, start);
    EXPECT_EQ(estimate.ending, Ending::Converged);
    EXPECT_LT(estimate.fit.distance_rms, 3e-4);
    EXPECT_NEAR(estimate.variance_factor, 1, 0.4);
}

TEST(KnownBase, IsAskedForWhereAllAxesAreParallel) {
    Campaign campaign = tracked_campaign(scara());
    const auto measured = simulate(campaign, {.pose_count = 20}).measurements;
    const std::string message = register_roughly(campaign, measured).undetermined;
    EXPECT_NE(message.find("no number of them tells target3.z; what is known must be stated, like "
                           "known: [z], keys base.known or sensor.targets.known"),
              std::string::npos)
        << message;
    campaign.base_is_known[2] = true;
    EXPECT_TRUE(register_base_and_targets(campaign, measured).is_determined());
}

TEST(KnownBase, LeavesTheRobotAloneToBeIdentifiedWhereTheSensorIsKnown) {
    for (const auto& [name, declared] : campaigns_of_every_sensor(fanuc())) {
        if (declared.nominal.sensor.size() > 0) continue;
        SCOPED_TRACE(name);
        Campaign known = declared;
        known.base_is_known.fill(true);
        const Campaign campaign = irreducible(known);
        const Simulation simulated = simulate(campaign, {.pose_count = 40});
        const Parameters start =
            register_base_and_targets(campaign, simulated.measurements).parameters;
        EXPECT_TRUE(start.world_from_base.isApprox(campaign.nominal.world_from_base, 0));
        const Estimate estimate = identify(campaign, simulated.measurements, start);
        EXPECT_EQ(estimate.ending, Ending::Converged);
        EXPECT_EQ(estimate.covariance.rows(), campaign.robot.parameter_count());
        const VectorXd error = estimate.parameters.robot - simulated.truth.robot;
        EXPECT_LT(error.cwiseQuotient(standard_deviations(estimate)).cwiseAbs().maxCoeff(), 5);
    }
}

TEST(KnownBase, IsLeftAsItIs) {
    for (const auto& [name, declared] : campaigns_of_every_sensor(fanuc())) {
        if (name != "points, base partly known") continue;
        const Campaign campaign = irreducible(declared);
        const Simulation simulated = simulate(campaign, {.pose_count = 40});
        const Parameters start =
            register_base_and_targets(campaign, simulated.measurements).parameters;
        const Estimate estimate = identify(campaign, simulated.measurements, start);
        EXPECT_EQ(estimate.parameters.world_from_base.translation().z(),
                  campaign.nominal.world_from_base.translation().z());
        EXPECT_NE(estimate.parameters.world_from_base.translation().x(),
                  campaign.nominal.world_from_base.translation().x());
    }
}

}  // namespace
}  // namespace posewise
