#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "joint_directions.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/text.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/atomic_file.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/urdf_file.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/model/complete_model.hpp"
#include "posewise/model/error_terms.hpp"
#include "robot_tables.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise inspect campaign.yaml
  posewise inspect robot.urdf --base base_link --tip tool0 --write-campaign campaign.yaml

Prints the robot's elements from base to flange, the joints with their limits and axes, and every
parameter a calibration would identify (base, robot's errors, targets). One that no measurement can
tell from the others is marked "no", with the errors that do exactly the same, for example
  Tx2  mm  1  no  1 mm Tx2 = 1 mm Tx1 - 0.7813 mrad dq2
A campaign that states such a parameter is singular: drop it. A campaign that states no parameters
has the complete model (every error a rigid link can have), less those marked "no". The last lines
compare with the formula for what is identifiable; a stated set that spans less leaves errors of the
real robot uncorrected. A warning tells where there is no clear gap between what is identifiable and
what is not, as of harmonics of high order on a joint that turns little.

With --measurements the directions of the joints are checked, too: the robot is registered (base and
targets fitted, nothing else) with every choice of joints reversed. The right one misses the points by
what the robot's errors are, any other by far more.

A robot can be inspected before there is a campaign, straight from its URDF; --write-campaign then
makes a file to begin with, which says what is left to fill in.)";

struct Arguments {
    std::string file;  ///< campaign or URDF
    std::string base_link;
    std::string tip_link;
    std::string written;
    std::string measurements;
};

/// "1 mm Tx2 = 1 mm Tx1 - 0.78 mrad dq2". Both units are a thousandth of SI, so coefficients stay.
std::string format_absorbed(const DroppedParameter& dropped, const std::vector<std::string>& names,
                            const std::vector<bool>& is_angle) {
    const auto unit = [&](Index k) {
        return units_of(is_angle[static_cast<std::size_t>(k)]).error;
    };
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
        table.rows.push_back({names[k], std::string(units_of(is_angle[k]).error),
                              format_short(mm_per_m * scale[index]), kept ? "yes" : "no",
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
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        revolute += campaign.robot.joint(j).motion == Motion::Rotation ? 1 : 0;
    }
    const Index prismatic = campaign.robot.joint_count() - revolute;
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
                            joint.name, format_short(compliance.largest, 4),
                            units_of(joint.motion).load);
    }
    return text.empty() ? "" : text + ", about the largest that occur\n";
}

/// The campaign with every error a rigid link can have.
Campaign with_complete_model(const io::CampaignFile& file) {
    return with_robot(file, complete_model(file.declared_robot));
}

std::string describe_complete(const Campaign& complete, std::size_t rank) {
    return fmt::format("complete model: {} of its {} parameters are identifiable{}\n", rank,
                       parameter_count(complete), describe_formula(complete));
}

/// Not with a prior: that holds what the poses hardly tell.
void warn_about_gap(const std::string& path, const Campaign& campaign,
                    const Identifiability& found) {
    if (campaign.spread.is_prior || has_clear_gap(found)) return;
    const auto names = parameter_names(campaign);
    std::vector<std::string> weakest;
    for (const Index k : weakest_kept(campaign, found)) {
        weakest.push_back(names[static_cast<std::size_t>(k)]);
    }
    print_warning(fmt::format(
        "{}: no gap between what is identifiable and what is not: of columns of norm 1 those "
        "before leave {} of one that is kept and {} of one that is dropped; the weakest direction "
        "kept is of {}: state fewer terms (orders of harmonics), a larger range of their joints, "
        "or prior: true",
        path, format_short(found.least_kept_residual, 2),
        format_short(found.largest_dropped_residual, 2), fmt::join(weakest, ", ")));
}

void print_stated(const io::CampaignFile& file) {
    const Campaign& campaign = file;
    const Identifiability stated = find_identifiable(campaign);
    const Campaign complete = with_complete_model(file);
    const std::size_t rank = stated.kept.size();
    const std::size_t complete_rank = find_identifiable(complete).kept.size();
    print_section("Parameters", parameter_table(campaign, stated));
    print(fmt::format("\nstated set: rank {} of {} parameters{}\n", rank, parameter_count(campaign),
                      stated.dropped.empty() ? "" : ": rank deficient, drop those marked no"));
    print(describe_complete(complete, complete_rank));
    warn_about_gap(file.path, campaign, stated);
    print(rank < complete_rank
              ? fmt::format("The stated set spans only {} of these {} directions: errors of the "
                            "robot in the other {} stay uncorrected.\n",
                            rank, complete_rank, complete_rank - rank)
              : "The stated set spans them all.\n");
}

void print_reduced(const io::CampaignFile& file) {
    const Campaign complete = with_complete_model(file);
    const Identifiability found = find_identifiable(complete);
    print_section("Parameters of the complete model", parameter_table(complete, found));
    print('\n' + describe_complete(complete, found.kept.size()));
    print(
        fmt::format("Of a column of norm 1, those before leave at least {} of one that is kept, "
                    "at most {} of one that is dropped.\n",
                    format_short(found.least_kept_residual, 2),
                    format_short(found.largest_dropped_residual, 2)));
    warn_about_gap(file.path, complete, found);
}

void print_campaign(const io::CampaignFile& file) {
    const Campaign& campaign = file;
    print(fmt::format("{}\nsensor: {}; model error {}\n", campaign.name,
                      campaign.sensor->words().sentence, describe_model_error(campaign)));
    if (file.urdf) {
        print(fmt::format("robot: {}, from base link {} to tip link {}\n",
                          escape_controls(file.urdf->path), quote(file.urdf->base_link),
                          quote(file.urdf->tip_link)));
    }
    print_section("Elements, base to flange", element_table(campaign.robot));
    print_section("Joint limits", joint_table(campaign.robot));
    print_section("Axes in the base frame, all joints at zero", axis_table(campaign.robot));
    print("\nflange at zero: " + describe_flange_at_zero(campaign.robot) + '\n');
    if (file.error_model == io::ErrorModel::Complete) {
        print_reduced(file);
    } else {
        print_stated(file);
    }
    print(describe_compliances(campaign.robot));
    print(fmt::format("least number of poses: {}\n", least_pose_count(campaign)));
}

bool is_urdf(const Arguments& arguments) {
    return !arguments.base_link.empty() || !arguments.tip_link.empty() ||
           !arguments.written.empty() || arguments.file.ends_with(".urdf");
}

/// The campaign that --write-campaign would write.
void inspect_urdf(const Arguments& arguments) {
    const std::string& urdf = arguments.file;
    if (!arguments.measurements.empty()) {
        throw input_error_at({urdf}, "is a robot alone; --measurements needs a campaign file");
    }
    const std::string& written = arguments.written;
    check_outputs({urdf}, {written});
    if (std::filesystem::exists(written)) {
        throw input_error_at({written}, "exists already; must be a new file");
    }
    const io::UrdfRobot robot = io::read_urdf({urdf, arguments.base_link, arguments.tip_link});
    const std::string path = written.empty() ? urdf : written;
    const std::string text = io::make_campaign_text(robot, path);
    const io::CampaignFile file = io::parse_campaign(text, path);
    if (!written.empty()) io::write_file(written, text);
    print_campaign(file);
    if (!written.empty()) {
        print(fmt::format("\nThe campaign is in {}; fill in what is marked there.\n",
                          escape_controls(written)));
    }
}

void inspect(const Arguments& arguments) {
    if (is_urdf(arguments)) return inspect_urdf(arguments);
    const io::CampaignFile file = io::read_campaign(arguments.file);
    std::vector<SignPattern> patterns;
    if (!arguments.measurements.empty()) {
        const Measurements measurements = io::read_measurements(arguments.measurements, file);
        patterns = compute_from(arguments.measurements,
                                [&] { return fit_joint_signs(file, measurements); });
    }
    print_campaign(file);
    if (!patterns.empty()) print_joint_directions(file, patterns);
}

}  // namespace

void add_inspect(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command =
        program.add_subcommand("inspect", "Show the robot, and which of its errors can be found");
    command
        ->add_option("CAMPAIGN", arguments->file, "Campaign file (YAML), or a robot alone (URDF)")
        ->required()
        ->check(file_name());
    command
        ->add_option("--base", arguments->base_link,
                     "URDF: link the robot begins at (default: the root)")
        ->check(file_name());
    command
        ->add_option("--tip", arguments->tip_link,
                     "URDF: link that carries the targets (default: the only leaf)")
        ->check(file_name());
    command
        ->add_option("--write-campaign", arguments->written,
                     "URDF: write a campaign file to begin with")
        ->check(file_name());
    command
        ->add_option("-m,--measurements", arguments->measurements,
                     "Measured configurations (CSV, or MATLAB .mat): check the joints' directions")
        ->check(file_name());
    command->footer(footer);
    command->callback([arguments] { inspect(*arguments); });
}

}  // namespace posewise::cli
