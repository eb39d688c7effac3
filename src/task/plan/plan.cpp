#include "posewise/task/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "core/text.hpp"
#include "measurement/noise.hpp"
#include "planning_problem.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/campaign.hpp"
#include "task/doubt/same_pose.hpp"

namespace posewise {
namespace {

bool turns(const Chain& robot, Index joint) {
    return robot.joint(joint).motion == Motion::Rotation;
}

const std::string& joint_name(const Chain& robot, Index joint) { return robot.joint(joint).name; }

/// A name as part of a place that has slashes (a JSON pointer).
std::string escape_slashes(const std::string& name) {
    std::string escaped;
    for (const char c : name) {
        escaped += c == '~' ? std::string("~0") : c == '/' ? std::string("~1") : std::string(1, c);
    }
    return escaped;
}

/// "poses[2].joints.q1_rad: is missing; ..." for the first pose that differs; empty if none does.
std::string describe_columns(const Plan& plan, const std::vector<std::string>& wanted) {
    const std::set<std::string> there(plan.columns.begin(), plan.columns.end());
    for (const std::string& column : wanted) {
        if (there.count(column) > 0) continue;
        return "poses[0].joints." + column + ": is missing; must be there as posewise writes it";
    }
    if (plan.columns == wanted) return "";
    if (plan.columns.size() == wanted.size()) {
        return "poses[0].joints: are in another order than those of the campaign's robot";
    }
    return fmt::format("poses[0].joints: has {}, the campaign's robot has {}",
                       detail::count_of(std::ssize(plan.columns), "joint"), wanted.size());
}

/// The measured configuration of that id, if there is one. Throws InputError if it has other joint
/// values: a plan of another robot or campaign may well have the same ids.
std::optional<Index> find_measured(const Plan& plan, const PlannedPose& pose,
                                   const Campaign& campaign, const Measurements& measured) {
    const auto found = std::ranges::find(measured.ids, pose.id);
    if (found == measured.ids.end()) return std::nullopt;
    const Index index = found - measured.ids.begin();
    if (plan.kind == CandidateKind::Blocks) return index;
    // What was guided to a contact by hand differs from the plan.
    const double tolerance = campaign.sensor->has_contacts() ? 0.2 : detail::same_pose_tolerance;
    if (detail::is_same_pose(pose.configuration, measured.configurations.row(index).transpose(),
                             tolerance)) {
        return index;
    }
    const VectorXd q = measured.configurations.row(index).transpose();
    Index joint = 0;
    const Index joints = campaign.robot.joint_count();
    (pose.configuration - q).head(joints).cwiseAbs().maxCoeff(&joint);
    const bool is_angle = campaign.robot.joint(joint).motion == Motion::Rotation;
    const auto value = [&](double x) { return is_angle ? to_degrees(x) : mm_per_m * x; };
    throw InputError(fmt::format(
        "configuration {} is planned with {} = {:.4f} {}, measured with {:.4f}; must be within "
        "{:.2f}: the plan must be of this robot and campaign, and a pose that was missed be left "
        "out",
        detail::quote(pose.id), campaign.robot.joint(joint).name, value(pose.configuration[joint]),
        is_angle ? "deg" : "mm", value(q[joint]), value(tolerance)));
}

/// Throws InputError unless a plan has as many poses as it is of, with the robot's joints.
void check_is_whole(const Plan& plan, const Campaign& campaign) {
    Index count = 0;
    for (const PlannedPose& pose : plan.poses) count += pose.times;
    if (count != plan.request.pose_count) {
        throw InputError(
            fmt::format("problem.pose_count: is {}, the plan has {}; must be the plan "
                        "as posewise wrote it",
                        plan.request.pose_count, detail::count_of(count, "pose")));
    }
    if (plan.kind == CandidateKind::Blocks) return;
    const std::string fault = describe_columns(plan, configuration_columns(campaign));
    if (!fault.empty()) throw InputError(fault);
}

}  // namespace

void complete(PlanRequest& request, Criterion usual, std::uint64_t seed) {
    if (request.focus != Focus::All && usual == Criterion::V) usual = Criterion::D;
    request.criterion = request.criterion.value_or(usual);
    request.seed = request.seed.value_or(seed);
}

std::optional<double> assumed_model_error(const Plan& plan) {
    for (const NamedNumber& one : plan.assumptions) {
        if (one.name == "model_error_m") return one.value;
    }
    return std::nullopt;
}

std::vector<std::string> configuration_columns(const Campaign& campaign) {
    const Chain& robot = campaign.robot;
    std::vector<std::string> columns;
    for (Index j = 0; j < robot.joint_count(); ++j) {
        columns.push_back(detail::with_unit(joint_name(robot, j), units_of(turns(robot, j))));
    }
    for (const MeasuredTorque& torque : robot.torques()) {
        columns.push_back("tau_" + joint_name(robot, torque.joint) + "_Nm");
    }
    return columns;
}

std::vector<NamedNumber> assumptions_of(const Campaign& campaign) {
    std::vector<NamedNumber> numbers;
    const auto add = [&numbers](const std::string& name, double value) {
        NamedNumber& number = numbers.emplace_back();
        number.name = name;
        number.value = value;
    };
    for (const NoiseNumber& noise : campaign.sensor->noise_numbers()) {
        for (std::size_t i = 0; i < noise.values.size(); ++i) {
            const std::string place = noise.values.size() > 1 ? fmt::format("/{}", i) : "";
            add(noise.name + place, noise.values[i]);
        }
    }
    if (campaign.sensor->has_angles()) {
        add("model_error_orientation_rad", campaign.model_error_orientation);
    }
    add("model_error_m", campaign.model_error);
    if (const double common = detail::common_part(campaign); common > 0) {
        add("model_error_common", common);
    }
    for (Index j = 0; j < campaign.joint_repeatability.size(); ++j) {
        add("joint_repeatability/" +
                escape_slashes(detail::with_unit(joint_name(campaign.robot, j),
                                                 units_of(turns(campaign.robot, j)))),
            campaign.joint_repeatability[j]);
    }
    const auto units = parameter_units(campaign);
    const VectorXd scale = parameter_scale(campaign);
    Index k = 0;
    for (const std::string& name : parameter_names(campaign)) {
        const AmountUnits& unit = *units[static_cast<std::size_t>(k)];
        add("expected_error/" + escape_slashes(detail::with_unit(name, unit)), scale[k++]);
    }
    return numbers;
}

std::string describe_mismatch(const Plan& plan, const Campaign& campaign) {
    if (plan.campaign != campaign.name) {
        return fmt::format("campaign: is {}; must be a plan of {}", detail::quote(plan.campaign),
                           detail::quote(campaign.name));
    }
    const std::string columns = describe_columns(plan, configuration_columns(campaign));
    if (!columns.empty()) return columns;
    const Index targets = campaign.sensor->target_count();
    for (std::size_t i = 0; i < plan.poses.size(); ++i) {
        const std::vector<Index>& seen = plan.poses[i].targets;
        for (std::size_t k = 0; k < seen.size(); ++k) {
            if (seen[k] < targets) continue;
            return fmt::format("poses[{}].visible_targets[{}]: is {}, the campaign has {}", i, k,
                               seen[k] + 1, detail::count_of(targets, "target"));
        }
    }
    return "";
}

std::vector<Index> find_planned(const Plan& plan, const Campaign& campaign,
                                const Measurements& measured,
                                const std::vector<std::string>& excluded) {
    check_is_whole(plan, campaign);
    std::vector<Index> planned;
    for (const PlannedPose& pose : plan.poses) {
        if (std::ranges::find(excluded, pose.id) != excluded.end()) continue;
        const auto found = find_measured(plan, pose, campaign, measured);
        if (!found) {
            throw InputError("configuration '" + pose.id +
                             "' of the plan is not among the measured ones");
        }
        planned.push_back(*found);
    }
    if (planned.empty()) throw InputError("all poses of the plan are excluded");
    return planned;
}

std::vector<Index> find_verification(const Plan& plan, const Campaign& campaign,
                                     const Measurements& measured,
                                     const std::vector<std::string>& excluded) {
    std::vector<Index> found;
    for (const PlannedPose& pose : plan.verification) {
        if (std::ranges::find(excluded, pose.id) != excluded.end()) continue;
        if (const auto one = find_measured(plan, pose, campaign, measured)) found.push_back(*one);
    }
    return found;
}

}  // namespace posewise
