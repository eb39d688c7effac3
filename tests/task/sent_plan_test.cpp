#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/task/planning.hpp"
#include "support/cells.hpp"
#include "support/sweep.hpp"

// Joints in a program's digits are checked before they are sent, and so is the way.

namespace posewise {
namespace {

using testing::cell_campaign;
using testing::degree;
using testing::demo_cell;

VectorXd steps_of(double step) { return VectorXd::Constant(6, step); }
const VectorXd thousandth = steps_of(1e-3 * degree);

VectorXd at(double q1, double q2, double q3, double q4, double q5, double q6) {
    VectorXd q(6);
    q << q1, q2, q3, q4, q5, q6;
    return q * degree;
}

Plan plan_of(const Campaign& campaign, const std::vector<VectorXd>& poses) {
    Plan plan;
    plan.campaign = campaign.name;
    plan.columns = configuration_columns(campaign);
    plan.kind = CandidateKind::Pool;
    plan.request.criterion = Criterion::V;
    for (std::size_t k = 0; k < poses.size(); ++k) {
        PlannedPose& pose = plan.poses.emplace_back();
        pose.id = "p" + std::to_string(k + 1);
        pose.configuration = poses[k];
    }
    plan.request.pose_count = static_cast<Index>(poses.size());
    return plan;
}

Campaign in_cell() {
    Campaign campaign = cell_campaign();
    campaign.cell = demo_cell();
    return campaign;
}

template <typename Action>
std::string message_of(const Action& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

/// A coupling as FANUC's, other signs and zeros.
ControllerJoints coupled(const Chain& robot) {
    MatrixXd from_model = MatrixXd::Identity(6, 6);
    from_model(2, 1) = -1;
    from_model(0, 0) = -1;
    return {robot, {"a", "b", "c", "d", "e", "f"}, from_model, at(0.0003, 90, 0, 0, 0, 0)};
}

/// Whether the controller's joints are whole multiples of the step.
double off_grid(const ControllerJoints& joints, const VectorXd& q, const VectorXd& steps) {
    const VectorXd counts = joints.to_controller(q).cwiseQuotient(steps);
    return (counts.array() - counts.array().round()).abs().maxCoeff();
}

TEST(SentPlan, IsOnTheGridAndKeepsTheCell) {
    const Campaign campaign = in_cell();
    const Constraints constraints(campaign, campaign.cell);
    const Pool pool = make_pool(constraints, 4000, 3);
    const ControllerJoints joints = coupled(campaign.robot);
    const VectorXd coarse = steps_of(0.05 * degree);
    std::vector<VectorXd> poses;
    for (Index i = 0; i < pool.configurations.rows(); ++i) {
        poses.push_back(pool.configurations.row(i).transpose());
    }
    const Plan plan = plan_of(campaign, poses);
    const Plan sent = sent_plan(plan, campaign, joints, coarse);
    Index not_nearest = 0;
    for (std::size_t k = 0; k < poses.size(); ++k) {
        const VectorXd& q = sent.poses[k].configuration;
        EXPECT_LT(off_grid(joints, q, coarse), 1e-6);
        EXPECT_GE(constraints.margin(q), -1e-9) << k;
        const VectorXd moved =
            (joints.to_controller(q) - joints.to_controller(poses[k])).cwiseQuotient(coarse);
        EXPECT_LT(moved.cwiseAbs().maxCoeff(), 1 + 1e-9);
        if (moved.cwiseAbs().maxCoeff() > 0.5 + 1e-9) ++not_nearest;
    }
    EXPECT_GT(poses.size(), 100U);
    EXPECT_LT(not_nearest, std::ssize(poses) / 4);
}

TEST(SentPlan, RoundsInwardsAtALimit) {
    Campaign campaign = cell_campaign();
    std::vector<Joint> limits = campaign.robot.joints();
    limits[0].upper = 12.3456 * degree;  // between two thousandths, nearer to the upper
    campaign.robot = Chain(limits, campaign.robot.elements());
    const VectorXd q = at(12.3456, 0, 0, 0, 10, 0);
    const Plan sent =
        sent_plan(plan_of(campaign, {q}), campaign, ControllerJoints(campaign.robot), thousandth);
    EXPECT_NEAR(sent.poses[0].configuration[0] / degree, 12.345, 1e-9);
}

TEST(RoundedWithinLimits, IsNextToTheValuesAndNeverFurtherBeyondALimit) {
    Campaign campaign = in_cell();
    VectorXd coefficients = VectorXd::Zero(6);
    coefficients << 0, -1, 1, 0, 0, 0;
    campaign.cell.joint_sums = {{"q3 - q2", coefficients, {-1.234567, 1.5}}};
    const ControllerJoints joints = coupled(campaign.robot);
    const auto beyond = [&](const VectorXd& q) {
        double most = 0;
        for (Index j = 0; j < 6; ++j) {
            const Joint& joint = campaign.robot.joint(j);
            most = std::max({most, joint.lower - q[j], q[j] - joint.upper});
        }
        return std::max({most, -1.234567 - (q[2] - q[1]), q[2] - q[1] - 1.5});
    };
    Index not_nearest = 0;
    for (Index i = 0; i < testing::sweep_count(); ++i) {
        RandomStream stream(9, static_cast<std::uint64_t>(i));
        VectorXd q(6);
        for (Index j = 0; j < 6; ++j) {  // a third each at its limits and between
            const Joint& joint = campaign.robot.joint(j);
            const Index where = stream.index(3);
            q[j] = where == 0   ? joint.lower
                   : where == 1 ? joint.upper
                                : stream.uniform(joint.lower, joint.upper);
        }
        if (i % 4 == 0) q[2] = q[1] - 1.234567;  // of the sum, too, joint 3 perhaps beyond its own
        const VectorXd rounded = rounded_within_limits(q, campaign, joints, thousandth);
        EXPECT_LT(off_grid(joints, rounded, thousandth), 1e-6);
        EXPECT_LE(beyond(rounded), beyond(q) + 1e-12);
        const VectorXd moved =
            (joints.to_controller(rounded) - joints.to_controller(q)).cwiseQuotient(thousandth);
        EXPECT_LT(moved.cwiseAbs().maxCoeff(), 1 + 1e-6);
        if (moved.cwiseAbs().maxCoeff() > 0.5 + 1e-6) ++not_nearest;
    }
    EXPECT_GT(not_nearest, 0);
}

TEST(SentPlan, IsRefusedWhereNoDigitsFit) {
    Campaign campaign = cell_campaign();
    std::vector<Joint> limits = campaign.robot.joints();
    limits[0].lower = 12.3454 * degree;
    limits[0].upper = 12.3456 * degree;
    campaign.robot = Chain(limits, campaign.robot.elements());
    const Plan plan = plan_of(campaign, {at(12.3455, 0, 0, 0, 10, 0)});
    EXPECT_NE(message_of([&] {
                  sent_plan(plan, campaign, ControllerJoints(campaign.robot), thousandth);
              }).find("pose 'p1' is right, but no joint values next to it"),
              std::string::npos);
}

TEST(SentPlan, IsRefusedForWhatNoRobotMayDo) {
    const Campaign campaign = in_cell();
    const ControllerJoints joints(campaign.robot);
    const auto error = [&](const Plan& plan) {
        return message_of([&] { sent_plan(plan, campaign, joints, thousandth); });
    };
    const VectorXd home = at(0, -30, 0, 0, 0, 0);
    EXPECT_NE(error(plan_of(campaign, {at(95, 0, 0, 0, 0, 0)})).find("q1 is 95 deg"),
              std::string::npos);
    Plan plan = plan_of(campaign, {home});
    plan.poses[0].is_blocked = true;
    EXPECT_NE(error(plan).find("'p1' is BLOCKED"), std::string::npos);
    plan = plan_of(campaign, {home});
    plan.poses[0].configuration[2] = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(error(plan).find("not finite"), std::string::npos);
    plan = plan_of(campaign, {home});
    plan.campaign = "another";
    EXPECT_NE(error(plan).find("campaign: is 'another'"), std::string::npos);
    // The arm stretched into the table.
    EXPECT_NE(error(plan_of(campaign, {at(0, 58, -40, 0, 0, 0)})).find("does not meet"),
              std::string::npos);
}

TEST(SentPlan, KeepsFixedJointsButForTheDigits) {
    Campaign campaign = cell_campaign();
    campaign.cell.fixed_joints[5] = 0.1234567;
    VectorXd q = at(10, 0, 0, 0, 10, 0);
    q[5] = 0.1234567;
    const Plan sent =
        sent_plan(plan_of(campaign, {q}), campaign, ControllerJoints(campaign.robot), thousandth);
    EXPECT_NEAR(sent.poses[0].configuration[5], 0.1234567, 0.5e-3 * degree);
}

// ---- The way ----

std::vector<std::string> names_of(const std::vector<RouteStop>& route) {
    std::vector<std::string> names;
    for (const RouteStop& stop : route) {
        names.push_back(stop.kind == RouteStop::Kind::Home  ? "home"
                        : stop.kind == RouteStop::Kind::Via ? "via"
                                                            : stop.id);
    }
    return names;
}

TEST(Route, BeginsAndEndsAtHome) {
    Campaign campaign = cell_campaign();
    const ControllerJoints joints(campaign.robot);
    Plan plan = plan_of(campaign, {at(0, 0, 0, 0, 10, 0), at(20, 0, 0, 0, 10, 0)});
    plan.poses[1].via = at(10, 10, 0, 0, 0, 0);
    plan.verification = {plan.poses[0]};
    plan.verification[0].id = "v1";
    const auto names = [&](const RouteOptions& options) {
        return names_of(route_of(plan, campaign, joints, thousandth, options));
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(names({}), (Names{"p1", "via", "p2", "v1"}));
    Plan repeated = plan;
    repeated.request.repeats = 3;
    repeated.poses[0].times = 2;
    const std::vector<RouteStop> stops = route_of(repeated, campaign, joints, thousandth);
    EXPECT_EQ(stops[0].times, 6);
    EXPECT_EQ(stops[1].times, 1);
    EXPECT_EQ(stops[2].times, 3);
    EXPECT_EQ(names({2, false}), (Names{"p1", "via", "p2", "v1", "p1", "via", "p2", "v1"}));
    EXPECT_NE(message_of([&] { names({2, true}); }).find("cell.home_deg"), std::string::npos);
    campaign.cell.home = at(0, -30, 0, 0, 0, 0);
    EXPECT_EQ(names({}), (Names{"home", "p1", "via", "p2", "v1", "home"}));
    EXPECT_EQ(names({2, true}),
              (Names{"home", "p1", "via", "p2", "v1", "home", "v1", "p2", "via", "p1", "home"}));
    EXPECT_EQ(names({2, false}),
              (Names{"home", "p1", "via", "p2", "v1", "home", "p1", "via", "p2", "v1", "home"}));
}

TEST(Route, GoesBackWhereNothingIsInTheWay) {
    // From one side of the fixture to the other; every step of each move is looked at.
    Campaign campaign = in_cell();
    campaign.cell.home = at(-60, 0, -60, 0, 0, 0);
    const Constraints constraints(campaign, campaign.cell, false);
    const ControllerJoints joints(campaign.robot);
    const Plan plan = plan_of(campaign, {at(60, 0, -60, 0, 0, 0)});
    EXPECT_NE(message_of([&] {
                  route_of(plan, campaign, joints, thousandth);
              }).find("the way from home to pose 'p1' is not free"),
              std::string::npos);
    // Unless a way may be looked for.
    EXPECT_EQ(route_of(plan, campaign, joints, thousandth, {1, false, true}).size(), 5U);
    Plan around = plan;
    around.poses[0].via = at(0, -30, 0, 0, 0, 0);
    const std::vector<RouteStop> route = route_of(around, campaign, joints, thousandth);
    ASSERT_EQ(route.size(), 5U);  // with a via back
    EXPECT_EQ(route.back().kind, RouteStop::Kind::Home);
    for (std::size_t k = 1; k < route.size(); ++k) {
        for (int step = 0; step <= 500; ++step) {
            const VectorXd q = route[k - 1].configuration +
                               step / 500.0 * (route[k].configuration - route[k - 1].configuration);
            EXPECT_GT(constraints.collision_clearance(q), -1e-3);
        }
    }
}

TEST(SentPlan, VisitsAReferencePoseAgain) {
    std::vector<VectorXd> poses;
    for (int k = 0; k < 7; ++k) poses.push_back(at(5 * k, -20, 0, 0, 0, 0));
    Plan plan = plan_of(cell_campaign(), poses);
    for (PlannedPose& pose : plan.poses) pose.via = poses[0];
    const auto ids = [&](const std::string& reference, Index every) {
        std::string text;
        for (const PlannedPose& pose : with_revisits(plan, reference, every).poses) {
            text += pose.id + ' ';
        }
        return text;
    };
    EXPECT_EQ(ids("p3", 2), "p1 p2 ref1 p3 p4 p5 ref2 p6 p7 ref3 ");
    EXPECT_EQ(ids("p7", 10), "p1 p2 p3 p4 p5 p6 p7 ");
    EXPECT_EQ(ids("p1", 100), "p1 p2 p3 p4 p5 p6 p7 ref1 ");
    const Plan visited = with_revisits(plan, "p3", 2);
    EXPECT_EQ(visited.poses[2].configuration, poses[2]);
    EXPECT_TRUE(visited.poses[1].via);
    EXPECT_FALSE(visited.poses[2].via || visited.poses[3].via);  // ways of other moves
    EXPECT_NE(message_of([&] { with_revisits(plan, "p9", 2); }).find("called 'p9'"),
              std::string::npos);
    plan.poses[0].id = "ref2";
    EXPECT_NE(message_of([&] { with_revisits(plan, "p3", 2); }).find("has a pose called 'ref2'"),
              std::string::npos);
}

TEST(SentPlan, PutsAChoiceInTheOrderOfATour) {
    Campaign campaign = cell_campaign();
    campaign.cell.home = at(0, 0, 0, 0, 0, 0);
    Plan plan = plan_of(campaign, {at(40, 0, 0, 0, 0, 0), at(10, 0, 0, 0, 0, 0),
                                   at(30, 0, 0, 0, 0, 0), at(20, 0, 0, 0, 0, 0)});
    plan.kind = CandidateKind::Configurations;
    const Plan sent = sent_plan(plan, campaign, ControllerJoints(campaign.robot), thousandth);
    std::string order;
    for (const PlannedPose& pose : sent.poses) order += pose.id;
    EXPECT_EQ(order, "p2p4p3p1");
}

TEST(RoundingLoss, GrowsWithTheStep) {
    Campaign campaign = in_cell();
    campaign.criterion = Criterion::V;
    PlanningOptions options(12);
    options.seed = 1;
    options.pool_count = 600;
    options.workspace_count = 60;
    options.starts = 1;
    const Planning planning = make_plan(campaign, options);
    const ControllerJoints joints(campaign.robot);
    PlanningOptions again;
    static_cast<PlanRequest&>(again) = planning.plan.request;
    const auto loss = [&](double step) {
        const Plan sent = sent_plan(planning.plan, campaign, joints, steps_of(step));
        return rounding_loss(planning.plan, sent, campaign, again);
    };
    const RoundingLoss fine = loss(1e-6);
    const RoundingLoss coarse = loss(1e-2);
    EXPECT_NEAR(fine.planned, planning.plan.value, 1e-6 * std::abs(planning.plan.value));
    EXPECT_NEAR(fine.sent, fine.planned, 1e-4 * std::abs(fine.planned));
    EXPECT_NE(coarse.sent, coarse.planned);
    EXPECT_GT(std::abs(coarse.sent - coarse.planned), std::abs(fine.sent - fine.planned));
    EXPECT_LE(fine.largest_turn, 1e-6 * (1 + 1e-9));
    EXPECT_GT(coarse.largest_turn, 1e-3);
    EXPECT_NEAR(*fine.planned_rms, planning.plan.predicted->rms, 1e-9);
}

}  // namespace
}  // namespace posewise
