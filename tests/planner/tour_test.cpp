#include "../../src/planner/tour.hpp"

#include <gtest/gtest.h>

#include <atomic>

#include "../../src/model/halton.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
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

/// Least collision clearance over 2000 steps of a straight move.
double sampled_clearance(const Constraints& constraints, const VectorXd& a, const VectorXd& b) {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k <= 2000; ++k) {
        least = std::min(least, constraints.collision_clearance(a + k / 2000.0 * (b - a)));
    }
    return least;
}

/// An arm of one 1 m link that turns in a plane with a post 0.5 m from its axis.
Constraints arm_and_post(const Vector3d& post, const VectorXd& home) {
    Campaign campaign;
    campaign.robot = planar_arm({1});
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 1e-4);
    Cell cell;
    cell.links = {{"arm", 1, {Vector3d::Zero(), Vector3d::UnitX(), 0.05}}};
    cell.keep_outs = {{"post", Capsule{post, post + Vector3d::UnitZ(), 0.05}}};
    cell.home = home;
    return Constraints(campaign, cell);
}

VectorXd angle(double degrees) { return VectorXd::Constant(1, degrees * degree); }

TEST(IsMoveFree, AgreesWithFineSampling) {
    Cell cell = demo_cell();
    cell.sight.reset();
    cell.target_boxes.clear();
    const Constraints constraints(cell_campaign(), cell);
    const Pool pool = make_pool(constraints, 300, 3);
    Index blocked = 0;
    for (Index i = 1; i < std::min<Index>(pool.configurations.rows(), 120); ++i) {
        const VectorXd a = pool.configurations.row(i - 1).transpose();
        const VectorXd b = pool.configurations.row(i).transpose();
        const double sampled = sampled_clearance(constraints, a, b);
        const bool is_free = is_move_free(constraints, a, b);
        if (!is_free) ++blocked;
        EXPECT_EQ(is_free, is_move_free(constraints, b, a) || std::abs(sampled) < 2e-3);
        if (is_free) {
            EXPECT_GT(sampled, -1e-3);
        }
        if (sampled < -1e-3) {
            EXPECT_FALSE(is_free);
        }
        if (sampled > 0) {
            EXPECT_TRUE(is_free);
        }
    }
    EXPECT_GT(blocked, 5);
}

TEST(Constraints, BoundTheRateOfTheClearance) {
    const Constraints constraints(cell_campaign(), demo_cell());
    const RowMatrixXd q = halton_configurations(constraints.robot(), 500);
    RandomStream stream(31);
    for (Index i = 0; i < q.rows(); ++i) {
        const VectorXd a = q.row(i).transpose();
        const VectorXd step = testing::random_vector(stream, 6, 0.02);
        const double change =
            constraints.collision_clearance(a + step) - constraints.collision_clearance(a);
        EXPECT_LE(std::abs(change), constraints.clearance_rates().dot(step.cwiseAbs()) + 1e-12);
    }
}

TEST(MoveTime, IsThatOfTheSlowestJoint) {
    const Eigen::Vector2d speed(1, 4);
    EXPECT_DOUBLE_EQ(move_time({speed}, Eigen::Vector2d(0, 0), Eigen::Vector2d(-1, 2)), 1);
    EXPECT_DOUBLE_EQ(move_time({speed}, Eigen::Vector2d(0, 0), Eigen::Vector2d(-1, 8)), 2);
}

TEST(MoveTime, KnowsThatJointsSpeedUpAndSlowDown) {
    const VectorXd zero = VectorXd::Zero(1);
    const Pace pace{VectorXd::Constant(1, 2), VectorXd::Constant(1, 4)};
    // 0.5 s and 0.5 m up to 2 m/s and as much down: 1 m in 1 s, and 3 m more in 1.5 s.
    EXPECT_DOUBLE_EQ(move_time(pace, zero, VectorXd::Constant(1, 4)), 2.5);
    EXPECT_DOUBLE_EQ(move_time(pace, zero, VectorXd::Constant(1, -1)), 1);
    EXPECT_DOUBLE_EQ(move_time(pace, zero, VectorXd::Constant(1, 0.25)), 0.5);
    EXPECT_DOUBLE_EQ(move_time(pace, zero, zero), 0);
}

TEST(PlanTour, KeepsSumsOfJointsAtHomeAndOnTheWay) {
    Cell cell = demo_cell();
    VectorXd coefficients = VectorXd::Zero(6);
    coefficients << 0, -1, 1, 0, 0, 0;
    cell.joint_sums = {{"q3 - q2", coefficients, {-50 * degree, 45 * degree}}};
    const Constraints constraints(cell_campaign(), cell);
    const Pool pool = make_pool(constraints, 3000, 5);
    const Tour tour = plan_tour(constraints, pool.configurations.topRows(12));
    for (const Visit& visit : tour.visits) {
        const VectorXd pose = pool.configurations.row(visit.pose).transpose();
        for (const VectorXd& q : {visit.via.value_or(pose), pose}) {
            EXPECT_LE(q[2] - q[1], 43 * degree);  // less the margin
            EXPECT_GE(q[2] - q[1], -48 * degree);
        }
    }
    cell.joint_sums[0].limits = {-50 * degree, 20 * degree};  // home: 30 deg
    const std::string error = testing::input_error_of(
        [&] { plan_tour(Constraints(cell_campaign(), cell), pool.configurations.topRows(1)); });
    EXPECT_NE(error.find("home does not meet joint_sums: q3 - q2 is 30 deg"), std::string::npos)
        << error;
}

TEST(PlanTour, IsAtLeastAQuarterShorterThanThePlanningOrder) {
    const Constraints constraints(cell_campaign(), demo_cell());
    const Pool pool = make_pool(constraints, 2000, 5);
    const RowMatrixXd poses = pool.configurations.topRows(24);
    const Tour tour = plan_tour(constraints, poses);
    RecordProperty("planning_order_s", std::to_string(tour.planning_order_time));
    RecordProperty("nearest_neighbour_s", std::to_string(tour.nearest_neighbour_time));
    RecordProperty("tour_s", std::to_string(tour.time));
    EXPECT_LT(tour.time, 0.75 * tour.planning_order_time);
    EXPECT_EQ(tour.blocked_count, 0);
    EXPECT_NEAR(tour.shortest_time, tour.time, 1e-9);
    TourOptions options;
    options.random_order = 2;
    const Tour random = plan_tour(constraints, poses, options);
    EXPECT_NEAR(random.shortest_time, tour.time, 1e-9);
    EXPECT_GT(random.time, 1.2 * tour.time);
    EXPECT_LE(random.time, 2 * tour.time + 1e-9);
    VectorXd here = constraints.cell().home;
    double time = 0;
    for (const Visit& visit : tour.visits) {
        const VectorXd next = poses.row(visit.pose).transpose();
        for (const VectorXd& stop : {visit.via.value_or(next), next}) {
            EXPECT_GT(sampled_clearance(constraints, here, stop), -1e-3);
            time += move_time({constraints.cell().speed}, here, stop);
            here = stop;
        }
    }
    EXPECT_NEAR(tour.time, time, 1e-9);
    const Tour again = plan_tour(constraints, poses);
    EXPECT_EQ(again.time, tour.time);
}

TEST(PlanTour, GoesAroundAPost) {
    const Constraints constraints = arm_and_post(Vector3d(0, 0.5, -0.5), angle(0));
    RowMatrixXd poses(3, 1);
    poses << 120 * degree, 60 * degree, -100 * degree;
    const Tour tour = plan_tour(constraints, poses);
    EXPECT_EQ(tour.blocked_count, 1);  // a turning arm in a plane cannot pass a post
    for (const Visit& visit : tour.visits) EXPECT_EQ(visit.is_blocked, visit.pose == 0);
    EXPECT_FALSE(is_move_free(constraints, angle(60), angle(120)));
    EXPECT_TRUE(is_move_free(constraints, angle(-100), angle(60)));
}

TEST(PlanTour, FindsAViaWhereTheStraightMoveHits) {
    // Two links and a post: stretched, the arm sweeps it; folded, it passes.
    Campaign campaign;
    campaign.robot = planar_arm({0.5, 0.5});
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 1e-4);
    Cell cell;
    const Vector3d o = Vector3d::Zero();
    cell.links = {{"upper", 1, {o, Vector3d(0.5, 0, 0), 0.02}},
                  {"lower", 2, {o, Vector3d(0.5, 0, 0), 0.02}}};
    cell.keep_outs = {{"post", Sphere{Vector3d(0, 0.9, 0), 0.05}}};
    cell.home = Eigen::Vector2d(0, 0);
    const Constraints constraints(campaign, cell);
    RowMatrixXd poses(1, 2);
    poses << 170 * degree, 0;
    const Tour tour = plan_tour(constraints, poses);
    ASSERT_EQ(tour.visits.size(), 1U);
    EXPECT_EQ(tour.blocked_count, 0);
    ASSERT_TRUE(tour.visits[0].via.has_value());
    const VectorXd& via = *tour.visits[0].via;
    EXPECT_GT(sampled_clearance(constraints, cell.home, via), -1e-3);
    EXPECT_GT(sampled_clearance(constraints, via, poses.row(0).transpose()), -1e-3);
}

TEST(PlanTour, StartsWhereTheRobotIsIfThatIsStated) {
    const Constraints constraints = arm_and_post({9, 9, 0}, angle(0));
    RowMatrixXd poses(3, 1);
    poses << 10 * degree, 50 * degree, 90 * degree;
    TourOptions options;
    EXPECT_EQ(plan_tour(constraints, poses, options).visits.front().pose, 0);
    options.start = angle(95);
    const Tour tour = plan_tour(constraints, poses, options);
    EXPECT_EQ(tour.visits.front().pose, 2);
    EXPECT_NEAR(tour.time, 85 * degree, 1e-9);
}

TEST(PlanTour, StartsAnywhereIfThereIsNoHome) {
    const Constraints constraints = arm_and_post(Vector3d(0, 3, 0), VectorXd());
    RowMatrixXd poses(3, 1);
    poses << 0.1, -0.4, 0.3;
    const Tour tour = plan_tour(constraints, poses);
    EXPECT_NEAR(tour.time, 0.7, 1e-12);
    EXPECT_EQ(tour.visits[1].pose, 0);
    EXPECT_NEAR(tour.planning_order_time, 0.5 + 0.7, 1e-12);
    EXPECT_TRUE(plan_tour(constraints, RowMatrixXd(0, 1)).visits.empty());
}

TEST(PlanTour, IsTheSameAfterAStopIfItIsQuick) {
    const Constraints constraints(cell_campaign(), demo_cell());
    const RowMatrixXd poses = make_pool(constraints, 500, 5).configurations.topRows(8);
    const std::atomic<bool> stop = true;
    TourOptions options;
    options.stop.interrupted = &stop;
    const Tour tour = plan_tour(constraints, poses, options);
    EXPECT_FALSE(tour.is_cut_short);
    EXPECT_EQ(tour.time, plan_tour(constraints, poses).time);
}

TEST(PlanTour, OfManyPosesIsCutShortByAStopAndMarksWhatIsInTheWay) {
    const Constraints constraints(cell_campaign(), demo_cell());
    const RowMatrixXd poses = make_pool(constraints, 40000, 5).configurations;
    ASSERT_GT(poses.rows(), 2000);
    const std::atomic<bool> stop = true;
    TourOptions options;
    options.stop.interrupted = &stop;
    const Tour tour = plan_tour(constraints, poses, options);
    EXPECT_TRUE(tour.is_cut_short);
    ASSERT_EQ(std::ssize(tour.visits), poses.rows());
    std::vector<bool> is_visited(tour.visits.size(), false);
    VectorXd here = constraints.cell().home;
    double time = 0;
    Index blocked = 0;
    for (const Visit& visit : tour.visits) {
        const VectorXd next = poses.row(visit.pose).transpose();
        EXPECT_FALSE(is_visited[static_cast<std::size_t>(visit.pose)]);
        is_visited[static_cast<std::size_t>(visit.pose)] = true;
        EXPECT_EQ(visit.is_blocked, !is_move_free(constraints, here, next));
        blocked += visit.is_blocked ? 1 : 0;
        time += move_time({constraints.cell().speed}, here, next);
        here = next;
    }
    EXPECT_EQ(tour.blocked_count, blocked);
    EXPECT_NEAR(tour.time, time, 1e-9 * time);
    EXPECT_LT(tour.time, 0.5 * tour.planning_order_time);
}

TEST(PlanTour, RejectsAHomeThatCollides) {
    const Constraints constraints = arm_and_post(Vector3d(0, 0.5, -0.5), angle(90));
    EXPECT_THROW(plan_tour(constraints, RowMatrixXd::Zero(1, 1)), InputError);
    const Constraints free = arm_and_post(Vector3d(0, 0.5, -0.5), angle(0));
    EXPECT_THROW(plan_tour(free, RowMatrixXd::Zero(1, 2)), InputError);
}

}  // namespace
}  // namespace posewise
