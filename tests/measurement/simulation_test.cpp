#include <gtest/gtest.h>

#include <functional>

#include "../../src/measurement/noise.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "support/campaigns.hpp"
#include "support/cells.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

/// Bounds that a chi-square sum over n degrees of freedom, divided by n, leaves once in 15000.
void expect_variance(double mean_square, Index degrees_of_freedom, double variance) {
    const double four_sigmas = 4 * std::sqrt(2.0 / static_cast<double>(degrees_of_freedom));
    EXPECT_NEAR(mean_square / variance, 1, four_sigmas);
}

/// Observed minus expected, of every configuration's mean.
RowMatrixXd mean_errors(const Campaign& campaign, const Simulation& simulation) {
    RowMatrixXd errors = mean_measurements(*campaign.sensor, simulation.measurements).observations;
    for (Index i = 0; i < errors.rows(); ++i) {
        const VectorXd q = simulation.measurements.configurations.row(i).transpose();
        errors.row(i) -=
            campaign.sensor
                ->predict(world_from_flange(campaign, simulation.truth, q), simulation.truth.sensor)
                .transpose();
    }
    return errors;
}

TEST(Simulate, ALongerCampaignBeginsWithTheShorterOne) {
    const Campaign campaign = tracked_campaign(fanuc());
    const Simulation longer = simulate(campaign, {.pose_count = 12, .repeats = 2});
    const Simulation shorter = simulate(campaign, {.pose_count = 5, .repeats = 2});
    const Measurements prefix = take(longer.measurements, {0, 1, 2, 3, 4});
    EXPECT_EQ(shorter.measurements.configurations, prefix.configurations);
    EXPECT_EQ(shorter.measurements.observations, prefix.observations);
    EXPECT_EQ(shorter.measurements.ids, prefix.ids);
    EXPECT_EQ(shorter.truth.robot, longer.truth.robot);
}

TEST(Simulate, SendsTheRobotOnlyWhereItsCellAllows) {
    Campaign campaign = testing::cell_campaign();
    campaign.cell = testing::demo_cell();
    const Measurements measured = simulate(campaign, {.pose_count = 40}).measurements;
    const Constraints constraints(campaign, campaign.cell);
    ASSERT_EQ(measured.configuration_count(), 40);
    for (Index i = 0; i < 40; ++i) {
        const ConstraintReport report =
            constraints.check(measured.configurations.row(i).transpose());
        EXPECT_TRUE(report.is_feasible());
        EXPECT_TRUE((measured.is_seen.row(i) == report.is_seen).all());
    }
    const Measurements shorter = simulate(campaign, {.pose_count = 7}).measurements;
    EXPECT_EQ(shorter.configurations, measured.configurations.topRows(7));
}

TEST(Simulate, SaysWhatCollidesWhereTheCellLeavesNoRoom) {
    Campaign campaign = testing::cell_campaign();
    campaign.cell.keep_outs = {{"everything", HalfSpace{{0, 0, 9}, {0, 0, 1}}}};
    const std::string error = input_error_of([&] { simulate(campaign, {.pose_count = 3}); });
    EXPECT_NE(error.find("none of"), std::string::npos) << error;
    EXPECT_NE(error.find("and everything are nearer than safety_distance"), std::string::npos)
        << error;
}

TEST(Simulate, RefusesPlacesThatNoCellHas) {
    const auto expect_refused = [](const std::function<void(Campaign&)>& spoil,
                                   const std::string& words) {
        Campaign campaign = tracked_campaign(fanuc());
        spoil(campaign);
        const std::string error = input_error_of([&] { simulate(campaign, {.pose_count = 3}); });
        EXPECT_NE(error.find(words), std::string::npos) << error;
    };
    expect_refused([](Campaign& of) { of.nominal.sensor.head<3>() << 60, 40, 90; },
                   "target 1, seen from the flange, is stated 115.3 m away, must be within 10 m; "
                   "are its numbers in mm? Then the key is position_mm");
    expect_refused([](Campaign& of) { of.nominal.sensor.head<3>() << 6e-5, 4e-5, 9e-5; },
                   "stated 0.1153 mm away, which is no place for it; are its numbers in m?");
    const auto put_base = [](double x) {
        return [x](Campaign& of) {
            of.cell.sight = Sight{};
            of.nominal.world_from_base.translation() = Vector3d(x, 0, 0);
        };
    };
    expect_refused(put_base(2500), "the base, seen from the tracker, is stated 2500 m away");
    expect_refused(put_base(2.5e-3), "is stated 2.5 mm away, which is no place for it");
}

TEST(Simulate, NamesTheSensorThatIsTooFarAway) {
    const Campaign alone = tracked_campaign(fanuc());
    const auto error_with = [&](const Vector3d& second, const Vector3d& target) {
        Campaign campaign = alone;
        Isometry3d frame = Isometry3d::Identity();
        frame.translation() = second;
        const auto combined = std::make_shared<CombinedSensor>(
            std::vector<SensorPart>{{alone.sensor}, {alone.sensor, std::nullopt}});
        campaign.sensor = combined;
        VectorXd own = alone.nominal.sensor;
        own.head<3>() = target;
        campaign.nominal.sensor =
            combined->unknowns({alone.nominal.sensor, own}, {Isometry3d::Identity(), frame});
        return input_error_of([&] { simulate(campaign, {.pose_count = 3}); });
    };
    const Vector3d near(0.1, 0.2, 0.3);
    EXPECT_EQ(error_with({3, 0, 0}, near), "no error");
    const std::string far = error_with({4000, 0, 0}, near);
    EXPECT_NE(far.find("the frame of sensor 2 (sensors[2].frame), seen from the base, is stated "),
              std::string::npos)
        << far;
    EXPECT_NE(far.find("must be within 1000 m"), std::string::npos) << far;
    EXPECT_NE(error_with({3, 0, 0}, {60, 0, 0}).find("target 1 of sensor 2, seen from the flange"),
              std::string::npos);
}

TEST(Simulate, SensorNoiseHasTheStatedVariance) {
    const Campaign campaign = tracked_campaign(fanuc());
    const Simulation simulation = simulate(campaign, {.pose_count = 300, .repeats = 5});
    const double sigma = repeatability(*campaign.sensor, simulation.measurements)->length;
    expect_variance(sigma * sigma, 300 * 4 * 9, 5e-5 * 5e-5);
}

TEST(Simulate, RepeatsShareTheModelError) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.model_error = 2e-4;
    const Simulation simulation = simulate(campaign, {.pose_count = 300, .repeats = 4});
    const RowMatrixXd errors = mean_errors(campaign, simulation);
    const Index n = errors.size();
    expect_variance(errors.squaredNorm() / static_cast<double>(n), n,
                    2e-4 * 2e-4 + 5e-5 * 5e-5 / 4);
}

TEST(Simulate, ObservationsHaveTheStatedCovarianceOfTheirMean) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{2e-5, 2e-5});
    campaign.joint_repeatability = VectorXd::Constant(6, 3e-5);
    const Simulation simulation = simulate(campaign, {.pose_count = 400, .repeats = 3});
    RowMatrixXd errors = mean_errors(campaign, simulation);
    double chi_square = 0;
    for (Index i = 0; i < errors.rows(); ++i) {
        FlangeMotion motion;
        campaign.robot.differentiate(simulation.truth.world_from_base,
                                     simulation.measurements.configurations.row(i).transpose(),
                                     simulation.truth.robot, motion);
        RowMatrixXd error = errors.row(i).transpose();
        whiten(mean_covariance(campaign, motion, simulation.truth.sensor, 3), error);
        chi_square += error.squaredNorm();
    }
    expect_variance(chi_square / 3600, 3600, 1);
}

TEST(Simulate, MeansOfTheSamplesThatShowATargetHaveTheStatedCovariance) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{2e-4, 1e-4});
    campaign.joint_repeatability = VectorXd::Constant(6, 3e-5);
    Simulation simulation = simulate(campaign, {.pose_count = 400, .repeats = 3});
    hide_at_random(simulation.measurements, 0.4, 5);
    const RowMatrixXd errors = mean_errors(campaign, simulation);
    const RowMatrixXd times = times_seen(simulation.measurements);
    double chi_square = 0;
    for (Index i = 0; i < errors.rows(); ++i) {
        FlangeMotion motion;
        campaign.robot.differentiate(simulation.truth.world_from_base,
                                     simulation.measurements.configurations.row(i).transpose(),
                                     simulation.truth.robot, motion);
        const VectorXd repeats = times.row(i).transpose();
        const VectorXd all = errors.row(i).transpose();
        RowMatrixXd error = all(seen_rows(repeats.array() > 0, campaign.sensor->rows_per_target()));
        whiten(mean_covariance(campaign, motion, simulation.truth.sensor, repeats), error);
        chi_square += error.squaredNorm();
    }
    const Index numbers = 3 * (times.array() > 0).count();
    EXPECT_LT(numbers, 3600);
    expect_variance(chi_square / static_cast<double>(numbers), numbers, 1);
}

TEST(Simulate, AtGivenConfigurationsShowsWhatIsVisibleThere) {
    const Campaign campaign = tracked_campaign(fanuc());
    const SimulateOptions options{.pose_count = 2, .repeats = 2};
    const Measurements all = simulate(campaign, options).measurements;
    const Seen visible{{true, false, true}, {true, true, true}};
    const Measurements some = simulate(campaign, all.configurations, visible, options).measurements;
    EXPECT_EQ(some.observations, all.observations);
    for (const Index sample : {0, 1}) {
        EXPECT_TRUE((some.is_seen.row(sample) == visible.row(0)).all());
    }
    EXPECT_TRUE(some.is_seen.bottomRows(2).all());
    EXPECT_TRUE(all.is_seen.all());
    EXPECT_THROW(simulate(campaign, all.configurations, visible.topRows(1), options), InputError);
}

TEST(Simulate, TruthDependsOnItsOwnSeedOnly) {
    const Campaign campaign = tracked_campaign(fanuc());
    const Simulation a = simulate(campaign, {.pose_count = 3, .truth_seed = 1, .seed = 1});
    const Simulation b = simulate(campaign, {.pose_count = 3, .truth_seed = 1, .seed = 2});
    const Simulation c = simulate(campaign, {.pose_count = 3, .truth_seed = 2, .seed = 1});
    EXPECT_EQ(a.truth.robot, b.truth.robot);
    EXPECT_NE(a.measurements.configurations, b.measurements.configurations);
    EXPECT_NE(a.truth.robot, c.truth.robot);
    EXPECT_EQ(a.measurements.configurations, c.measurements.configurations);
}

TEST(DrawTruth, SpreadsTheErrorsAsStated) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.spread = {5e-4, 2e-3, {}};
    const VectorXd scale = parameter_scale(campaign).segment(6, 18);
    double sum = 0;
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        sum += draw_truth(campaign, seed).robot.cwiseQuotient(scale).squaredNorm();
    }
    expect_variance(sum / (200 * 18), 200 * 18, 1);
}

TEST(Simulate, RefusesWhatItCannotSimulate) {
    Campaign campaign = tracked_campaign(fanuc());
    EXPECT_THROW(simulate(campaign, {}), InputError);
    EXPECT_THROW(simulate(campaign, {.pose_count = -1}), InputError);
    EXPECT_THROW(simulate(campaign, {.pose_count = 3, .repeats = 0}), InputError);
    campaign.has_nominal_targets = false;
    EXPECT_THROW(simulate(campaign, {.pose_count = 3}), InputError);
}

TEST(Simulate, NamesTheKeysThatAreMissing) {
    Campaign campaign = tracked_campaign(fanuc());
    const auto error = [&] {
        return input_error_of([&] { simulate(campaign, {.pose_count = 3}); });
    };
    campaign.has_nominal_targets = false;
    EXPECT_EQ(error(),
              "to simulate, the campaign must state where the targets are, too (key "
              "'sensor.targets.position_mm')");
    campaign.has_nominal_base = false;
    EXPECT_EQ(error(),
              "to simulate, the campaign must state where base and targets are (keys "
              "'base' and 'sensor.targets.position_mm')");
    campaign.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 5e-5);
    EXPECT_EQ(error(),
              "to simulate, the campaign must state where base and tool are (keys 'base' "
              "and 'sensor.tool')");
}

}  // namespace
}  // namespace posewise
