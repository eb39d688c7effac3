#include "posewise/calibrator/correction.hpp"

#include <gtest/gtest.h>

#include "../../src/core/decompositions.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::degree;
using testing::tracked_campaign;

/// The irreducible errors of a robot, and what an almost noiseless calibration finds of them.
struct Calibrated {
    Campaign campaign;
    Parameters truth;
    Parameters found;
};

Campaign precise_campaign(const Chain& robot) {
    Campaign campaign = tracked_campaign(robot);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-8);
    campaign.model_error = 0;
    return with_robot(campaign, irreducible_model(campaign));
}

Calibrated calibrate(const Chain& robot) {
    const Campaign campaign = precise_campaign(robot);
    const Simulation simulation = simulate(campaign, {.pose_count = 40, .truth_seed = 7});
    const Parameters start =
        register_base_and_targets(campaign, simulation.measurements).parameters;
    return {campaign, simulation.truth,
            identify(campaign, simulation.measurements, start).parameters};
}

Calibrated known(const Chain& robot) {
    const Campaign campaign = precise_campaign(robot);
    const Parameters truth = draw_truth(campaign, 7);
    return {campaign, truth, truth};
}

bool is_held(const Correction& correction) {
    return !correction.held_by_limit.empty() || !correction.held_by_change.empty();
}

/// Of the real robot at joint values q, from where the nominal one would be at `nominal`.
PoseError real_error(const Calibrated& cell, const VectorXd& q, const VectorXd& nominal) {
    const Chain& robot = cell.campaign.robot;
    const Isometry3d wanted =
        cell.found.world_from_base *
        robot.base_from_flange(nominal, VectorXd::Zero(robot.parameter_count()));
    const Isometry3d reached =
        cell.truth.world_from_base * robot.base_from_flange(q, cell.truth.robot);
    return {(wanted.translation() - reached.translation()).norm(),
            Eigen::AngleAxisd(Matrix3d(wanted.linear() * reached.linear().transpose())).angle()};
}

Correction correct(const Calibrated& cell, const VectorXd& nominal,
                   const CorrectionOptions& options = {}) {
    const Chain& robot = cell.campaign.robot;
    const VectorXd zero = VectorXd::Zero(robot.parameter_count());
    return correct_configuration(robot, cell.found.robot, nominal,
                                 robot.base_from_flange(nominal, zero), options);
}

struct Outcome {
    Index free = 0;  ///< corrections without a joint held, not singular
    double worst_position = 0;
    double worst_orientation = 0;
};

/// The largest error left as part of the RMS of the uncorrected ones.
Outcome correct_at_random(const Calibrated& cell, Index count) {
    const RowMatrixXd configurations = random_configurations(cell.campaign.robot, count, 17);
    Outcome outcome;
    VectorXd positions(count), orientations(count);
    for (Index i = 0; i < count; ++i) {
        const VectorXd nominal = configurations.row(i).transpose();
        const Correction correction = correct(cell, nominal);
        const PoseError before = real_error(cell, nominal, nominal);
        positions[i] = before.position;
        orientations[i] = before.orientation;
        EXPECT_NEAR(correction.uncorrected.position, before.position, 1e-6);
        EXPECT_NEAR(correction.uncorrected.orientation, before.orientation, 1e-6);
        if (is_held(correction) || correction.is_singular) continue;
        ++outcome.free;
        const PoseError after = real_error(cell, correction.joints, nominal);
        outcome.worst_position = std::max(outcome.worst_position, after.position);
        outcome.worst_orientation = std::max(outcome.worst_orientation, after.orientation);
    }
    outcome.worst_position /= positions.norm() / std::sqrt(static_cast<double>(count));
    outcome.worst_orientation /= orientations.norm() / std::sqrt(static_cast<double>(count));
    return outcome;
}

TEST(Correction, BringsTheRealRobotToTheNominalPose) {
    for (const Chain& robot : {testing::fanuc(), testing::ur_type(), testing::seven_joint_arm(),
                               testing::gantry_with_wrist(), testing::rail_with_fanuc()}) {
        const Index count = testing::sweep_count() / 5;
        const Outcome outcome = correct_at_random(calibrate(robot), count);
        EXPECT_GT(outcome.free, 9 * count / 10);
        EXPECT_LT(outcome.worst_position, 0.01);
        EXPECT_LT(outcome.worst_orientation, 0.01);
    }
}

/// Four joints set the flange's position and turn; a tilt of its axis stays. The arm is never
/// stretched, where it would have to get longer.
TEST(Correction, OfAScaraBringsTheToolToItsPosition) {
    const Index count = testing::sweep_count() / 5;
    std::vector<Joint> joints = testing::scara().joints();
    joints[1].lower = 0.2;
    const Outcome outcome =
        correct_at_random(known(Chain(joints, testing::scara().elements())), count);
    EXPECT_GT(outcome.free, 9 * count / 10);
    EXPECT_LT(outcome.worst_position, 0.01);
    EXPECT_GT(outcome.worst_orientation, 0.1);
}

/// Two joints in a plane, three of the pose: the weight decides, the analytic answer is that of
/// linear least squares.
TEST(Correction, WeighsAngleAgainstPositionWhereBothCannotBeHad) {
    const Chain robot = testing::planar_arm({0.5, 0.4});
    const VectorXd nominal = Eigen::Vector2d(0.3, 0.9);
    VectorXd parameters = VectorXd::Zero(4);
    parameters[3] = 1e-6;  // the forearm is longer
    const Isometry3d wanted = robot.base_from_flange(nominal, VectorXd::Zero(4));
    for (const double weight : {0.0, 0.1, 1.0, 100.0}) {
        const Correction correction =
            correct_configuration(robot, parameters, nominal, wanted, {.length_per_angle = weight});
        // In the forearm's frame: elbow and flange seen from the flange.
        Eigen::Matrix<double, 3, 2> J;
        J << 0.5 * std::sin(0.9), 0, 0.5 * std::cos(0.9) + 0.4, 0.4, weight, weight;
        const Eigen::Vector3d lacks(-1e-6, 0, 0);
        const Eigen::Vector2d change = (J.transpose() * J).ldlt().solve(J.transpose() * lacks);
        EXPECT_LT((correction.joints - nominal - change).norm(), 1e-10) << weight;
        const Eigen::Vector3d left = lacks - J * change;
        EXPECT_NEAR(correction.residual.position, left.head<2>().norm(), 1e-10) << weight;
        EXPECT_NEAR(correction.residual.orientation, std::abs(change.sum()), 1e-10) << weight;
    }
}

TEST(Correction, OfARedundantRobotIsTheSmallestChange) {
    const Calibrated cell = calibrate(testing::seven_joint_arm());
    const Chain& robot = cell.campaign.robot;
    const RowMatrixXd configurations = random_configurations(robot, 20, 3);
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd nominal = configurations.row(i).transpose();
        const Correction correction = correct(cell, nominal);
        if (is_held(correction) || correction.is_singular) continue;
        FlangeMotion motion;
        robot.differentiate(Isometry3d::Identity(), correction.joints, cell.found.robot, motion);
        const VectorXd idle = detail::singular_directions(motion.joint_twists).V.rightCols<1>();
        const VectorXd change = correction.joints - nominal;
        EXPECT_LT(std::abs(idle.dot(change)), 1e-4 * change.norm()) << i;
    }
}

TEST(Correction, SaysWhichLimitHoldsAJoint) {
    const Calibrated cell = calibrate(testing::fanuc());
    VectorXd nominal = VectorXd::Zero(6);
    nominal << 0.3, 0.2, 0.4, 0.5, 0.9, -0.3;
    const Correction free = correct(cell, nominal);
    EXPECT_TRUE(free.held_by_limit.empty());
    EXPECT_TRUE(free.held_by_change.empty());

    std::vector<Joint> joints = cell.campaign.robot.joints();
    const double change = free.joints[2] - nominal[2];
    (change > 0 ? joints[2].upper : joints[2].lower) = nominal[2] + 0.5 * change;
    Calibrated narrow = cell;
    narrow.campaign.robot = Chain(joints, cell.campaign.robot.elements());
    const Correction held = correct(narrow, nominal);
    EXPECT_EQ(held.held_by_limit, (std::vector<Index>{2}));
    EXPECT_TRUE(held.held_by_change.empty());
    EXPECT_EQ(held.ending, Ending::Converged);
    EXPECT_LT(held.residual.position, held.uncorrected.position);
    EXPECT_GT(held.residual.position, 10 * free.residual.position);
}

/// Seven joints reach the pose with six: the bound costs nothing, and is no shortfall.
TEST(Correction, OfARedundantRobotIsCompleteBesideAJointAtItsLimit) {
    const Calibrated cell = calibrate(testing::seven_joint_arm());
    const RowMatrixXd configurations = random_configurations(cell.campaign.robot, 5, 3);
    Index reached_at_a_limit = 0;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd nominal = configurations.row(i).transpose();
        const double change = correct(cell, nominal).joints[2] - nominal[2];
        std::vector<Joint> joints = cell.campaign.robot.joints();
        (change > 0 ? joints[2].upper : joints[2].lower) = nominal[2] + 0.5 * change;
        Calibrated narrow = cell;
        narrow.campaign.robot = Chain(joints, cell.campaign.robot.elements());
        const Correction found = correct(narrow, nominal);
        if (found.residual.position > 1e-7 || found.residual.orientation > 1e-7) continue;
        EXPECT_EQ(describe_shortfall(narrow.campaign.robot, found), "") << i;
        if (found.joints[2] == nominal[2] + 0.5 * change) ++reached_at_a_limit;
    }
    EXPECT_GT(reached_at_a_limit, 0);
}

/// A sum of joints that the correction would exceed ends at its limit, and what is left is the
/// least that is possible there: no direction along the limit makes it smaller.
TEST(Correction, KeepsToLimitsOfJointSums) {
    const Calibrated cell = known(testing::fanuc());
    const RowMatrixXd configurations = random_configurations(cell.campaign.robot, 50, 17);
    int held = 0;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd nominal = configurations.row(i).transpose();
        const VectorXd free = correct(cell, nominal).joints;
        VectorXd coefficients = VectorXd::Zero(6);
        coefficients[1] = -1;
        coefficients[2] = 1;
        const double from = coefficients.dot(nominal);
        const double to = coefficients.dot(free);
        const double limit = from + 0.5 * (to - from);
        const Interval limits = to > from ? Interval{-10, limit} : Interval{limit, 10};
        const CorrectionOptions options{.joint_sums = {{"q3 - q2", coefficients, limits}}};
        const Correction found = correct(cell, nominal, options);
        EXPECT_NEAR(coefficients.dot(found.joints), limit, 1e-8);
        if (found.held_by_sum.empty()) continue;  // it reaches the pose otherwise, or is singular
        ++held;
        EXPECT_EQ(found.held_by_sum.front(), "q3 - q2");
        EXPECT_NE(describe_shortfall(cell.campaign.robot, found).find("q3 - q2 at its limit"),
                  std::string::npos);
        const auto size = [](const PoseError& error) {
            return std::hypot(error.position, error.orientation);
        };
        const double left = size(found.residual);
        EXPECT_LT(left, size(found.uncorrected));
        if (is_held(found)) continue;
        for (Index j = 0; j < 6; ++j) {
            for (const double step : {-1e-5, 1e-5}) {
                VectorXd moved = found.joints;
                moved[j] += step;
                if (j == 1 || j == 2) moved[3 - j] += step;
                EXPECT_GT(size(real_error(cell, moved, nominal)), left - 1e-8) << j;
            }
        }
    }
    EXPECT_GT(held, 40);
}

/// With the wrist stretched no joint turns the flange about one axis: what lacks stays, no joint
/// runs away, and the correction says so.
TEST(Correction, AtASingularPoseStaysNear) {
    const Calibrated cell = calibrate(testing::fanuc());
    for (const double q5 : {0.0, 1e-8, 1e-4, 1e-3}) {
        VectorXd nominal = VectorXd::Zero(6);
        nominal << 0.3, 0.2, 0.4, 0.5, q5, -0.3;
        const Correction correction = correct(cell, nominal);
        EXPECT_TRUE(is_held(correction) || correction.is_singular) << q5;
        EXPECT_LE((correction.joints - nominal).cwiseAbs().maxCoeff(), 0.1 + 1e-12);
        EXPECT_LT(std::hypot(correction.residual.position, correction.residual.orientation),
                  std::hypot(correction.uncorrected.position, correction.uncorrected.orientation));
        // Joints turn far only for what is worth it: 2 mm or mrad left less by each radian.
        EXPECT_LT((correction.joints - nominal).cwiseAbs().maxCoeff(), degree) << q5;
        EXPECT_TRUE(correction.is_singular) << q5;
        // Where only the position counts, it is had.
        const Correction placed = correct(cell, nominal, {.length_per_angle = 0});
        EXPECT_LT(placed.residual.position, 1e-9);
        EXPECT_FALSE(placed.is_singular);
    }
}

TEST(Correction, RefusesWhatIsOutOfRange) {
    const Chain robot = testing::planar_arm({0.5, 0.4});
    const VectorXd zero = VectorXd::Zero(4);
    const Isometry3d wanted = Isometry3d::Identity();
    const auto correct_at = [&](double q2, const CorrectionOptions& options = {}) {
        return correct_configuration(robot, zero, Eigen::Vector2d(0.1, q2), wanted, options);
    };
    try {
        correct_at(200 * degree);
        ADD_FAILURE() << "not refused";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "joint 'q2' is at 200 deg; must be within its limits, -180 to 180");
    }
    EXPECT_THROW(correct_at(NAN), InputError);
    EXPECT_THROW(correct_at(0, {.length_per_angle = -1}), InputError);
    EXPECT_THROW(correct_at(0, {.largest_turn = 0}), InputError);
    EXPECT_THROW(correct_at(0, {.largest_slide = NAN}), InputError);
    EXPECT_THROW(correct_at(0, {.tool = {0, NAN, 0}}), InputError);
}

}  // namespace
}  // namespace posewise
