#include "../../src/calibrator/readings.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numbers>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/chain.hpp"
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

/// Whether these joints are reversed, and nothing else is changed.
bool is_reversal(const FittedReading& reading, const Campaign& campaign,
                 const std::vector<bool>& is_reversed) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < is_reversed.size(); ++j) {
        if (is_reversed[j]) names.push_back(campaign.robot.joints()[j].name);
    }
    return reversed_joints(reading.changes, campaign) == names &&
           reading.changes.size() == names.size();
}

constexpr double any = std::numeric_limits<double>::infinity();

/// The FANUC on a rail has no symmetry; a half turn of base and flange about the first axis
/// reverses every other joint of the seven-joint arm.
TEST(FitReadings, AreFoundForRobotsWithErrors) {
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
            const auto readings =
                fit_readings(campaign, reverse(simulation.measurements, is_reversed), 30).readings;
            ASSERT_GT(readings.size(), std::size_t{1} << robot.joint_count());
            std::size_t alike = 0;
            bool is_found = false;
            for (const FittedReading& reading : readings) {
                if (!fit_alike(reading, readings[0])) continue;
                alike +=
                    reading.changes.size() == reversed_joints(reading.changes, campaign).size();
                is_found = is_found || is_reversal(reading, campaign, is_reversed);
            }
            EXPECT_EQ(alike, symmetries) << robot.joint_count() << ' ' << item;
            EXPECT_TRUE(is_found) << robot.joint_count() << ' ' << item;
            const bool is_stated = fit_alike(as_stated(readings), readings[0]);
            EXPECT_EQ(find_clearly_better(readings, any) != nullptr, !is_stated);
            EXPECT_LT(readings[0].distance_rms, 0.01);
        }
    }
}

/// A planar arm's mirror image is the arm seen from behind.
TEST(FitReadings, ThatMeasurementsCannotTellApartFitAlike) {
    std::vector<Element> elements = testing::planar_arm({0.5, 0.4}).elements();
    elements.push_back(testing::driven(Motion::Rotation, Axis::X, 2));
    std::vector<Joint> joints = testing::planar_arm({0.5, 0.4}).joints();
    joints.push_back({"roll", -3, 3});
    const Campaign campaign = tracked_campaign(without_parameters(Chain(joints, elements)));
    const Simulation simulation = simulate(campaign, {.pose_count = 40});
    const auto readings = fit_readings(campaign, simulation.measurements).readings;
    EXPECT_TRUE(readings[0].changes.empty());  // the simplest is first
    const auto other = std::ranges::find_if(readings, [&](const FittedReading& reading) {
        return is_reversal(reading, campaign, {true, true, false}) ||
               is_reversal(reading, campaign, {true, true, true});
    });
    ASSERT_NE(other, readings.end());
    EXPECT_NEAR(other->distance_rms, readings[0].distance_rms, 1e-6);
    EXPECT_EQ(find_clearly_better(readings, any), nullptr);
}

TEST(FitReadings, OfMeasurementsThatNoChoiceFitsAreNotClear) {
    const Campaign campaign = tracked_campaign(testing::seven_joint_arm());
    Measurements measurements = simulate(campaign, {.pose_count = 30}).measurements;
    const RowMatrixXd observed = measurements.observations;
    for (Index i = 0; i < 30; ++i) measurements.observations.row(i) = observed.row((i + 1) % 30);
    const auto readings = fit_readings(campaign, measurements).readings;
    EXPECT_EQ(find_clearly_better(readings, any), nullptr);
    const Registration registered = register_base_and_targets(campaign, measurements);
    const double rms =
        make_metrics(residuals(campaign, registered.parameters, measurements)).distance_rms;
    EXPECT_NEAR(as_stated(readings).distance_rms, rms, 1e-6 * rms);
}

TEST(FitReadings, TakeAllConfigurationsWhereSomeHideATarget) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    Measurements measurements = simulate(campaign, {.pose_count = 30}).measurements;
    for (Index i = 0; i < 30; i += 2) measurements.is_seen(i, 2) = false;
    const auto readings = fit_readings(campaign, measurements, 15).readings;
    EXPECT_TRUE(readings[0].changes.empty());
}

TEST(FitReadings, RefuseWhatDoesNotDetermineBaseAndTargets) {
    const Campaign still = tracked_campaign(testing::fanuc());
    const auto same =
        simulate_measurements(still, still.nominal, RowMatrixXd::Constant(8, 6, 0.1), 1, 3);
    const FittedReadings fitted = fit_readings(still, same);
    EXPECT_TRUE(fitted.readings.empty());
    EXPECT_EQ(fitted.undetermined.find("these 8 configurations with 24 points do not"), 0U);
}

TEST(AllReadings, ReverseOneJointAtATimeOfManyJoints) {
    const Campaign snake = tracked_campaign(testing::planar_arm(std::vector<double>(13, 0.1)));
    const auto all = all_readings(snake, OrientationNotation::RotationVector, 1);
    EXPECT_EQ(std::ranges::count_if(all,
                                    [](const ReadingChanges& changes) {
                                        return changes.size() == 1 &&
                                               has_kind(changes, ReadingChange::Kind::Reversed);
                                    }),
              13);
    EXPECT_LT(all.size(), 1000U);
}

/// A reading that stands for a slip in the file, made by reading the right file so.
struct Slip {
    ReadingChange made;
    std::string words;
};

/// The FANUC, with errors, in front of a tracker; the words of what fits clearly better.
std::string words_of(const Campaign& campaign, const Measurements& measured) {
    const auto readings = fit_readings(campaign, measured).readings;
    const FittedReading* const better = find_clearly_better(readings, 0.05);
    return better == nullptr ? "none" : describe(better->changes, campaign, measured.notation);
}

TEST(FitReadings, FindEverySlipOfJointsAndPoints) {
    using Kind = ReadingChange::Kind;
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign = with_robot(campaign, irreducible_model(campaign));
    const std::vector<Slip> slips{
        {{.kind = Kind::Reversed, .joint = 1}, "q2 reversed"},
        {{.kind = Kind::Exchanged, .joint = 3, .other = 5}, "q4 and q6 exchanged"},
        {{.kind = Kind::Coupled, .joint = 2, .other = 1, .factor = 1, .other_factor = 1},
         "q3 - q2 in place of q3"},
        {{.kind = Kind::Coupled, .joint = 2, .other = 1, .factor = 1, .other_factor = -1},
         "q3 + q2 in place of q3"},
        {{.kind = Kind::Coupled, .joint = 4, .other = 5, .factor = 1, .other_factor = 1},
         "q5 - q6 in place of q5"},
        {{.kind = Kind::Coupled, .joint = 2, .other = 1, .factor = -1, .other_factor = 1},
         "-q3 + q2 in place of q3"},
        {{.kind = Kind::JointFactor, .joint = 2, .factor = 180 / std::numbers::pi},
         "q3 in degrees where the file says rad"},
        {{.kind = Kind::JointFactor, .factor = std::numbers::pi / 180},
         "joint values in rad where the file says degrees"},
        {{.kind = Kind::Zero, .joint = 1, .factor = std::numbers::pi / 2},
         "q2 - 90 deg in place of q2"},
        {{.kind = Kind::LengthFactor, .factor = 1 / 304.8},
         "points in feet where the file says mm"},
        {{.kind = Kind::LengthFactor, .factor = 1 / 0.0254},
         "points in inches where the file says m"},
        {{.kind = Kind::LengthFactor, .factor = 1e3}, "points in mm where the file says m"},
        {{.kind = Kind::LengthFactor, .joint = 1, .factor = 1e-3},
         "target 2 in m where the file says mm"},
    };
    for (std::uint64_t item = 0; item < 2; ++item) {
        const Measurements right =
            simulate(campaign, {.pose_count = 24, .truth_seed = item}).measurements;
        EXPECT_EQ(words_of(campaign, right), "none");
        for (const auto& [made, words] : slips) {
            EXPECT_EQ(words_of(campaign, read_with({made}, campaign, right)), words);
        }
    }
}

/// A robot that hardly moves, as by joint values taken as degrees, fits them nearly as well.
TEST(FitReadings, FindPointsInMetresThatHardlyMove) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    Measurements tiny = simulate(campaign, {.pose_count = 24}).measurements;
    tiny.observations *= 1e-5;
    const auto readings = fit_readings(campaign, tiny).readings;
    EXPECT_TRUE(std::ranges::none_of(readings, [&](const FittedReading& reading) {
        return has_kind(reading.changes, ReadingChange::Kind::JointFactor) &&
               reading.distance_rms < 0.1;
    }));
}

TEST(FitReadings, FindReversedJointsOfPointsInFeet) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements right = simulate(campaign, {.pose_count = 24}).measurements;
    const ReadingChanges both{{.kind = ReadingChange::Kind::Reversed, .joint = 2},
                              {.kind = ReadingChange::Kind::LengthFactor, .factor = 1 / 304.8}};
    EXPECT_EQ(words_of(campaign, read_with(both, campaign, right)),
              "points in feet where the file says mm and q3 reversed");
}

/// Its first, fourth and sixth axes in one plane, the FANUC is its own mirror image.
TEST(FitReadings, NameALeftHandedFrameBeforeTheJointsThatFitAsWell) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements right = simulate(campaign, {.pose_count = 24}).measurements;
    const ReadingChange mirrored{.kind = ReadingChange::Kind::LeftHanded};
    const Measurements wrong = read_with({mirrored}, campaign, right);
    EXPECT_EQ(words_of(campaign, wrong), "the instrument's frame left-handed");
    const auto readings = fit_readings(campaign, wrong).readings;
    EXPECT_TRUE(std::ranges::any_of(readings, [&](const FittedReading& reading) {
        return fit_alike(reading, readings[0]) &&
               is_reversal(reading, campaign, {true, false, false, true, false, true});
    }));
}

/// A pose campaign, and its measurements with orientations that a function of the right rotation
/// matrices writes into the observations.
struct Poses {
    Poses() {
        campaign.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 1e-4);
        campaign.nominal.sensor.setZero(6);
        right = simulate(campaign, {.pose_count = 24}).measurements;
    }
    /// `numbers` as a file's columns of this notation would have them.
    std::string words_with(const std::function<Vector3d(const Matrix3d&)>& numbers,
                           OrientationNotation notation) const {
        Measurements wrong = right;
        wrong.notation = notation;
        if (notation == OrientationNotation::RollPitchYaw) wrong.roll_pitch_yaw.resize(24, 3);
        for (Index k = 0; k < 24; ++k) {
            auto read = wrong.observations.row(k).tail<3>();
            const Vector3d written = numbers(rotation_from_vector(read.transpose()));
            read = written.transpose();
            if (notation != OrientationNotation::RollPitchYaw) continue;
            wrong.roll_pitch_yaw.row(k) = written.transpose();
            read = vector_from_rotation(rotation_from_rpy(written)).transpose();
        }
        return words_of(campaign, wrong);
    }

    Campaign campaign = tracked_campaign(testing::fanuc());
    Measurements right;
};

TEST(FitReadings, FindPosesThatAreInvertedOrShouldBe) {
    Poses poses;
    const auto inverted = [&] {
        Measurements read = poses.right;
        invert_poses(read.observations);
        return words_of(poses.campaign, read);
    };
    EXPECT_EQ(inverted(), "each pose inverted");
    poses.campaign.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 1e-4,
                                                         PoseRecord{true, true});
    EXPECT_EQ(words_of(poses.campaign, poses.right), "none");
    EXPECT_EQ(inverted(), "each pose inverted");
    // Senses of orientations are those of what was read.
    Measurements wrong = poses.right;
    invert_poses(wrong.observations);
    for (auto row : wrong.observations.rowwise()) {
        const Matrix3d R = rotation_from_vector(row.tail<3>().transpose());
        row.tail<3>() = rpy_from_rotation(R).transpose();
    }
    invert_poses(wrong.observations);
    EXPECT_EQ(words_of(poses.campaign, wrong), "rx, ry, rz as roll, pitch, yaw about fixed axes");
}

TEST(FitReadings, FindAnglesAndRotationVectorsUnderEachOthersNames) {
    const Poses poses;
    const std::vector<std::pair<std::string, std::function<Vector3d(const Matrix3d&)>>> angles{
        {"yaw, pitch, roll (angles about z, the turned y and the turned x)",
         [](const Matrix3d& R) -> Vector3d { return rpy_from_rotation(R).reverse(); }},
        {"Euler angles about x, the turned y and the turned z",
         [](const Matrix3d& R) -> Vector3d { return R.eulerAngles(0, 1, 2); }},
        {"Euler angles about z, the turned y and the turned z",
         [](const Matrix3d& R) -> Vector3d { return R.eulerAngles(2, 1, 2); }},
        {"Euler angles about z, the turned x and the turned z",
         [](const Matrix3d& R) -> Vector3d { return R.eulerAngles(2, 0, 2); }},
    };
    using Notation = OrientationNotation;
    EXPECT_EQ(poses.words_with(rpy_from_rotation, Notation::RollPitchYaw), "none");
    EXPECT_EQ(poses.words_with(vector_from_rotation, Notation::RollPitchYaw),
              "roll, pitch, yaw as a rotation vector");
    EXPECT_EQ(poses.words_with(rpy_from_rotation, Notation::RotationVector),
              "rx, ry, rz as roll, pitch, yaw about fixed axes");
    for (const auto& [words, numbers] : angles) {
        EXPECT_EQ(poses.words_with(numbers, Notation::RollPitchYaw),
                  "roll, pitch, yaw as " + words);
        EXPECT_EQ(poses.words_with(numbers, Notation::RotationVector), "rx, ry, rz as " + words);
    }
}

TEST(FitReadings, FindPositionsAlongOtherAxesThanOrientations) {
    const Poses poses;
    Measurements wrong = poses.right;
    wrong.observations.col(2) *= -1;
    EXPECT_EQ(words_of(poses.campaign, wrong), "x, y, -z in place of x, y, z");
    wrong = poses.right;
    wrong.observations.col(0).swap(wrong.observations.col(1));
    EXPECT_EQ(words_of(poses.campaign, wrong), "y, x, z in place of x, y, z");
}

TEST(FitReadings, FindOrientationsInvertedOrInAnotherUnit) {
    const Poses poses;
    const auto vector = [](double factor) {
        return [factor](const Matrix3d& R) -> Vector3d { return factor * vector_from_rotation(R); };
    };
    constexpr double deg = std::numbers::pi / 180;
    EXPECT_EQ(poses.words_with(vector(-1), OrientationNotation::RotationVector),
              "rx, ry, rz inverted");
    EXPECT_EQ(poses.words_with(vector(1 / deg), OrientationNotation::RotationVector),
              "rx, ry, rz in degrees where the file says rad");
    EXPECT_EQ(poses.words_with(vector(deg), OrientationNotation::RotationVector),
              "rx, ry, rz in rad where the file says degrees");
    EXPECT_EQ(poses.words_with(vector(-1), OrientationNotation::Quaternion),
              "qw, qx, qy, qz conjugate");
}

}  // namespace
}  // namespace posewise
