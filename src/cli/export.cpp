#include <fmt/format.h>

#include <cmath>
#include <memory>

#include "../core/format.hpp"
#include "../core/text.hpp"
#include "../io/atomic_file.hpp"
#include "commands.hpp"
#include "common.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/dh_file.hpp"
#include "posewise/io/json_reports.hpp"
#include "posewise/io/urdf_file.hpp"
#include "posewise/model/transforms.hpp"

namespace posewise::cli {
namespace {

constexpr const char* export_footer = R"(
Example:
  posewise export campaign.yaml estimate.json --urdf calibrated.urdf
  posewise export campaign.yaml estimate.json --dh calibrated.yaml

The estimate is what calibrate --out wrote. The URDF is the one the campaign's robot comes from, and
stays as it is (names, order, comments, layout) but for the numbers of joint origins: between base
link and tip link it then predicts exactly what the estimate does, but for errors that depend on the
configuration (gravity, harmonics), which a URDF cannot have; they are listed. The base as the instrument sees it
and the targets are not part of the robot, and not of the URDF.

--dh writes any robot as a standard Denavit-Hartenberg table, which moves the flange exactly as the
estimate does, again but for errors that depend on the configuration. Where two axes are nearly
parallel, their common normal lies far away and the row's d is large: such a table is right, but its
numbers must not be rounded, nor compared with the nominal ones.)";

struct ExportArguments {
    std::string campaign;
    std::string estimate;
    std::string urdf;
    std::string dh;
    bool is_forced = false;
};

detail::Table change_table(const io::CalibratedUrdf& urdf) {
    detail::Table table{{"joint", "moved by/mm", "turned by/mrad"}, {}};
    for (const io::OriginChange& change : urdf.changes) {
        table.rows.push_back({detail::escape_controls(change.joint),
                              detail::format_mm(change.translation),
                              detail::format_fixed(mrad_per_rad * change.rotation, 4)});
    }
    return table;
}

std::string describe_base(const Isometry3d& world_from_base) {
    const Vector3d p = world_from_base.translation();
    const Vector3d rpy = rpy_from_rotation(world_from_base.linear());
    return fmt::format("position {} {} {} mm, roll pitch yaw {} {} {} deg",
                       detail::format_mm(p.x()), detail::format_mm(p.y()), detail::format_mm(p.z()),
                       detail::format_fixed(to_degrees(rpy.x()), 5),
                       detail::format_fixed(to_degrees(rpy.y()), 5),
                       detail::format_fixed(to_degrees(rpy.z()), 5));
}

void print_missing(const std::vector<std::string>& names, const char* reason, const char* where) {
    if (names.empty()) return;
    print(fmt::format("not in the {}: ", where));
    for (const std::string& name : names) print(name + ' ');
    print(reason);
}

void print_urdf(const ExportArguments& arguments, const io::CampaignFile& file,
                const Parameters& parameters, const io::CalibratedUrdf& urdf) {
    print(fmt::format("{}: {} with the origins of {} joints changed is in {}\n", file.name,
                      detail::escape_controls(file.urdf->path), urdf.changes.size(),
                      detail::escape_controls(arguments.urdf)));
    print_section("Origins", change_table(urdf));
    print(fmt::format(
        "\nnot in the URDF: where the instrument sees base link {} ({}), and the "
        "targets\n",
        detail::quote(file.urdf->base_link), describe_base(parameters.world_from_base)));
    print_missing(urdf.not_expressed,
                  "act behind the last joint, where no fixed joint is that could take them\n",
                  "URDF");
    print_missing(urdf.terms,
                  "depend on the configuration, and no URDF can express that: without them the "
                  "URDF is less accurate than the estimate\n",
                  "URDF");
}

/// Names of the error terms whose parameters are not zero.
std::vector<std::string> terms_of(const Chain& robot, const VectorXd& parameters) {
    std::vector<std::string> terms;
    const std::vector<std::string> names = robot.parameter_names();
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        if (robot.parameter_term(k) == nullptr || parameters[k] == 0) continue;
        terms.push_back(names[static_cast<std::size_t>(k)]);
    }
    return terms;
}

void print_dh(const ExportArguments& arguments, const io::CampaignFile& file,
              const Parameters& parameters, const io::ExportedRobot& robot) {
    constexpr double far = 10;  // m
    const std::vector<DhRow>& rows = robot.dh;
    print(fmt::format("{}: the calibrated robot in {} rows is in {}\n", file.name, rows.size(),
                      detail::escape_controls(arguments.dh)));
    print("not in the table: where the instrument sees the base (" +
          describe_base(parameters.world_from_base) + "), and the targets\n");
    for (std::size_t k = 0; k < rows.size(); ++k) {
        if (std::abs(rows[k].d) < far) continue;
        print(
            fmt::format("row {}: d is {} m, since its axis and the next are nearly parallel; do "
                        "not round it\n",
                        k + 1, detail::format_short(rows[k].d, 4)));
    }
    print_missing(robot.terms,
                  "depend on the configuration, and no table can express that: without them it is "
                  "less accurate than the estimate\n",
                  "table");
}

void check_urdf(const ExportArguments& arguments, const io::CampaignFile& file,
                const CommonOptions& common) {
    if (!file.urdf) {
        throw input_error_at({arguments.campaign},
                             "has a robot that does not come from a URDF; only such a one can go "
                             "into one (--dh takes any)");
    }
    check_outputs({file.urdf->path}, {arguments.urdf}, common);
}

/// Made and written.
io::ExportedRobot write_robot(const ExportArguments& arguments, const io::CampaignFile& file,
                              const Parameters& parameters) {
    io::ExportedRobot robot{{}, {}, terms_of(file.robot, parameters.robot)};
    if (!arguments.urdf.empty()) {
        robot.urdf = io::make_calibrated_urdf(*file.urdf, file.robot, parameters.robot);
        detail::write_file(arguments.urdf, robot.urdf->text);
    }
    if (!arguments.dh.empty()) {
        robot.dh = dh_rows(file.robot, parameters.robot);
        detail::write_file(arguments.dh,
                           fmt::format("# {}, calibrated\n", detail::escape_controls(file.name)) +
                               io::make_dh_text(file.robot, robot.dh));
    }
    return robot;
}

void export_estimate(const ExportArguments& arguments, const CommonOptions& common) {
    if (arguments.urdf.empty() && arguments.dh.empty()) {
        throw CLI::RequiredError("--urdf or --dh");
    }
    check_outputs({arguments.campaign, arguments.estimate}, {arguments.urdf, arguments.dh}, common);
    const io::CampaignFile file = io::read_campaign(arguments.campaign);
    if (!arguments.urdf.empty()) check_urdf(arguments, file, common);
    const Parameters parameters =
        read_usable_estimate(arguments.estimate, file, arguments.is_forced).parameters;
    const io::ExportedRobot robot = write_robot(arguments, file, parameters);
    if (common.json) return print(io::to_json(robot, file, parameters));
    if (robot.urdf) print_urdf(arguments, file, parameters, *robot.urdf);
    if (!robot.dh.empty()) print_dh(arguments, file, parameters, robot);
}

}  // namespace

void add_export(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command =
        program.add_subcommand("export", "Write the calibrated robot in a form others read");
    command->add_option("CAMPAIGN", arguments->campaign, "Campaign file (YAML)")
        ->required()
        ->check(file_name());
    command->add_option("ESTIMATE", arguments->estimate, "Estimate (JSON), from calibrate --out")
        ->required()
        ->check(file_name());
    command->add_option("--urdf", arguments->urdf, "Write the calibrated URDF to this file")
        ->check(file_name());
    command->add_option("--dh", arguments->dh, "Write it as a Denavit-Hartenberg table (YAML)")
        ->check(file_name());
    add_force_option(*command, arguments->is_forced);
    command->footer(export_footer);
    command->callback([arguments, &common] { export_estimate(*arguments, common); });
}

}  // namespace posewise::cli
