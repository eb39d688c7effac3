// A kind of instrument that the library has never heard of: all of it is in this file.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "../../src/jacobian/pose_information.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/planning.hpp"
#include "support/derivative_check.hpp"
#include "support/robots.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

constexpr double arc_second = degree / 3600;

/// Azimuth and elevation (rad) of each target, as seen from a levelled instrument whose place in
/// the world (station.x to station.z, m) and heading (about the vertical, rad) are unknown.
class Theodolite final : public Sensor {
  public:
    Theodolite(Targets targets, double sigma) : targets_(std::move(targets)), sigma_(sigma) {}

    const Targets& targets() const override { return targets_; }
    Index row_count() const override { return 2 * targets_.count(); }
    bool is_angle(Index) const override { return true; }

    std::vector<std::string> observation_names() const override {
        std::vector<std::string> names;
        for (Index j = 1; j <= targets_.count(); ++j) {
            names.push_back("p" + std::to_string(j) + "_azimuth");
            names.push_back("p" + std::to_string(j) + "_elevation");
        }
        return names;
    }

    std::vector<std::string> unknown_names() const override {
        std::vector<std::string> names = targets_.unknown_names();
        for (const char* const own : {"x", "y", "z", "heading"}) {
            names.push_back(std::string("station.") + own);
        }
        return names;
    }

    std::vector<bool> unknown_is_angle() const override {
        std::vector<bool> is_angle(unknown_names().size(), false);
        is_angle.back() = true;
        return is_angle;
    }

    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override {
        for (Index j = 0; j < targets_.count(); ++j) {
            const Vector3d d = from_station(world_from_flange, j, unknowns);
            const double azimuth = std::atan2(d.y(), d.x()) - unknowns[unknowns.size() - 1];
            observation[2 * j] = within_half_a_turn(azimuth);
            observation[2 * j + 1] = std::atan2(d.z(), d.head<2>().norm());
        }
    }

    void deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                   Eigen::Ref<VectorXd> deviation) const override {
        deviation = (observation - reference).unaryExpr(&Theodolite::within_half_a_turn);
    }

    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override {
        RowMatrixXd J_positions(3 * targets_.count(), J_measured_parameters.cols());
        targets_.differentiate(world_from_flange, twists, unknowns, J_positions);
        const bool has_unknowns = J_positions.cols() > twists.cols();
        for (Index j = 0; j < targets_.count(); ++j) {
            const Vector3d d = from_station(world_from_flange, j, unknowns);
            const double across = d.head<2>().norm();
            Eigen::Matrix<double, 2, 3> J_angles_position;
            J_angles_position << -d.y() / (across * across), d.x() / (across * across), 0,
                -d.x() * d.z() / (across * d.squaredNorm()),
                -d.y() * d.z() / (across * d.squaredNorm()), across / d.squaredNorm();
            auto rows = J_measured_parameters.middleRows<2>(2 * j);
            rows = J_angles_position * J_positions.middleRows<3>(3 * j);
            if (!has_unknowns) continue;
            rows.rightCols<4>().leftCols<3>() = -J_angles_position;
            rows.rightCols<1>() = Eigen::Vector2d(-1, 0);
        }
    }

    void covariance(const Isometry3d&, const VectorXd&,
                    Eigen::Ref<MatrixXd> covariance) const override {
        covariance = sigma_ * sigma_ * MatrixXd::Identity(row_count(), row_count());
    }

  private:
    static double within_half_a_turn(double angle) {
        return std::remainder(angle, 2 * std::numbers::pi);
    }
    Vector3d from_station(const Isometry3d& world_from_flange, Index target,
                          const VectorXd& unknowns) const {
        return world_from_flange * targets_.position(target, unknowns) -
               unknowns.segment<3>(targets_.unknown_count());
    }

    Targets targets_;
    double sigma_;
};

/// The FANUC in its own frame, which is the world: angles alone tell neither a frame nor a scale.
/// The scale is that of two targets at known places; the third one's is to be found.
Campaign theodolite_campaign() {
    Campaign campaign;
    campaign.name = "theodolite";
    campaign.robot = fanuc();
    const std::vector<Vector3d> places{
        {0.28, 0.05, -0.11}, {0.30, -0.09, 0.06}, {0.26, 0.08, 0.12}};
    campaign.sensor =
        std::make_shared<Theodolite>(Targets({places[0], places[1], std::nullopt}), arc_second);
    campaign.base_is_known.fill(true);
    campaign.model_error = 0;
    campaign.model_error_orientation = 5e-6;
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    campaign.nominal.sensor.resize(7);
    campaign.nominal.sensor << places[2], 4.5, -2.0, 0.8, 2.7;
    campaign.has_nominal_base = true;
    campaign.has_nominal_targets = true;
    return campaign;
}

RowMatrixXd some_configurations(const Campaign& campaign, Index count) {
    return random_configurations(campaign.robot, count, 3);
}

TEST(ATheodolite, HasTheJacobianOfItsPrediction) {
    const Campaign campaign = theodolite_campaign();
    const Index L = parameter_count(campaign);
    ASSERT_EQ(L, campaign.robot.parameter_count() + 7);
    const RowMatrixXd poses = some_configurations(campaign, 20);
    for (Index i = 0; i < poses.rows(); ++i) {
        const VectorXd q = poses.row(i).transpose();
        const Parameters at = draw_truth(campaign, static_cast<std::uint64_t>(i));
        FlangeMotion motion;
        RowMatrixXd J = RowMatrixXd::Constant(6, L, 99.0);
        differentiate_pose(campaign, at, q, motion, J);
        const VectorXd reference = campaign.sensor->predict(motion.world_from_flange, at.sensor);
        const auto deviation = [&](const VectorXd& step) {
            const Parameters moved = advance(campaign, at, step);
            return campaign.sensor->deviation(
                campaign.sensor->predict(world_from_flange(campaign, moved, q), moved.sensor),
                reference);
        };
        expect_is_jacobian(J, deviation, VectorXd::Zero(L));
    }
}

/// It does not say how its derivative changes with the pose; the library finds out.
TEST(ATheodolite, TellsHowItsInformationChangesWithTheJoints) {
    Campaign campaign = theodolite_campaign();
    campaign.joint_repeatability = VectorXd::Constant(6, 1e-5);
    const PoseInformation pose(campaign, campaign.nominal);
    const VectorXd q = VectorXd::LinSpaced(6, -0.4, 0.9);
    const Index L = pose.parameter_count();
    const auto diagonal_sum = [&](const VectorXd& joints) {
        return VectorXd::Constant(1, pose.evaluate(joints).trace());
    };
    const VectorXd expected = numerical_jacobian(diagonal_sum, q).transpose();
    EXPECT_LE((pose.differentiate(q, MatrixXd::Identity(L, L)) - expected).norm(),
              1e-8 * expected.norm());
}

TEST(ATheodolite, CalibratesTheRobotToWhatItsNoiseAllows) {
    const Campaign campaign = theodolite_campaign();
    const Simulation simulated =
        simulate(campaign, {.pose_count = 80, .repeats = 2, .truth_seed = 6, .seed = 5});
    const Measurements& measured = simulated.measurements;
    const Calibration calibration = calibrate(campaign, measured, {.folds = 0});
    const Estimate& estimate = calibration.estimate;
    EXPECT_EQ(estimate.ending, Ending::Converged);
    EXPECT_NEAR(estimate.variance_factor, 1,
                4 * std::sqrt(2.0 / static_cast<double>(estimate.degrees_of_freedom)));
    VectorXd error(parameter_count(campaign));
    error << estimate.parameters.robot - simulated.truth.robot,
        estimate.parameters.sensor - simulated.truth.sensor;
    // Chi-square with as many degrees of freedom as parameters.
    const auto L = static_cast<double>(error.size());
    EXPECT_LT(error.dot(estimate.covariance.llt().solve(error)), L + 4 * std::sqrt(2 * L));
    EXPECT_LT(standard_deviations(estimate).head(campaign.robot.parameter_count()).maxCoeff(),
              3e-4);  // m and rad: far below the errors of 1 mm and 1 mrad that were drawn

    // Angles only: there are no distances to report.
    EXPECT_EQ(estimate.fit.coordinate_count, 0);
    EXPECT_LT(estimate.fit.orientation_rms, 3 * arc_second);
    EXPECT_GT(estimate.fit.orientation_rms, arc_second);
    const CrossValidation held_out = cross_validate(campaign, measured, estimate.parameters, 5);
    EXPECT_TRUE(held_out.failures.empty());
    EXPECT_GT(held_out.squared_distances.minCoeff(), 0);
}

TEST(ATheodolite, IsRegisteredFromNominalValuesOnly) {
    Campaign campaign = theodolite_campaign();
    const Measurements measured = simulate(campaign, {.pose_count = 20}).measurements;
    campaign.has_nominal_targets = false;
    const std::string message = input_error_of([&] { register_roughly(campaign, measured); });
    EXPECT_NE(message.find("by readings alone"), std::string::npos) << message;
}

TEST(ATheodolite, NamesATargetThatIsNeverSeen) {
    const Campaign campaign = theodolite_campaign();
    Measurements measured = simulate(campaign, {.pose_count = 20}).measurements;
    measured.is_seen.col(2).setConstant(false);
    const std::string message = register_roughly(campaign, measured).undetermined;
    EXPECT_NE(message.find("target 3 is seen in no sample"), std::string::npos) << message;
}

TEST(ATheodolite, HasFilesOfMeasurements) {
    const Campaign campaign = theodolite_campaign();
    Measurements measured = simulate(campaign, {.pose_count = 5, .repeats = 2}).measurements;
    measured.is_seen(3, 1) = false;
    const TemporaryFolder folder;
    io::write_measurements_csv(folder.path("a.csv"), campaign, measured);
    const Measurements again = io::read_measurements_csv(folder.path("a.csv"), campaign);
    EXPECT_EQ(again.configurations, measured.configurations);
    EXPECT_TRUE((again.is_seen == measured.is_seen).all());
    EXPECT_EQ(again.observations.topRows(3), measured.observations.topRows(3));
    const std::string header = input_error_of(
        [&] { io::read_measurements_csv(folder.write("b.csv", "config,q1_rad\n"), campaign); });
    EXPECT_NE(header.find("p1_azimuth_rad"), std::string::npos) << header;
}

TEST(ATheodolite, HasFilesOfEstimates) {
    const Campaign campaign = theodolite_campaign();
    const Measurements measured = simulate(campaign, {.pose_count = 40}).measurements;
    const Calibration calibration = calibrate(campaign, measured, {.folds = 0});
    const TemporaryFolder folder;
    io::write_estimate(folder.path("estimate.json"), calibration, {"measured.csv"});
    const Parameters again = io::read_estimate(folder.path("estimate.json"), campaign).parameters;
    EXPECT_EQ(again.robot, calibration.estimate.parameters.robot);
    EXPECT_EQ(again.sensor, calibration.estimate.parameters.sensor);
}

TEST(ATheodolite, DescribesItself) {
    const Campaign campaign = theodolite_campaign();
    EXPECT_EQ(campaign.sensor->words().sentence,
              "6 numbers a pose at 3 targets (2 known, 1 to be identified), sigma 0.0048481 mrad");
    const std::vector<NoiseNumber> noise = campaign.sensor->noise_numbers();
    ASSERT_EQ(noise.size(), 6U);
    EXPECT_EQ(noise[1].name, "sigma_p1_elevation_rad");
    EXPECT_DOUBLE_EQ(noise[1].values.front(), arc_second);
}

TEST(ATheodolite, HasConfigurationsChosenForIt) {
    Campaign campaign = theodolite_campaign();
    const Candidates candidates = random_candidates(campaign, 300, 1);
    ChoiceOptions options;
    options.pose_count = 20;
    options.starts = 2;
    const Plan plan = choose(campaign, candidates, options);
    EXPECT_GT(plan.efficiency, 0.9);
    EXPECT_LE(plan.value, plan.bound);
    const TemporaryFolder folder;
    io::write_plan(folder.path("choice.json"), plan);
    const Plan again = io::read_plan(folder.path("choice.json"));
    EXPECT_EQ(again.poses.front().configuration, plan.poses.front().configuration);
    EXPECT_TRUE(verify(again, campaign, candidates, options).is_right());
    campaign.sensor = std::make_shared<Theodolite>(campaign.sensor->targets(), 2 * arc_second);
    const auto findings = verify(again, campaign, candidates, options).findings;
    const auto changed = std::count_if(findings.begin(), findings.end(), [](const Finding& one) {
        return one.name == "assumes" && one.text.starts_with("sigma_p");
    });
    EXPECT_EQ(changed, 6);
}

TEST(ATheodolite, HasPosesPlannedForIt) {
    const Campaign campaign = theodolite_campaign();
    PlanningOptions options;
    options.pose_count = 16;
    options.pool_count = 400;
    options.workspace_count = 100;
    options.starts = 1;
    const Plan plan = make_plan(campaign, options).plan;
    EXPECT_GT(plan.value, plan.choice_value);
    EXPECT_LT(plan.predicted->rms, 2e-4);  // m
    const TemporaryFolder folder;
    io::write_plan(folder.path("plan.json"), plan);
    const Plan again = io::read_plan(folder.path("plan.json"));
    ASSERT_EQ(again.poses.size(), 16U);
    EXPECT_EQ(again.poses.back().targets, (std::vector<Index>{0, 1, 2}));
    EXPECT_TRUE(verify(again, campaign, options).is_right());
}

}  // namespace
}  // namespace posewise
