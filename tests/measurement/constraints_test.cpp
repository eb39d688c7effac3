#include "posewise/measurement/constraints.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "../../src/model/halton.hpp"
#include "posewise/core/errors.hpp"
#include "support/cells.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace detail;
using testing::cell_campaign;
using testing::degree;
using testing::demo_cell;
using testing::planar_arm;

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Two 1 m links in the xy plane, one target at the tip; the tracker at (5, 0, 0) looks along -x.
Campaign arm_campaign() {
    Campaign campaign;
    campaign.robot = planar_arm({1, 1});
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 1e-4);
    campaign.nominal.world_from_base =
        Eigen::Translation3d(5, 0, 0) * Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitZ());
    campaign.nominal.robot = VectorXd::Zero(4);
    campaign.nominal.sensor = VectorXd::Zero(3);
    campaign.has_nominal_base = true;
    campaign.has_nominal_targets = true;
    return campaign;
}

VectorXd angles(double a, double b) { return Eigen::Vector2d(a * degree, b * degree); }

ConstraintReport check(const Cell& cell, const VectorXd& q) {
    return Constraints(arm_campaign(), cell).check(q);
}

TEST(Constraints, OfAnEmptyCellAreTheJointLimits) {
    const ConstraintReport report = check({}, angles(170, -30));
    EXPECT_NEAR(report[Constraint::JointLimits], 10 * degree, 1e-12);
    EXPECT_EQ(report.margin(), report[Constraint::JointLimits]);
    EXPECT_EQ(report[Constraint::KeepOuts], infinity);
    EXPECT_EQ(report[Constraint::LineOfSight], infinity);
    EXPECT_TRUE(report.is_seen.all());
    EXPECT_FALSE(check({}, angles(190, 0)).is_feasible());
}

TEST(Constraints, MeasureLimitsFromTheMarginAndHoldFixedJoints) {
    Cell cell;
    cell.limit_margin.angle = 15 * degree;
    EXPECT_NEAR(check(cell, angles(170, 0))[Constraint::JointLimits], -5 * degree, 1e-12);
    cell.fixed_joints[0] = 30 * degree;
    EXPECT_EQ(check(cell, angles(30, 0))[Constraint::FixedJoints], infinity);
    EXPECT_NEAR(check(cell, angles(31, 0))[Constraint::FixedJoints], -1 * degree, 1e-12);
    EXPECT_NEAR(check(cell, angles(30, 160))[Constraint::JointLimits], 5 * degree, 1e-12);
}

TEST(Constraints, KeepSumsOfJointsWithinTheirLimits) {
    Cell cell;
    cell.joint_sums = {{"q2 - q1", Eigen::Vector2d(-1, 1), {-40 * degree, 30 * degree}}};
    EXPECT_NEAR(check(cell, angles(10, 20))[Constraint::JointSums], 20 * degree, 1e-12);
    EXPECT_NEAR(check(cell, angles(60, 10))[Constraint::JointSums], -10 * degree, 1e-12);
    cell.limit_margin.angle = 5 * degree;
    EXPECT_NEAR(check(cell, angles(10, 20))[Constraint::JointSums], 15 * degree, 1e-12);
    const Constraints constraints(arm_campaign(), cell);
    EXPECT_TRUE(constraints.restricts_places());
    EXPECT_EQ(describe_violation(constraints, angles(10, 20), Stop::Measured), "");
    EXPECT_EQ(describe_violation(constraints, angles(10, 50), Stop::Via),
              "does not meet joint_sums: q2 - q1 is 40 deg, must be from -35 to 25 deg");
    const Pool pool = make_pool(constraints, 500, 1);
    for (const auto& q : pool.configurations.rowwise()) {
        EXPECT_LE(q[1] - q[0], 25 * degree);
        EXPECT_GE(q[1] - q[0], -35 * degree);
    }
    const auto refuse = [&](const JointSum& sum) {
        cell.joint_sums = {sum};
        return testing::input_error_of([&] { Constraints(arm_campaign(), cell); });
    };
    EXPECT_NE(refuse({"none", VectorXd::Zero(2), {0, 1}}).find("not all 0"), std::string::npos);
    EXPECT_NE(refuse({"q1", Eigen::Vector2d(1, 0), {0, 9 * degree}}).find("wider than the margin"),
              std::string::npos);
}

TEST(Constraints, KeepEveryTargetInOneOfTheBoxes) {
    Cell cell;
    const Box right{Vector3d(1, -1, -1), Vector3d(2.5, 1, 1)};
    const Box left{Vector3d(-2.5, -1, -1), Vector3d(-1, 1, 1)};
    cell.target_boxes = {right, left};
    EXPECT_NEAR(check(cell, angles(0, 0))[Constraint::TargetBoxes], 0.5, 1e-12);
    EXPECT_NEAR(check(cell, angles(180, 0))[Constraint::TargetBoxes], 0.5, 1e-12);
    EXPECT_NEAR(check(cell, angles(90, 0))[Constraint::TargetBoxes], -std::sqrt(2), 1e-12);
}

TEST(Constraints, KeepLinksOffKeepOutsByTheSafetyDistance) {
    Cell cell;
    cell.links = {{"pedestal", 0, {{0, 0, -3}, {0, 0, 0}, 0.2}},
                  {"lower", 2, {Vector3d::Zero(), Vector3d::UnitX(), 0.1}}};
    cell.keep_outs = {{"wall", HalfSpace{{0, 2.5, 0}, {0, -1, 0}}},
                      {"floor", HalfSpace{{0, 0, -2}, {0, 0, 1}}}};
    cell.safety_distance = 0.05;
    EXPECT_NEAR(check(cell, angles(90, 0))[Constraint::KeepOuts], 0.5 - 0.1 - 0.05, 1e-12);
    EXPECT_NEAR(check(cell, angles(0, 0))[Constraint::KeepOuts], 1.85, 1e-12);
    const Constraints constraints(arm_campaign(), cell);
    EXPECT_EQ(constraints.collision_clearance(angles(90, 0)),
              constraints.check(angles(90, 0))[Constraint::KeepOuts]);
}

TEST(Constraints, KeepLinksApartButForNeighbours) {
    Cell cell;
    const Vector3d o = Vector3d::Zero();
    cell.links = {{"pedestal", 0, {o, o, 0.2}},
                  {"upper", 1, {o, Vector3d::UnitX(), 0.1}},
                  {"lower", 2, {o, Vector3d::UnitX(), 0.1}}};
    // Only pedestal and lower can collide: folded, the tip of the lower link is at the pedestal.
    EXPECT_NEAR(check(cell, angles(0, 0))[Constraint::SelfCollision], 1 - 0.3, 1e-12);
    EXPECT_NEAR(check(cell, angles(0, 180))[Constraint::SelfCollision], -0.3, 1e-12);
    cell.links.pop_back();  // the ball at the target is at the pedestal then
    EXPECT_NEAR(check(cell, angles(0, 180))[Constraint::SelfCollision], -0.2 - 0.01905, 1e-12);
    Campaign flat = arm_campaign();
    flat.has_nominal_targets = false;
    EXPECT_EQ(Constraints(flat, cell).check(angles(0, 180))[Constraint::SelfCollision], infinity);
}

TEST(Constraints, KeepTheBallsAtTargetsOffKeepOutsWithoutAnyLink) {
    Cell cell;
    cell.keep_outs = {{"fence", HalfSpace{{0, 2.1, 0}, {0, -1, 0}}}};
    cell.safety_distance = 0.03;
    const double radius = 0.01905;
    EXPECT_NEAR(check(cell, angles(90, 0))[Constraint::KeepOuts], 0.1 - radius - 0.03, 1e-12);
    cell.keep_outs = {{"fence", HalfSpace{{0, 2.04, 0}, {0, -1, 0}}}};
    EXPECT_FALSE(check(cell, angles(90, 0)).is_feasible());
    Campaign marks = arm_campaign();
    marks.sensor = std::make_shared<PointSensor>(
        Targets(std::vector<std::optional<Vector3d>>(1, std::nullopt)).with_radius(0),
        IsotropicNoise{1e-4});
    EXPECT_TRUE(Constraints(marks, cell).check(angles(90, 0)).is_feasible());
}

TEST(Constraints, TellWhichBodiesAreNearest) {
    Cell cell;
    cell.links = {{"pedestal", 0, {{0, 0, -3}, {0, 0, 0}, 0.2}},
                  {"lower", 2, {Vector3d::Zero(), Vector3d::UnitX() / 2, 0.1}}};
    cell.keep_outs = {{"wall", HalfSpace{{0, 2.5, 0}, {0, -1, 0}}}};
    const Constraints constraints(arm_campaign(), cell);
    const Clearance ahead = constraints.nearest(angles(90, 0));
    EXPECT_NEAR(ahead.distance, 0.5 - 0.01905, 1e-12);
    EXPECT_EQ(ahead.body, "target 1");
    EXPECT_EQ(ahead.other, "wall");
    const Clearance folded = constraints.nearest(angles(-90, 180));
    EXPECT_EQ(folded.body, "target 1");
    EXPECT_EQ(folded.other, "pedestal");
    EXPECT_EQ(describe_clearance(ahead, 0.6),
              "target 1 is 480.95 mm from wall, must be 600 mm away");
    EXPECT_EQ(Constraints(arm_campaign(), {}).nearest(angles(90, 0)).body, "");
}

TEST(DescribeUncheckedBodies, SaysThatAnArmWithoutLinksIsNotKeptOffObstacles) {
    Campaign campaign = arm_campaign();
    EXPECT_EQ(describe_unchecked_bodies(campaign), "");
    campaign.cell.keep_outs = {{"fence", HalfSpace{{0, 2.1, 0}, {0, -1, 0}}}};
    EXPECT_NE(describe_unchecked_bodies(campaign).find("the arm is not kept off"),
              std::string::npos);
    campaign.cell.links = {{"lower", 2, {Vector3d::Zero(), Vector3d::UnitX(), 0.1}}};
    EXPECT_EQ(describe_unchecked_bodies(campaign), "");
    campaign.has_nominal_targets = false;
    EXPECT_NE(describe_unchecked_bodies(campaign).find("the targets are not kept off"),
              std::string::npos);
}

TEST(Constraints, MeasureRangeAzimuthAndElevationInTheTrackersFrame) {
    Cell cell;
    cell.sight = Sight{};
    cell.sight->range = {3.5, 10};
    cell.sight->azimuth = {-10 * degree, 30 * degree};
    cell.sight->elevation = {-5 * degree, 20 * degree};
    const ConstraintReport stretched = check(cell, angles(0, 0));
    EXPECT_NEAR(stretched[Constraint::Range], -0.5, 1e-12);
    EXPECT_NEAR(stretched[Constraint::Azimuth], 10 * degree, 1e-12);
    EXPECT_NEAR(stretched[Constraint::Elevation], 5 * degree, 1e-12);
    EXPECT_FALSE(stretched.is_seen[0]);
    const ConstraintReport left = check(cell, angles(-90, 0));  // at (0, -2, 0): y = 2 for tracker
    EXPECT_NEAR(left[Constraint::Azimuth], 30 * degree - std::atan2(2, 5), 1e-12);
    EXPECT_TRUE(left.is_seen[0]);
    cell.sight->azimuth = {170 * degree, 200 * degree};  // across 180 deg
    EXPECT_NEAR(check(cell, angles(-90, 0))[Constraint::Azimuth], std::atan2(2, 5) - 170 * degree,
                1e-12);
}

TEST(Constraints, MeasureIncidenceFromTheReflectorsNormal) {
    Cell cell;
    cell.sight = Sight{};
    cell.sight->normals = {Vector3d::UnitX()};
    EXPECT_NEAR(check(cell, angles(0, 0))[Constraint::Incidence], 30 * degree, 1e-12);
    EXPECT_NEAR(
        check(cell, angles(0, 20))[Constraint::Incidence],
        30 * degree - (20 * degree + std::atan2(std::sin(20 * degree), 4 - std::cos(20 * degree))),
        1e-12);
    EXPECT_NEAR(check(cell, angles(180, 0))[Constraint::Incidence], -150 * degree, 1e-12);
}

TEST(Constraints, SeeNoTargetBehindALinkOrAKeepOut) {
    Cell cell;
    cell.sight = Sight{};
    cell.links = {{"upper", 1, {Vector3d::Zero(), Vector3d::UnitX(), 0.1}}};
    // Folded to 170 deg the tip is at (0.015, 0.174): past the elbow at (1, 0) the line rises.
    const auto clear = check(cell, angles(0, 0))[Constraint::LineOfSight];
    EXPECT_NEAR(clear, 1 - 0.1, 1e-12);
    EXPECT_LT(check(cell, angles(180, 180))[Constraint::LineOfSight], 0.0);
    EXPECT_LT(check(cell, angles(0, 180))[Constraint::LineOfSight], 0.0);
    cell.links.clear();
    cell.keep_outs = {{"post", Sphere{{3, 0.3, 0}, 0.2}}, {"tripod", Sphere{{5, 0, 0}, 0.5}}};
    EXPECT_NEAR(check(cell, angles(0, 0))[Constraint::LineOfSight], 0.1, 1e-12);
    EXPECT_LT(check(cell, angles(17, 0))[Constraint::LineOfSight], 0.0);
    cell.sight->is_line_required = false;
    EXPECT_EQ(check(cell, angles(17, 0))[Constraint::LineOfSight], infinity);
}

TEST(Constraints, AskForAsManyTargetsAsMustBeSeenAtOnce) {
    const Campaign campaign = cell_campaign();
    Cell cell = demo_cell();
    const RowMatrixXd q = halton_configurations(campaign.robot, 400);
    std::array<Index, 4> feasible{};
    for (Index needed = 0; needed <= 3; ++needed) {
        cell.sight->least_visible = needed;
        const Constraints constraints(campaign, cell);
        for (Index i = 0; i < q.rows(); ++i) {
            const ConstraintReport report = constraints.check(q.row(i).transpose());
            const auto seen = report.is_seen.count();
            const bool is_enough = report[Constraint::VisibleTargets] >= 0;
            EXPECT_EQ(is_enough, seen >= needed);
            for (const auto kind : {Constraint::Range, Constraint::Azimuth, Constraint::Elevation,
                                    Constraint::Incidence, Constraint::LineOfSight}) {
                EXPECT_LE(report[Constraint::VisibleTargets], report[kind]);
            }
            if (is_enough) ++feasible[static_cast<std::size_t>(needed)];
        }
    }
    EXPECT_EQ(feasible[0], 400);
    EXPECT_GT(feasible[1], feasible[2]);
    EXPECT_GT(feasible[2], 0);
}

TEST(Constraints, HaveAMarginThatIsContinuous) {
    const Constraints constraints(cell_campaign(), demo_cell());
    const RowMatrixXd q = halton_configurations(constraints.robot(), 300);
    RandomStream stream(41);
    for (Index i = 0; i < q.rows(); ++i) {
        const VectorXd a = q.row(i).transpose();
        const VectorXd b = a + testing::random_vector(stream, 6, 1e-6);
        EXPECT_NEAR(constraints.margin(a), constraints.margin(b), 1e-4);
    }
}

TEST(Constraints, RejectCellsThatContradictThemselves) {
    const auto rejects = [](const std::function<void(Cell&, Campaign&)>& spoil) {
        Cell cell = demo_cell();
        Campaign campaign = cell_campaign();
        spoil(cell, campaign);
        EXPECT_THROW(Constraints(campaign, cell), InputError);
    };
    EXPECT_NO_THROW(Constraints(cell_campaign(), demo_cell()));
    rejects([](Cell& cell, Campaign&) { cell.limit_margin.angle = 2; });
    rejects([](Cell& cell, Campaign&) { cell.fixed_joints[0] = 2; });
    rejects([](Cell& cell, Campaign&) { cell.fixed_joints[6] = 0; });
    rejects([](Cell& cell, Campaign&) { cell.target_boxes[0].upper.x() = -5; });
    rejects([](Cell& cell, Campaign&) { cell.links[0].frame = 8; });
    rejects([](Cell& cell, Campaign&) { cell.links[0].solid.radius = 0; });
    rejects([](Cell& cell, Campaign&) { cell.links[5].solid.radius = 0.2; });  // swallows targets
    rejects([](Cell& cell, Campaign&) { cell.safety_distance = -1; });
    rejects([](Cell& cell, Campaign&) { cell.least_joint_distance = -1; });
    rejects([](Cell& cell, Campaign&) { cell.sight->range = {3, 2}; });
    rejects([](Cell& cell, Campaign&) { cell.sight->range = {std::nan(""), 2}; });
    rejects([](Cell& cell, Campaign&) { cell.sight->azimuth = {-4, 4}; });
    rejects([](Cell& cell, Campaign&) { cell.sight->normals.pop_back(); });
    rejects([](Cell& cell, Campaign&) { cell.sight->normals[0] *= 2; });
    rejects([](Cell& cell, Campaign&) { cell.sight->acceptance_half_angle = 0; });
    rejects([](Cell& cell, Campaign&) { cell.sight->least_visible = 4; });
    rejects([](Cell& cell, Campaign&) { cell.home.resize(2); });
    rejects([](Cell& cell, Campaign&) { cell.speed[3] = 0; });
    rejects([](Cell&, Campaign& campaign) { campaign.has_nominal_base = false; });
    rejects([](Cell&, Campaign& campaign) { campaign.has_nominal_targets = false; });
    EXPECT_THROW(check({}, VectorXd::Zero(3)), InputError);
    EXPECT_THROW(check({}, angles(std::nan(""), 0)), InputError);
}

TEST(JointDistance, IsTheLargestDifferenceOfAJoint) {
    EXPECT_DOUBLE_EQ(joint_distance(angles(10, -20), angles(40, 0)), 30 * degree);
    EXPECT_NEAR(joint_distance(angles(10, 179), angles(11, -178)), 3 * degree, 1e-12);
    EXPECT_NEAR(joint_distance(angles(375, 0), angles(10, 0)), 5 * degree, 1e-12);
}

}  // namespace
}  // namespace posewise
