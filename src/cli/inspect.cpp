#include <fmt/format.h>

#include <cmath>
#include <map>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/measurement/point_sensor.hpp"
#include "posewise/model/complete_model.hpp"
#include "posewise/report/units.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise inspect campaign.yaml

Prints the robot's elements from base to flange, the joints' limits, and every parameter a
calibration would identify (base, robot's errors, targets). One that no measurement can tell from
the others is marked "no", with the errors that do exactly the same, for example
  Tx2  mm  1  no  1 mm Tx2 = 1 mm Tx1 - 0.7813 mrad dq2
Such a set makes a calibration singular: drop the parameter. The last lines compare the set with
the complete model (every error a rigid link can have): a set that spans less leaves errors of the
real robot uncorrected.)";

std::string format_terms(const std::vector<JointTerm>& terms, const Chain& robot) {
    std::string text;
    for (const JointTerm& term : terms) {
        const double size = std::abs(term.coefficient);
        if (term.coefficient < 0) {
            text += text.empty() ? "-" : " - ";
        } else if (!text.empty()) {
            text += " + ";
        }
        if (size != 1) text += format_short(size) + ' ';
        text += robot.joints()[static_cast<std::size_t>(term.joint)].name;
    }
    return text;
}

Table element_table(const Chain& robot) {
    Table table{{"no", "transform", "nominal", "", "joint", "error parameter"}, {}};
    for (const Element& element : robot.elements()) {
        const bool turns = element.motion == Motion::Rotation;
        const char axis = "xyz"[static_cast<std::size_t>(element.axis)];
        table.rows.push_back(
            {std::to_string(table.rows.size() + 1), fmt::format("{}{}", turns ? 'R' : 'T', axis),
             format_short(turns ? to_degrees(element.value) : mm_per_m * element.value, 9),
             turns ? "deg" : "mm", format_terms(element.joints, robot), element.parameter});
    }
    return table;
}

Table joint_table(const Chain& robot) {
    Table table{{"joint", "lower", "upper", ""}, {}};
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
        const bool turns = robot.joint_motion(j) == Motion::Rotation;
        const auto limit = [&](double value) {
            return format_short(turns ? to_degrees(value) : mm_per_m * value, 6);
        };
        table.rows.push_back(
            {joint.name, limit(joint.lower), limit(joint.upper), turns ? "deg" : "mm"});
    }
    return table;
}

/// "1 mm Tx2 = 1 mm Tx1 - 0.78 mrad dq2". Both units are a thousandth of SI, so coefficients stay.
std::string format_absorbed(const DroppedParameter& dropped, const std::vector<std::string>& names,
                            const std::vector<bool>& is_angle) {
    const auto unit = [&](Index k) { return error_unit(is_angle[static_cast<std::size_t>(k)]); };
    const auto name = [&](Index k) { return names[static_cast<std::size_t>(k)]; };
    if (dropped.absorbed_by.empty()) return "moves no target";
    std::string text;
    for (const ParameterTerm& term : dropped.absorbed_by) {
        const bool negative = term.coefficient < 0;
        text += text.empty() ? (negative ? "-" : "") : (negative ? " - " : " + ");
        text += fmt::format("{} {} {}", format_short(std::abs(term.coefficient), 4),
                            unit(term.parameter), name(term.parameter));
    }
    return fmt::format("1 {} {} = {}", unit(dropped.parameter), name(dropped.parameter), text);
}

Table parameter_table(const Campaign& campaign, const Identifiability& identifiability) {
    const auto names = parameter_names(campaign);
    const auto is_angle = parameter_is_angle(campaign);
    const VectorXd scale = parameter_scale(campaign);
    std::map<Index, std::string> absorbed;
    for (const DroppedParameter& dropped : identifiability.dropped) {
        absorbed[dropped.parameter] = format_absorbed(dropped, names, is_angle);
    }
    Table table{{"parameter", "unit", "expected error", "identifiable", "absorbed by"}, {}};
    for (std::size_t k = 0; k < names.size(); ++k) {
        const auto index = static_cast<Index>(k);
        const bool kept = absorbed.count(index) == 0;
        table.rows.push_back({names[k], std::string(error_unit(is_angle[k])),
                              format_short(mm_per_m * scale[index]), kept ? "yes" : "no",
                              kept ? "" : absorbed[index]});
    }
    return table;
}

/// Number of targets if all are unknown: the case the formula 4R + 2P + 3n counts.
Index unknown_target_count(const Sensor& sensor) {
    const auto* points = dynamic_cast<const PointSensor*>(&sensor);
    if (points == nullptr) return 0;
    for (Index j = 0; j < points->target_count(); ++j) {
        if (points->is_known(j)) return 0;
    }
    return points->target_count();
}

std::string describe_formula(const Campaign& campaign) {
    const Index targets = unknown_target_count(*campaign.sensor);
    if (targets == 0) return "";
    Index revolute = 0;
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        revolute += campaign.robot.joint_motion(j) == Motion::Rotation ? 1 : 0;
    }
    const Index prismatic = campaign.robot.joint_count() - revolute;
    return fmt::format("; by the formula 4R + 2P + 3n = 4*{} + 2*{} + 3*{} = {}", revolute,
                       prismatic, targets, 4 * revolute + 2 * prismatic + 3 * targets);
}

std::string compare_with_complete(const Campaign& campaign, std::size_t stated_rank) {
    const Campaign complete = with_robot(campaign, complete_model(campaign.robot));
    const std::size_t complete_rank = find_identifiable(complete).kept.size();
    std::string text =
        fmt::format("complete model: {} of its {} parameters are identifiable{}\n", complete_rank,
                    parameter_count(complete), describe_formula(campaign));
    if (stated_rank < complete_rank) {
        text += fmt::format(
            "The stated set spans only {} of these {} directions: errors of the robot in the other "
            "{} stay uncorrected.\n",
            stated_rank, complete_rank, complete_rank - stated_rank);
    } else {
        text += "The stated set spans them all.\n";
    }
    return text;
}

void inspect(const InputPaths& paths) {
    const Campaign campaign = io::read_campaign(paths.campaign).campaign;
    const Identifiability identifiability = find_identifiable(campaign);
    const std::size_t rank = identifiability.kept.size();
    print(fmt::format("{}\nsensor: {}; model error {} mm\n", campaign.name,
                      describe(*campaign.sensor), format_short(mm_per_m * campaign.model_error)));
    print_section("Elements, base to flange", element_table(campaign.robot));
    print_section("Joint limits", joint_table(campaign.robot));
    print_section("Parameters", parameter_table(campaign, identifiability));
    print(fmt::format(
        "\nstated set: rank {} of {} parameters{}\n", rank, parameter_count(campaign),
        identifiability.dropped.empty() ? "" : ": rank deficient, drop those marked no"));
    print(compare_with_complete(campaign, rank));
    print(fmt::format("least number of poses: {}\n", least_pose_count(campaign)));
}

}  // namespace

void add_inspect(CLI::App& program) {
    const auto paths = std::make_shared<InputPaths>();
    CLI::App* command =
        program.add_subcommand("inspect", "Show the robot, and which of its errors can be found");
    add_campaign_argument(*command, *paths);
    command->footer(footer);
    command->callback([paths] { inspect(*paths); });
}

}  // namespace posewise::cli
