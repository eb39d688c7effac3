#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "io/format/atomic_file.hpp"
#include "measured.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/report/reports.hpp"
#include "report/readings_report.hpp"

namespace posewise::cli {
namespace {

constexpr const char* inspect_footer = R"(
Example:
  posewise inspect campaign.yaml
  posewise inspect robot.urdf --base base_link --tip tool0 --write-campaign campaign.yaml

Prints the robot's elements from base to flange, the joints with their limits and axes, and every
parameter a calibration would identify (base, robot's errors, targets). One that no measurement can
tell from the others is marked "no", with the errors that do exactly the same, for example
  Tx2  mm  1  no  1 mm Tx2 = 1 mm Tx1 - 0.7813 mrad dq2
A campaign that states such a parameter and no prior is singular: drop it. With errors: geometric it
has every error a rigid link can have, less those marked "no"; with errors: full, the default, all of
them, torque shapes and harmonics, which priors keep apart. The last lines
compare with the formula for what is identifiable; a stated set that spans less leaves errors of the
real robot uncorrected. A warning tells where there is no clear gap between what is identifiable and
what is not, as of harmonics of high order on a joint that turns little.

With --measurements their meaning is checked, too: the robot is registered (base and targets fitted,
nothing else) with every choice of joints reversed, two joints exchanged, a joint coupled to its
neighbour (j3 - j2), another unit or zero of a joint, points in mm, inches or feet, a left-handed
instrument, other senses of orientations. The right one misses the points by what the robot's errors
are, any other by far more; with --from, by what an earlier estimate left.

A robot can be inspected before there is a campaign, straight from its URDF; --write-campaign then
makes a file to begin with, which says what is left to fill in. Its cell.links are capsules around the
URDF's collision shapes (boxes, cylinders, spheres, capsules); a warning names the links of meshes.)";

struct InspectArguments {
    InputPaths paths;  ///< the campaign may be a URDF
    std::string base_link;
    std::string tip_link;
    std::string written;
    EarlierArguments earlier;
    bool progress = false;
};

void print_head(const io::CampaignFile& file) {
    print(fmt::format("{}\nsensor: {}; model error {}\n", file.name, file.sensor->words().sentence,
                      detail::describe_model_error(file)));
    if (file.robot_class != RobotClass::Unknown) {
        print(fmt::format(
            "class: {}; its model error is expected within a factor of {:g}, the sizes of its "
            "errors within {:g} (1 sigma)\n",
            robot_class_name(file.robot_class), file.known_within.model_error,
            file.known_within.error_size));
    }
    if (file.urdf) {
        print(fmt::format("robot: {}, from base link {} to tip link {}\n",
                          detail::escape_controls(file.urdf->path),
                          detail::quote(file.urdf->base_link), detail::quote(file.urdf->tip_link)));
    }
}

/// With the readings of measurements that were tried, if there are some.
void print_campaign(const io::CampaignFile& file, const ReadingSearch& readings,
                    const CommonOptions& common) {
    const bool is_stated =
        file.error_model == io::ErrorModel::Stated || file.error_model == io::ErrorModel::Offsets;
    Inspection inspection = posewise::inspect(file, file.declared_robot, is_stated);
    inspection.rounded_angle_count = file.rounded_angle_count;
    const std::string gap = describe_gap(inspection);
    if (!gap.empty()) print_warning(file.path + ": " + gap);
    if (common.json) {
        return print_document(readings.tried.empty() ? io::to_json(inspection)
                                                     : io::to_json(inspection, readings));
    }
    print_head(file);
    print(format(inspection) + describe_unused_planning(file));
    if (!readings.tried.empty()) print(detail::describe_readings(readings));
}

bool is_urdf(const InspectArguments& arguments) {
    return !arguments.base_link.empty() || !arguments.tip_link.empty() ||
           !arguments.written.empty() || arguments.paths.campaign.ends_with(".urdf");
}

/// The campaign that --write-campaign would write.
void inspect_urdf(const InspectArguments& arguments, const CommonOptions& common) {
    const std::string& urdf = arguments.paths.campaign;
    if (!arguments.paths.measurements.empty() || !arguments.earlier.from.empty()) {
        throw input_error_at({urdf},
                             "is a robot alone; --measurements and --from need a campaign file");
    }
    const std::string& written = arguments.written;
    check_outputs({}, {urdf}, {written}, common);
    if (std::filesystem::exists(written)) {
        throw input_error_at({written}, "exists already; must be a new file");
    }
    const io::UrdfRobot robot = io::read_urdf({urdf, arguments.base_link, arguments.tip_link});
    std::ranges::for_each(io::describe_doubts(robot), print_warning);
    const std::string path = written.empty() ? urdf : written;
    const std::string text = io::make_campaign_text(robot, path);
    const io::CampaignFile file = io::parse_campaign(text, path);
    if (!written.empty()) {
        std::ranges::for_each(io::read_urdf_bodies(robot).skipped, print_warning);
        detail::write_file(written, text);
    }
    print_campaign(file, {}, common);
    if (!written.empty() && !common.json) {
        print(fmt::format("\nThe campaign is in {}; fill in what is marked there.\n",
                          detail::escape_controls(written)));
    }
}

/// Base and targets that are measured elsewhere than stated.
void warn_of_places(const std::string& path, const io::CampaignFile& file,
                    const Measurements& measurements) {
    const Parameters registered = register_base_and_targets(file, measurements).parameters;
    if (find_misfit(file, measurements, registered)) return;  // that is said of the readings
    const std::string words = describe_places(find_place_doubts(file, registered));
    if (!words.empty()) print_warning(path + ": " + words);
}

void inspect(const InspectArguments& arguments, const CommonOptions& common) {
    if (is_urdf(arguments)) return inspect_urdf(arguments, common);
    io::CampaignFile file = io::read_campaign(arguments.paths.campaign);
    std::ranges::for_each(file.warnings, print_warning);
    warn_of_limits(file);
    expect_earlier(file, arguments.earlier);
    ReadingSearch readings;
    const InputPaths& paths = arguments.paths;
    if (!paths.measurements.empty()) {
        const std::optional<Plan> plan = read_measured_plans(paths, file).all;
        const auto measurements = read_as_stated(paths.measurements, file, points_of(paths, plan));
        check_needs_unit(paths, measurements.is_joined);
        check_needs_plan(paths, measurements.is_joined);
        readings = compute_from(paths.measurements, [&] {
            ProgressLine line("trying readings", arguments.progress);
            ReadingSearch search =
                search_readings(file, measurements, [&](const Progress& state) { line(state); });
            if (!search.undetermined.empty()) throw InputError(search.undetermined);
            return search;
        });
        warn_of_places(paths.measurements, file, measurements);
    }
    print_campaign(file, readings, common);
}

}  // namespace

void add_inspect(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<InspectArguments>();
    CLI::App* command =
        program.add_subcommand("inspect", "Show the robot, and which of its errors can be found");
    command
        ->add_option("CAMPAIGN", arguments->paths.campaign,
                     "Campaign file (YAML), or a robot alone (URDF)")
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
        ->add_option("-m,--measurements", arguments->paths.measurements,
                     "Measured configurations (CSV, or MATLAB .mat), or with --plan a list of "
                     "points: check how they are meant")
        ->check(file_name());
    add_points_options(*command, arguments->paths.plan, arguments->paths.points_unit,
                       "Plan whose poses a list of points was measured at");
    add_progress_flag(*command, arguments->progress);
    for (const char* const option : {"--plan", "--points-unit", "--progress"}) {
        command->get_option(option)->needs("--measurements");
    }
    add_from_option(*command, arguments->earlier);
    command->footer(inspect_footer);
    command->callback([arguments, &common] { inspect(*arguments, common); });
}

}  // namespace posewise::cli
