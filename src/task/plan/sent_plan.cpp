#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "core/text.hpp"
#include "planner/tour.hpp"
#include "planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/planner/planning.hpp"
#include "posewise/task/planning.hpp"
#include "selection/bound.hpp"
#include "task/choice/choice_problem.hpp"

namespace posewise {
namespace {

using detail::quote;

/// Configurations on the grid of a program's digits.
class Grid {
  public:
    Grid(const ControllerJoints& controller, const VectorXd& steps)
        : controller_(controller), steps_(steps) {
        if (steps.size() != controller.count() || !(steps.array() > 0).all()) {
            throw InputError("a step of the controller's joints is missing or not positive");
        }
    }

    VectorXd nearest(const VectorXd& q) const {
        return to_model(q, counts(q).array().round().matrix());
    }

    /// The nearest next to q that are as they must be; nothing: none is.
    std::optional<VectorXd> nearest_of(const VectorXd& q,
                                       const std::function<bool(const VectorXd&)>& is_right) const {
        const VectorXd planned = counts(q);
        const VectorXd lower = planned.array().floor();
        const Index joints = std::min<Index>(planned.size(), most_varied);
        std::vector<VectorXd> corners;
        for (unsigned mask = 0; mask < 1U << joints; ++mask) {
            VectorXd corner = planned.array().round();
            for (Index j = 0; j < joints; ++j) corner[j] = lower[j] + ((mask >> j) & 1U);
            corners.push_back(corner);
        }
        std::ranges::stable_sort(
            corners, {}, [&](const VectorXd& corner) { return (corner - planned).squaredNorm(); });
        for (const VectorXd& corner : corners) {
            const VectorXd candidate = to_model(q, corner);
            if (is_right(candidate)) return candidate;
        }
        return std::nullopt;
    }

  private:
    static constexpr Index most_varied = 10;  // joints; 1024 corners

    VectorXd counts(const VectorXd& q) const {
        return controller_.to_controller(q.head(controller_.count())).cwiseQuotient(steps_);
    }
    VectorXd to_model(const VectorXd& q, const VectorXd& counts) const {
        VectorXd sent = q;
        sent.head(controller_.count()) = controller_.to_model(counts.cwiseProduct(steps_));
        return sent;
    }

    const ControllerJoints& controller_;
    const VectorXd& steps_;
};

/// Which constraint a configuration violates, or what it does not show; empty if it is right.
std::string find_fault_of_pose(const Constraints& constraints, const VectorXd& q,
                               const std::vector<Index>& targets) {
    const std::string violation = describe_violation(constraints, q, Stop::Sent);
    if (!violation.empty() || targets.empty()) return violation;
    const SeenTargets is_seen = constraints.seen(q);
    for (const Index target : targets) {
        if (target >= is_seen.size() || !is_seen[target]) {
            return fmt::format("does not show target {}", target + 1);
        }
    }
    return "";
}

void check_sendable(const Plan& plan, const Campaign& campaign,
                    const ControllerJoints& controller) {
    const std::string mismatch = describe_mismatch(plan, campaign);
    if (!mismatch.empty()) throw InputError(mismatch);
    if (campaign.sensor->has_contacts()) {
        throw InputError("the sensor touches sockets, which no program of joint moves can");
    }
    if (controller.count() != campaign.robot.joint_count()) {
        throw InputError("the controller's joints are of another robot");
    }
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) {
            if (!pose.configuration.allFinite() || (pose.via && !pose.via->allFinite())) {
                throw InputError("pose " + quote(pose.id) + " has a joint that is not finite");
            }
        }
    }
}

void check_ways(const std::vector<PlannedPose>& poses) {
    for (const PlannedPose& pose : poses) {
        if (!pose.is_blocked) continue;
        throw InputError("the way to pose " + quote(pose.id) +
                         " is BLOCKED; plan again with more room, or without it: `dropped`");
    }
}

/// The configuration on the grid. `find` says what is wrong with one.
VectorXd send(const Grid& grid, const std::string& what, const VectorXd& q,
              const std::function<std::string(const VectorXd&)>& find) {
    const VectorXd nearest = grid.nearest(q);
    const std::string fault = find(nearest);
    if (fault.empty()) return nearest;
    const std::string planned = find(q);
    if (!planned.empty()) {
        throw InputError(fmt::format(
            "{} {} as it was planned; has the campaign changed since? Must be planned again with "
            "it, or sent with the campaign as it was",
            what, planned));
    }
    const auto other = grid.nearest_of(q, [&](const VectorXd& one) { return find(one).empty(); });
    if (other) return *other;
    throw InputError(fmt::format(
        "{} is right, but no joint values next to it are in the program's digits: rounded it {}; "
        "must be off its limit; plan again without it: `dropped`, or with margin_deg where it is a "
        "joint's",
        what, fault));
}

VectorXd send_via(const Grid& grid, const Constraints& constraints, const VectorXd& via,
                  const std::string& id) {
    return send(grid, "the via before pose " + quote(id), via,
                [&](const VectorXd& q) { return describe_violation(constraints, q, Stop::Via); });
}

void send_all(std::vector<PlannedPose>& poses, const Constraints& constraints, const Grid& grid) {
    for (PlannedPose& pose : poses) {
        pose.configuration = send(
            grid, "pose " + quote(pose.id), pose.configuration,
            [&](const VectorXd& q) { return find_fault_of_pose(constraints, q, pose.targets); });
        if (pose.clearance) pose.clearance = constraints.nearest(pose.configuration);
        if (pose.via) pose.via = send_via(grid, constraints, *pose.via, pose.id);
    }
}

Constraints constraints_of(const Campaign& campaign) { return {campaign, campaign.cell, false}; }

RoundingLoss compare_joints(const Plan& plan, const Plan& sent, const Campaign& campaign) {
    RoundingLoss loss;
    loss.criterion = plan.request.criterion;
    for (const PlannedPose& pose : sent.poses) {
        const auto planned = std::ranges::find(plan.poses, pose.id, &PlannedPose::id);
        const VectorXd change = (pose.configuration - planned->configuration).cwiseAbs();
        for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
            double& largest = campaign.robot.joint(j).motion == Motion::Rotation
                                  ? loss.largest_turn
                                  : loss.largest_slide;
            largest = std::max(largest, change[j]);
        }
    }
    return loss;
}

/// For moves: rounding may cost the room of one that is as near as allowed, far less than this.
Constraints moving_constraints_of(const Campaign& campaign) {
    constexpr double room = 1e-4;  // m
    Cell cell = campaign.cell;
    cell.safety_distance = std::max(0.0, cell.safety_distance - room);
    return {campaign, cell, false};
}

std::string name_of(const RouteStop& stop) {
    if (stop.kind == RouteStop::Kind::Pose) return "pose " + quote(stop.id);
    if (stop.kind == RouteStop::Kind::Home) return "home";
    return stop.id.empty() ? "a via" : "via " + quote(stop.id);
}

/// A way that a program takes, one stop after another.
class Route {
  public:
    Route(const Campaign& campaign, const Constraints& constraints, const Grid& grid)
        : constraints_(constraints), grid_(grid), moving_(moving_constraints_of(campaign)) {}

    /// Throws InputError for a move to the stop that is not free.
    void go(RouteStop stop) {
        if (!stops_.empty()) {
            const RouteStop& last = stops_.back();
            if (!detail::is_move_free(moving_, last.configuration, stop.configuration)) {
                throw InputError(
                    fmt::format("the way from {} to {} is not free; plan again with plan",
                                name_of(last), name_of(stop)));
            }
        }
        stops_.push_back(std::move(stop));
    }

    /// Straight, or around if that is not free.
    void reach(const RouteStop& stop) {
        const bool is_free =
            stops_.empty() ||
            detail::is_move_free(moving_, stops_.back().configuration, stop.configuration);
        if (is_free) {
            go(stop);
        } else {
            go_around(stop);
        }
    }

    /// By the shortest way that is found.
    void go_around(const RouteStop& stop) {
        detail::TourOptions options;
        options.start = stops_.back().configuration;
        RowMatrixXd to(1, stop.configuration.size());
        to.row(0) = stop.configuration.transpose();
        const Tour tour = detail::plan_tour(constraints_, to, options);
        if (tour.visits[0].is_blocked) {
            throw InputError(fmt::format("no free way was found from {} to {}; state another home",
                                         name_of(stops_.back()), name_of(stop)));
        }
        if (tour.visits[0].via) {
            const VectorXd via = send(
                grid_, "the via back", *tour.visits[0].via,
                [&](const VectorXd& q) { return describe_violation(constraints_, q, Stop::Via); });
            go({RouteStop::Kind::Via, "", 1, via});
        }
        go(stop);
    }

    const std::vector<RouteStop>& stops() const { return stops_; }

  private:
    const Constraints& constraints_;
    const Grid& grid_;
    Constraints moving_;
    std::vector<RouteStop> stops_;
};

/// Choices are in no order that a robot could follow, and their ways were never looked at.
void order_choice(Plan& sent, const Constraints& constraints, const Grid& grid) {
    detail::TourOptions options;
    options.order.seed = sent.request.seed.value_or(1);
    const Tour tour = detail::plan_tour(
        constraints, detail::configurations_of(sent.poses, sent.poses[0].configuration.size()),
        options);
    std::vector<PlannedPose> ordered;
    for (const Visit& visit : tour.visits) {
        PlannedPose& pose = ordered.emplace_back(sent.poses[static_cast<std::size_t>(visit.pose)]);
        pose.is_blocked = visit.is_blocked;
        if (visit.via) pose.via = send_via(grid, constraints, *visit.via, pose.id);
    }
    sent.poses = ordered;
}

}  // namespace

Plan sent_plan(const Plan& plan, const Campaign& campaign, const ControllerJoints& controller,
               const VectorXd& steps) {
    check_sendable(plan, campaign, controller);
    check_ways(plan.poses);
    check_ways(plan.verification);
    const Constraints constraints = constraints_of(campaign);
    const Grid grid(controller, steps);
    Plan sent = plan;
    send_all(sent.poses, constraints, grid);
    send_all(sent.verification, constraints, grid);
    if (sent.is_continuous()) return sent;
    order_choice(sent, constraints, grid);
    check_ways(sent.poses);
    return sent;
}

VectorXd rounded_within_limits(const VectorXd& configuration, const Campaign& campaign,
                               const ControllerJoints& controller, const VectorXd& steps) {
    Cell cell;
    cell.joint_sums = campaign.cell.joint_sums;
    const Constraints limits(campaign, cell, false);
    const auto clearance = [&](const VectorXd& q) {
        double least = limits.sum_clearance(q);
        for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
            const Joint& joint = campaign.robot.joint(j);
            least = std::min({least, q[j] - joint.lower, joint.upper - q[j]});
        }
        return least;
    };
    constexpr double noise = 1e-13;  // of the ways to the controller's joints and back, rad or m
    const double allowed = std::min(0.0, clearance(configuration)) - noise;
    const Grid grid(controller, steps);
    const auto rounded =
        grid.nearest_of(configuration, [&](const VectorXd& q) { return clearance(q) >= allowed; });
    return rounded.value_or(grid.nearest(configuration));
}

Plan with_revisits(const Plan& sent, const std::string& id, Index every) {
    const auto reference = std::ranges::find(sent.poses, id, &PlannedPose::id);
    if (reference == sent.poses.end()) {
        throw InputError("has no pose to calibrate with called " + quote(id));
    }
    Plan plan = sent;
    plan.poses.clear();
    Index visits = 0;
    Index others = 0;
    bool is_after_visit = false;
    const auto visit = [&] {
        PlannedPose& again = plan.poses.emplace_back(*reference);
        again.id = fmt::format("ref{}", ++visits);
        again.via.reset();
        others = 0;
        is_after_visit = true;
    };
    for (const PlannedPose& pose : sent.poses) {
        PlannedPose& own = plan.poses.emplace_back(pose);
        if (is_after_visit) own.via.reset();
        is_after_visit = false;
        const bool is_reference = pose.id == id;
        others = is_reference ? 0 : others + 1;
        const bool is_last = &pose == &sent.poses.back();
        if (!is_reference && (others == every || is_last)) visit();
    }
    if (is_after_visit && !plan.verification.empty()) plan.verification.front().via.reset();
    for (Index k = 1; k <= visits; ++k) {
        const std::string name = fmt::format("ref{}", k);
        const auto is_called_so = [&](const PlannedPose& pose) { return pose.id == name; };
        if (std::ranges::any_of(sent.poses, is_called_so) ||
            std::ranges::any_of(sent.verification, is_called_so)) {
            throw InputError(
                "has a pose called " + quote(name) +
                ", as a visit of the reference pose would be; must be called otherwise");
        }
    }
    return plan;
}

RoundingLoss rounding_loss(const Plan& plan, const Plan& sent, const Campaign& campaign,
                           const PlanningOptions& options) {
    detail::PlanningProblem problem = detail::state_planning(campaign, options);
    detail::draw_workspace(problem, options);
    RoundingLoss loss = compare_joints(plan, sent, problem.campaign);
    const auto value_at = [&](const Plan& one, double& value, std::optional<double>& rms) {
        const Blocks blocks = detail::blocks_of(problem, one.poses);
        value = detail::value_of(problem, blocks);
        rms = predict_accuracy(problem.errors.by_parameters,
                               held_information(problem) + information(blocks))
                  .rms;
    };
    value_at(plan, loss.planned, loss.planned_rms);
    value_at(sent, loss.sent, loss.sent_rms);
    return loss;
}

RoundingLoss rounding_loss(const Plan& plan, const Plan& sent, const Campaign& campaign,
                           Candidates candidates, const ChoiceOptions& options) {
    RoundingLoss loss = compare_joints(plan, sent, campaign);
    const auto value_at = [&](const Plan& one) {
        const detail::CandidateIndex index(candidates.ids, detail::ids_of(one.poses));
        for (const PlannedPose& pose : one.poses) {
            candidates.configurations.row(index.find(pose.id, "poses:")) =
                pose.configuration.transpose();
        }
        const detail::ChoiceProblem problem = detail::state_choice(campaign, candidates, options);
        return detail::choice_value(problem.blocks, problem.options,
                                    detail::candidates_of(problem, one.poses));
    };
    loss.planned = value_at(plan);
    loss.sent = value_at(sent);
    return loss;
}

std::vector<RouteStop> route_of(const Plan& sent, const Campaign& campaign,
                                const ControllerJoints& controller, const VectorXd& steps,
                                const RouteOptions& options) {
    using Kind = RouteStop::Kind;
    const Constraints constraints = constraints_of(campaign);
    const Grid grid(controller, steps);
    const bool has_home = campaign.cell.home.size() != 0;
    if (options.is_reversed && !has_home) {
        throw InputError(
            "cell.home_deg is not stated; must be, since a reversed pass begins there");
    }
    Route pass(campaign, constraints, grid);
    if (has_home) {
        const VectorXd home = send(grid, "home", campaign.cell.home, [&](const VectorXd& q) {
            return describe_violation(constraints, q, Stop::Home);
        });
        pass.go({Kind::Home, "", 1, home});
    }
    const Index repeats = std::max<Index>(1, std::lround(sent.request.repeats));
    for (const auto* poses : {&sent.poses, &sent.verification}) {
        for (const PlannedPose& pose : *poses) {
            if (pose.via) pass.go({Kind::Via, "", 1, *pose.via});
            const RouteStop stop{Kind::Pose, pose.id, repeats * pose.times, pose.configuration};
            if (options.finds_ways) {
                pass.reach(stop);
            } else {
                pass.go(stop);
            }
        }
    }
    const RouteStop first = pass.stops().front();
    if (has_home || options.repeats > 1) pass.go_around(first);
    const std::vector<RouteStop>& stops = pass.stops();
    std::vector<RouteStop> route;
    for (Index k = 0; k < options.repeats; ++k) {
        // A pass ends where the next begins.
        const auto begin = static_cast<std::ptrdiff_t>(k == 0 ? 0 : 1);
        if (options.is_reversed && k % 2 == 1) {
            route.insert(route.end(), stops.rbegin() + begin, stops.rend());
        } else {
            route.insert(route.end(), stops.begin() + begin, stops.end());
        }
    }
    if (!has_home && options.repeats > 1) {  // not back to the first pose once more
        route.pop_back();
        while (route.back().kind == Kind::Via) route.pop_back();
    }
    return route;
}

std::vector<std::string> find_faults(const std::vector<RouteStop>& route, const Campaign& campaign,
                                     const std::optional<Plan>& sent) {
    using Kind = RouteStop::Kind;
    const Constraints constraints = constraints_of(campaign);
    const Constraints moving = moving_constraints_of(campaign);
    std::map<std::string, std::vector<Index>> targets;
    if (sent) {
        for (const auto* poses : {&sent->poses, &sent->verification}) {
            for (const PlannedPose& pose : *poses) targets[pose.id] = pose.targets;
        }
    }
    const auto find = [&](const RouteStop& stop) {
        const VectorXd& q = stop.configuration;
        if (stop.kind == Kind::Home) return describe_violation(constraints, q, Stop::Home);
        if (stop.kind == Kind::Via) return describe_violation(constraints, q, Stop::Via);
        return find_fault_of_pose(constraints, q, targets[stop.id]);
    };
    std::vector<std::string> faults;
    const auto note = [&](const std::string& fault) {
        if (std::ranges::find(faults, fault) == faults.end()) faults.push_back(fault);
    };
    const RouteStop* last = nullptr;
    for (const RouteStop& stop : route) {
        const std::string fault = find(stop);
        if (!fault.empty()) note(name_of(stop) + ' ' + fault);
        if (last != nullptr && fault.empty() &&
            !detail::is_move_free(moving, last->configuration, stop.configuration)) {
            note(fmt::format("the way from {} to {} is not free", name_of(*last), name_of(stop)));
        }
        last = fault.empty() ? &stop : nullptr;  // whose fault a move is there is said
    }
    return faults;
}

}  // namespace posewise
