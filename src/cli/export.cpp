#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "export_text.hpp"
#include "files.hpp"
#include "options.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise::cli {
namespace {

constexpr const char* export_footer = R"(
Example:
  posewise export campaign.yaml estimate.json --urdf calibrated.urdf
  posewise export campaign.yaml estimate.json --dh calibrated.yaml
  posewise export campaign.yaml estimate.json --ur-kinematics my_robot_calibration.yaml
  posewise export campaign.yaml estimate.json --mujoco arm.xml
  posewise export campaign.yaml estimate.json --robodk arm.py
  posewise export campaign.yaml estimate.json --urdf calibrated.urdf --map map.c --geometry estimate
  posewise export campaign.yaml estimate.json --camera camera.yaml

The estimate is what calibrate --out wrote. Every file is read back before it takes its place: its
flange must be within 1e-9 m of the robot's at 1000 configurations (of --ur-kinematics within 1e-6 m
and 3e-5 rad, by which a description may round: 1.5708).

None of these forms can have errors that depend on the configuration (gravity, harmonics). With such
errors in the estimate the geometry is written that is nearest over the workspace (--workspace; else
the limits, and the cell if the campaign has one): that of least squares of the targets' positions,
as if it were calibrated there, base and targets along with it. What is lost is printed, beside what
the robot misses that is not calibrated. --geometry estimate writes the estimate's own geometry, for
a program that adds the other errors itself.

--map writes these other errors as corrections of joint values: a C source with the function
posewise_joints_to_send(), or its table (.csv). The file says how it is used; what is left at random
configurations is printed and stands in it.

--offsets writes, for mastering, how far each joint of the controller stands from where it is sent
(deg or mm, and pulses where the campaign states them), with its deviation: sent to 0 it stands at the
offset. calibrate --csv writes the same.

--camera writes where a camera found camera and board: a file of OpenCV's with its intrinsic
parameters and both frames as matrices (.yaml), or fixed joints for a URDF (.urdf). The arguments of
ROS 2's static_transform_publisher are printed.

The URDF is the one the campaign's robot comes from, and stays as it is (names, order, comments,
layout) but for the numbers of joint origins between base link and tip link. The base as the
instrument sees it and the targets are not part of the robot; they are printed.

--dh writes any robot as a standard Denavit-Hartenberg table, with the angle beta in place of the
offset d where the next axis is nearly parallel (Hayati).

--mujoco writes any robot as a model for MuJoCo (MJCF): a body a joint, with its limits, and sites at
flange and targets or tool. qpos of a joint is its value (rad or m) as the robot has it. A joint q2.2
is what q2 drives besides (couplings); it follows q2. Masses are not known; each body has 1 g.

--robodk writes a robot of joints that turn as modified Denavit-Hartenberg rows in a Python script,
which sets them as the accurate kinematics of a robot in RoboDK. It was not tried in RoboDK: compare a
pose first.

--ur-kinematics writes a robot of six joints that turn as the file of kinematics that ur_description
and the ROS drivers of Universal Robots read. It begins at what they call base_link_inertia and ends
at tool0; of a robot that begins at base_link the half turn between the two is left out. The driver will say that its hash is not the controller's: that has the factory's.)";

struct ExportArguments {
    std::string campaign;
    std::string estimate;
    ExportPaths paths;
    std::string geometry = "nearest";
    std::string workspace;
    bool is_forced = false;
};

io::ExportedRobot make_geometries(const ExportArguments& arguments, const io::CampaignFile& file,
                                  const Parameters& found) {
    GeometryOptions options;
    if (!arguments.workspace.empty()) {
        options.workspace = io::read_program(arguments.workspace, file).joints;
    }
    io::ExportedRobot robot;
    robot.terms = active_terms(file.robot, found.robot);
    compute_from(arguments.workspace.empty() ? arguments.campaign : arguments.workspace, [&] {
        robot.estimated = estimated_geometry(file, found, options);
        if (!robot.terms.empty()) robot.nearest = nearest_geometry(file, found, options);
        robot.nominal = nominal_loss(file, found, options);
        robot.has_workspace = options.workspace.rows() > 0;
    });
    return robot;
}

/// The forms asked for, not yet written.
io::ExportedRobot make_robot(const ExportArguments& arguments, const io::CampaignFile& file,
                             const Parameters& found) {
    io::ExportedRobot robot = make_geometries(arguments, file, found);
    robot.is_nearest =
        robot.nearest && arguments.geometry == "nearest" && arguments.paths.map.empty();
    const Chain& chain = robot.written().robot;
    const VectorXd& errors = robot.written().errors;
    const ExportPaths& paths = arguments.paths;
    if (!paths.urdf.empty()) robot.urdf = io::make_calibrated_urdf(*file.urdf, chain, errors);
    if (!paths.dh.empty()) robot.dh = dh_rows(chain, errors);
    if (!paths.ur_kinematics.empty()) {
        robot.frames = compute_from(arguments.campaign, [&robot] {
            return ur_frames(robot.written().robot, robot.written().errors);
        });
    }
    if (!paths.robodk.empty()) {
        robot.robodk = compute_from(arguments.campaign, [&robot] {
            return modified_dh(robot.written().robot, robot.written().errors);
        });
    }
    if (!paths.camera.empty()) robot.camera = io::camera_places(file, found);
    if (!paths.map.empty()) {
        robot.map = compute_from(arguments.estimate, [&] { return correction_map(file, found); });
    }
    return robot;
}

void write_files(const ExportPaths& paths, const io::CampaignFile& file, io::ExportedRobot& robot) {
    const Chain& chain = robot.written().robot;
    const VectorXd& errors = robot.written().errors;
    const std::string title = file.name + ", calibrated";
    const auto add = [&](const std::string& path, const FlangeDifference& difference) {
        robot.read_back.push_back({path, difference});
    };
    if (robot.urdf) {
        add(paths.urdf,
            io::write_calibrated_urdf(paths.urdf, *robot.urdf, *file.urdf, chain, errors));
    }
    if (!robot.dh.empty()) add(paths.dh, io::write_dh(paths.dh, title, robot.dh, chain, errors));
    if (robot.frames) {
        add(paths.ur_kinematics,
            io::write_ur_kinematics(paths.ur_kinematics, title, *robot.frames, chain, errors));
    }
    if (!paths.mujoco.empty()) {
        add(paths.mujoco, compute_from(paths.mujoco, [&] {
                return io::write_mujoco(paths.mujoco, title, robot.written());
            }));
    }
    if (robot.robodk) {
        add(paths.robodk, io::write_robodk(paths.robodk, title, *robot.robodk, chain, errors));
    }
    if (robot.camera) io::write_camera(paths.camera, file, *robot.camera);
    if (robot.map) io::write_correction_map(paths.map, file.name, *robot.map);
}

void export_estimate(const ExportArguments& arguments, const CommonOptions& common) {
    const ExportPaths& paths = arguments.paths;
    const bool has_geometry =
        !(paths.urdf.empty() && paths.dh.empty() && paths.ur_kinematics.empty() &&
          paths.mujoco.empty() && paths.robodk.empty());
    if (!has_geometry && (paths.map + paths.camera + paths.offsets).empty()) {
        throw CLI::RequiredError(
            "--urdf, --dh, --ur-kinematics, --mujoco, --robodk, --map, --offsets or --camera");
    }
    if (!paths.camera.empty()) io::check_camera_path(paths.camera);
    if (!paths.map.empty()) {
        io::check_map_path(paths.map);
        if (has_geometry && arguments.geometry == "nearest") {
            throw CLI::ValidationError("--map",
                                       "adds to the estimate's own geometry, not to the nearest; "
                                       "add --geometry estimate");
        }
    }
    const io::CampaignFile file = io::read_campaign(arguments.campaign);
    check_outputs({&file}, {arguments.estimate, arguments.workspace},
                  {paths.urdf, paths.dh, paths.ur_kinematics, paths.mujoco, paths.robodk, paths.map,
                   paths.offsets, paths.camera},
                  common);
    if (!paths.urdf.empty() && !file.urdf) {
        throw input_error_at({arguments.campaign},
                             "has a robot that does not come from a URDF; only such a one can go "
                             "into one (--dh takes any)");
    }
    if (!paths.camera.empty() && !io::camera_places(file, file.nominal)) {
        throw input_error_at({arguments.campaign},
                             "has no camera; --camera is for sensor.kind camera, or poses of a "
                             "board that a camera sees");
    }
    const Estimate estimate = read_usable_estimate(arguments.estimate, file, arguments.is_forced);
    io::ExportedRobot robot = make_robot(arguments, file, estimate.parameters);
    write_files(paths, file, robot);
    if (!paths.offsets.empty()) {
        io::write_offsets_csv(paths.offsets, file, estimate, file.controller);
    }
    warn_of(robot, paths);
    if (common.json) return print_document(io::to_json(robot, file));
    print_export(robot, file, paths);
}

}  // namespace

void add_export(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<ExportArguments>();
    CLI::App* command =
        program.add_subcommand("export", "Write the calibrated robot in a form others read");
    const auto add_file = [&](const char* name, std::string& path, const char* description) {
        return command->add_option(name, path, description)->check(file_name());
    };
    add_file("CAMPAIGN", arguments->campaign, "Campaign file (YAML)")->required();
    add_file("ESTIMATE", arguments->estimate, "Estimate (JSON), from calibrate --out")->required();
    add_file("--urdf", arguments->paths.urdf, "Write the calibrated URDF to this file");
    add_file("--dh", arguments->paths.dh, "Write it as a Denavit-Hartenberg table (YAML)");
    add_file("--ur-kinematics", arguments->paths.ur_kinematics,
             "Write it as kinematics of ur_description (YAML)");
    add_file("--mujoco", arguments->paths.mujoco, "Write it as a model for MuJoCo (MJCF)");
    add_file("--robodk", arguments->paths.robodk,
             "Write it as a script that sets the parameters of a robot in RoboDK (Python)");
    add_file("--map", arguments->paths.map,
             "Write what depends on the configuration for a cell's own software: .c or .csv");
    add_file("--offsets", arguments->paths.offsets,
             "Write the offset of each joint of the controller, as for mastering (CSV)");
    add_file("--camera", arguments->paths.camera,
             "Write where camera and board are: .yaml (OpenCV) or .urdf (fixed joints)");
    command
        ->add_option("--geometry", arguments->geometry,
                     "Where errors depend on the configuration: nearest (least squares over the "
                     "workspace), or estimate (these errors left out)")
        ->check(CLI::IsMember({"nearest", "estimate"}))
        ->capture_default_str();
    add_file("--workspace", arguments->workspace,
             "Where the robot works: configurations (CSV), instead of its limits and cell");
    add_force_option(*command, arguments->is_forced);
    command->footer(export_footer);
    command->callback([arguments, &common] { export_estimate(*arguments, common); });
}

}  // namespace posewise::cli
