#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <map>

#include "core/format.hpp"
#include "core/text.hpp"
#include "error_classes.hpp"
#include "posewise/core/types.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/report/reports.hpp"
#include "robot_tables.hpp"
#include "table.hpp"

namespace posewise {
namespace {

/// "1 mm Tx2 = 1 mm Tx1 - 0.78 mrad dq2". Both units are a thousandth of SI, so coefficients stay.
std::string format_absorbed(const DroppedParameter& dropped, const std::vector<std::string>& names,
                            const std::vector<const AmountUnits*>& units) {
    const auto unit = [&](Index k) { return units[static_cast<std::size_t>(k)]->error; };
    const auto name = [&](Index k) { return names[static_cast<std::size_t>(k)]; };
    if (dropped.absorbed_by.empty()) return "moves no target";
    std::string text;
    for (const ParameterTerm& term : dropped.absorbed_by) {
        const bool negative = term.coefficient < 0;
        text += text.empty() ? (negative ? "-" : "") : (negative ? " - " : " + ");
        text += fmt::format("{} {} {}", detail::format_short(std::abs(term.coefficient), 4),
                            unit(term.parameter), name(term.parameter));
    }
    return fmt::format("1 {} {} = {}", unit(dropped.parameter), name(dropped.parameter), text);
}

detail::Table parameter_table(const Campaign& campaign, const Identifiability& identifiability) {
    const auto names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    const VectorXd scale = parameter_scale(campaign);
    std::map<Index, std::string> absorbed;
    for (const DroppedParameter& dropped : identifiability.dropped) {
        absorbed[dropped.parameter] = format_absorbed(dropped, names, units);
    }
    detail::Table table{{"parameter", "unit", "expected error", "identifiable", "absorbed by"}, {}};
    for (std::size_t k = 0; k < names.size(); ++k) {
        const auto index = static_cast<Index>(k);
        const bool kept = absorbed.count(index) == 0;
        table.rows.push_back({names[k], std::string(units[k]->error),
                              detail::format_short(mm_per_m * scale[index]), kept ? "yes" : "no",
                              kept ? "" : absorbed[index]});
    }
    return table;
}

/// "3n" with as many targets, all unknown, or "6" for an unknown tool: the cases formulas count.
/// Empty for others.
std::pair<std::string, Index> count_unknowns(const Campaign& campaign) {
    if (base_parameter_count(campaign) < 6) return {};
    const Sensor& sensor = *campaign.sensor;
    const auto unknowns = static_cast<Index>(sensor.unknown_names().size());
    if (sensor.has_orientation() && unknowns == 6) return {"6", 6};
    if (!sensor.observes_targets() || unknowns < 3 * sensor.target_count()) return {};
    return {"3n", unknowns};
}

std::string describe_formula(const Campaign& campaign) {
    const auto [letters, unknowns] = count_unknowns(campaign);
    if (unknowns == 0) return "";
    Index revolute = 0;
    Index prismatic = 0;
    for (const Element& element : campaign.robot.elements()) {
        if (element.joints.empty() || element.parameter.empty()) continue;
        ++(element.motion == Motion::Rotation ? revolute : prismatic);
    }
    Index terms = 0;
    for (Index k = 0; k < campaign.robot.parameter_count(); ++k) {
        terms += campaign.robot.parameter_term(k) != nullptr ? 1 : 0;
    }
    const std::string own = letters == "3n" ? fmt::format("3*{}", unknowns / 3) : letters;
    return fmt::format("; by the formula 4R + 2P + {}{} = 4*{} + 2*{} + {}{} = {}", letters,
                       terms > 0 ? " + terms" : "", revolute, prismatic, own,
                       terms > 0 ? fmt::format(" + {}", terms) : "",
                       4 * revolute + 2 * prismatic + unknowns + terms);
}

/// What the parameters of compliances are measured at; empty if there are none.
std::string describe_compliances(const Chain& robot) {
    std::string text;
    for (const Compliance& compliance : compliances(robot)) {
        const Joint& joint = robot.joint(compliance.joint);
        text += fmt::format("{}{} {} {}", text.empty() ? "compliances are stated at " : ", ",
                            joint.name, detail::format_short(compliance.largest, 4),
                            units_of(joint.motion).load);
    }
    return text.empty() ? "" : text + ", about the largest that occur\n";
}

std::string describe_complete(const Inspection& inspection) {
    return fmt::format("complete model: {} of its {} parameters are identifiable{}\n",
                       inspection.of_complete.kept.size(), parameter_count(inspection.complete),
                       describe_formula(inspection.complete));
}

std::string format_stated(const Inspection& inspection, const Identifiability& stated) {
    const Campaign& campaign = inspection.campaign;
    const std::size_t rank = stated.kept.size();
    const std::size_t complete_rank = inspection.of_complete.kept.size();
    return format_section("Parameters", parameter_table(campaign, stated)) +
           fmt::format("\nstated set: rank {} of {} parameters{}\n", rank,
                       parameter_count(campaign),
                       stated.dropped.empty() ? "" : ": rank deficient, drop those marked no") +
           describe_complete(inspection) +
           (rank < complete_rank
                ? fmt::format("The stated set spans only {} of these {} directions: errors of the "
                              "robot in the other {} stay uncorrected.\n",
                              rank, complete_rank, complete_rank - rank)
                : "The stated set spans them all.\n");
}

std::string format_reduced(const Inspection& inspection) {
    const Identifiability& found = inspection.of_complete;
    return format_section("Parameters of the complete model",
                          parameter_table(inspection.complete, found)) +
           '\n' + describe_complete(inspection) +
           fmt::format(
               "Of a column of norm 1, those before leave at least {} of one that is kept, "
               "at most {} of one that is dropped.\n",
               detail::format_short(found.least_kept_residual, 2),
               detail::format_short(found.largest_dropped_residual, 2));
}

/// All errors of the robot, where priors let a calibration find more than poses tell apart.
std::string format_calibrated(const Campaign& campaign) {
    const Index count = campaign.robot.parameter_count();
    if (!campaign.spread.is_prior || count == 0) return "";
    return format_section("Errors of the robot that are calibrated, by class",
                          detail::expected_class_table(campaign)) +
           fmt::format(
               "\ncalibrated: {} of the robot, {} with base and sensor; their priors keep "
               "apart what poses cannot\n",
               detail::count_of(count, "error"),
               detail::count_of(parameter_count(campaign), "parameter"));
}

/// Of the parameters stated, or of the complete model.
const Identifiability& identifiability_of(const Inspection& inspection) {
    return inspection.stated ? *inspection.stated : inspection.of_complete;
}

/// Says which of base and sensor no number of poses tells; nothing can be calibrated beside them.
std::string describe_unknowable(const Inspection& inspection) {
    const std::vector<std::string>& parameters = inspection.unknowable.parameters;
    if (parameters.empty()) return "";
    return fmt::format(
        "No number of poses tells {}; calibrate needs what is known stated: {}\nEnough is {}.\n",
        detail::list_words(parameters),
        detail::list_words(inspection.campaign.sensor->words().known),
        describe_cures(inspection.unknowable, inspection.campaign));
}

std::string on_axis_lines(const std::vector<OnAxis>& on_axis) {
    std::string text;
    for (const OnAxis& one : on_axis) text += describe(one) + '\n';
    return text;
}

std::string describe_rounded(Index count) {
    if (count == 0) return "";
    return fmt::format("{} of the robot within 1e-6 rad of a multiple of 90 deg taken as that\n",
                       count == 1 ? "1 angle" : fmt::format("{} angles", count));
}

}  // namespace

std::string describe_narrow_limits(const Campaign& campaign, const std::vector<Index>& joints) {
    std::string text;
    for (const Index j : joints) {
        const Joint& joint = campaign.robot.joint(j);
        text += fmt::format("{}{} ({:g} to {:g} deg)", text.empty() ? "" : ", ", joint.name,
                            to_degrees(joint.lower), to_degrees(joint.upper));
    }
    if (text.empty()) return "";
    return "limits of " + text + " are far narrower than those of the others: are they in rad?";
}

std::string describe(const OnAxis& on_axis) {
    return fmt::format(
        "target {} lies on the axis of {}, which does not move it: no pose tells that joint's "
        "zero, "
        "nor what turns the target about itself; place it beside the axis",
        on_axis.target + 1, on_axis.joint);
}

std::string format_robot(const Chain& robot) {
    return format_section("Elements, base to flange", detail::element_table(robot)) +
           format_section("Joint limits", detail::joint_table(robot)) +
           format_section("Axes in the base frame, all joints at zero", detail::axis_table(robot)) +
           "\nflange at zero: " + detail::describe_flange_at_zero(robot) + '\n';
}

std::string format(const Inspection& inspection) {
    const Chain& robot = inspection.campaign.robot;
    return format_robot(robot) +
           (inspection.stated
                ? format_stated(inspection, *inspection.stated)
                : format_reduced(inspection) + format_calibrated(inspection.campaign)) +
           describe_compliances(robot) + describe_unknowable(inspection) +
           on_axis_lines(inspection.on_axis) + describe_rounded(inspection.rounded_angle_count) +
           fmt::format("least number of poses: {}\n", inspection.least_pose_count);
}

std::string describe_gap(const Inspection& inspection) {
    const std::vector<std::string> weakest = find_doubtful_parameters(inspection);
    if (weakest.empty()) return "";
    const Identifiability& found = identifiability_of(inspection);
    return fmt::format(
        "no gap between what is identifiable and what is not: of columns of norm 1 those before "
        "leave {} of one that is kept and {} of one that is dropped; the weakest direction kept is "
        "of {}: state fewer terms (orders of harmonics), a larger range of their joints, or prior: "
        "true",
        detail::format_short(found.least_kept_residual, 2),
        detail::format_short(found.largest_dropped_residual, 2), fmt::join(weakest, ", "));
}

}  // namespace posewise
