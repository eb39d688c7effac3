#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "options.hpp"
#include "plan_inputs.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/robot_programs.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/correction.hpp"
#include "posewise/task/planning.hpp"

namespace posewise::cli {
namespace {

constexpr const char* correct_footer = R"(
Example:
  posewise correct campaign.yaml estimate.json --poses program.csv -o corrected.csv
  posewise correct campaign.yaml estimate.json --poses WELD.LS --for fanuc -o corrected/WELD.LS
  posewise correct arm.yaml estimate.json --poses holes.csv --cartesian --tool-mm 0,0,180 -o j.csv

For a controller that knows only the nominal robot: joint values that bring the calibrated robot (the
estimate, from calibrate --out) to where the nominal robot would be at the configurations of the
file. Written are config, joints in degrees or mm, the pose error left and the one without
correction, and what held a joint: its limit, or the largest change (see --largest-change-deg), which
near a singular pose keeps joints from running away for a small error: there they turn to it only if each
radian gains 2 mm (mrad) at least, else little, and the configuration is called singular.

Where it would be is taken from the base frame: that of the estimate, whose axis of the first joint is
where it was measured (--base estimate), or that the campaign file states (--base campaign), if
programs refer to the instrument's frame. Base and flange of the estimate absorb errors that no
measurement tells from theirs, so the error without correction is that of these frames, too.

With six joints or more position and orientation are both brought to zero, by the smallest change
of joints if there are several ways. With fewer the sum of squares is least, in which 1 mrad counts as
--mm-per-mrad; at 0 only the position of --tool-mm counts.

--for corrects a program that exists: of FANUC (.ls), KUKA (.src or .dat, each by itself), ABB (.mod) or
Universal Robots (.script). Its targets in joint values, as the campaign's controller counts them, are
replaced in place; not another byte changes. Targets that are not joint values (Cartesian ones, position
registers) and those that a move adds to others (offsets, INC) stay as they are and are named: they still
are the nominal robot's. Joints are written in the digits of the file.

--cartesian takes places of the tool: a table of config, x_mm, y_mm, z_mm and an orientation (roll_deg,
pitch_deg, yaw_deg about fixed axes; rx_deg, ry_deg, rz_deg; or qw, qx, qy, qz), or with --for those of a
program, in place. The nominal robot's joint values there are searched near those of the table (columns
q1_deg ...), --near, or home, and are corrected. ABB's quadrants and KUKA's T select among them; FANUC's
CONFIG and KUKA's S are kept but not looked at. A target that is not reached is refused by its name, a
program whose own tool is at another distance from the flange than --tool-mm by both.

Where joints are held in most configurations and over half of their error is left, nothing is written
and the exit code is 3; --force writes it all the same.)";

struct CorrectArguments {
    InputPaths paths;
    std::string estimate;
    std::string poses;
    std::string out;
    std::string format;  ///< program format of `poses`; empty: it is a CSV of configurations
    std::string base = "estimate";
    std::array<double, 3> tool_mm{};
    bool has_tool_mm = false;
    std::array<double, 3> tool_rpy_deg{};
    Index tool_target = 0;      ///< from 1; 0: not stated
    bool is_cartesian = false;  ///< targets may be places of the tool
    std::string frame = "base";
    std::array<double, 3> frame_mm{};
    std::array<double, 3> frame_rpy_deg{};
    std::vector<double> near;  ///< degrees or mm; empty: the cell's home
    double mm_per_mrad = 1;
    double largest_change_deg = 5;
    double largest_change_mm = 50;
    bool is_forced = false;
};

Isometry3d pose_of(const std::array<double, 3>& mm, const std::array<double, 3>& rpy_deg) {
    Isometry3d pose = Isometry3d::Identity();
    pose.translation() = Eigen::Map<const Vector3d>(mm.data()) / mm_per_m;
    pose.linear() = rotation_from_rpy(
        Vector3d(to_radians(rpy_deg[0]), to_radians(rpy_deg[1]), to_radians(rpy_deg[2])));
    return pose;
}

/// As stated, or with its point where a target was found.
Isometry3d flange_from_tool(const CorrectArguments& arguments, const Campaign& campaign,
                            const Parameters& found) {
    Isometry3d tool = pose_of(arguments.tool_mm, arguments.tool_rpy_deg);
    if (arguments.tool_target == 0) return tool;
    const Index count = campaign.sensor->observes_targets() ? campaign.sensor->target_count() : 0;
    if (arguments.tool_target > count) {
        throw input_error_at({arguments.estimate},
                             fmt::format("has {}; --tool-target is {}",
                                         detail::count_of(count, "target"), arguments.tool_target));
    }
    tool.translation() = campaign.sensor->target_position(arguments.tool_target - 1, found.sensor);
    return tool;
}

/// The joint values that targets without their own are near.
VectorXd seed_of(const CorrectArguments& arguments, const io::CampaignFile& file) {
    if (arguments.near.empty()) return file.cell.home;
    const Index count = file.robot.joint_count();
    if (std::ssize(arguments.near) != count) {
        throw CLI::ValidationError(
            "--near", fmt::format("has {} values; must have one for each of {}",
                                  arguments.near.size(), detail::count_of(count, "joint")));
    }
    io::Configurations near{{"near"}, RowMatrixXd(1, count), {}, {}};
    for (Index j = 0; j < count; ++j) {
        const double value = arguments.near[static_cast<std::size_t>(j)];
        const bool turns = file.robot.joint(j).motion == Motion::Rotation;
        near.joints(0, j) = turns ? to_radians(value) : value / mm_per_m;
    }
    io::check_within_limits("--near", file, near);
    return near.joints.row(0).transpose();
}

CartesianFrames cartesian_frames(const CorrectArguments& arguments, const io::CampaignFile& file,
                                 const Parameters& found) {
    CartesianFrames frames;
    frames.flange_from_tool = flange_from_tool(arguments, file, found);
    frames.base_from_frame = pose_of(arguments.frame_mm, arguments.frame_rpy_deg);
    if (arguments.frame == "world") {
        const Parameters& base = arguments.base == "campaign" ? file.nominal : found;
        frames.base_from_frame = base.world_from_base.inverse() * frames.base_from_frame;
    }
    if (arguments.is_cartesian) frames.seed = seed_of(arguments, file);
    return frames;
}

CorrectionOptions correction_options(const CorrectArguments& arguments,
                                     const CartesianFrames& frames) {
    CorrectionOptions options;
    options.tool = frames.flange_from_tool.translation();
    options.length_per_angle = arguments.mm_per_mrad;
    options.largest_turn = to_radians(arguments.largest_change_deg);
    options.largest_slide = arguments.largest_change_mm / 1e3;
    return options;
}

/// Throws NoCalibration where most configurations are not brought home, unless it is forced; warns
/// of some.
void check_corrected(const CorrectArguments& arguments, const CorrectedPoses& corrected) {
    const auto count = corrected.not_home.size();
    if (count == 0) return;
    const std::string words = fmt::format(
        "{}: {} of {} configurations are not brought home, the first is {}: over half of their "
        "error is left",
        arguments.poses, count, corrected.corrections.size(),
        detail::quote(corrected.ids[static_cast<std::size_t>(corrected.not_home.front())]));
    if (corrected.are_usable() || arguments.is_forced) return print_warning(words);
    throw NoCalibration(fmt::format("{}; {}--force corrects them all the same", words,
                                    arguments.out.empty() ? "" : "nothing was written, "));
}

/// A program of a controller whose targets are to be corrected.
struct ProgramToCorrect {
    io::ProgramFormat format;
    io::TargetProgram program;
};

void warn_of_others(const CorrectArguments& arguments, const io::TargetProgram& program) {
    constexpr std::size_t most = 20;
    const std::vector<long>& lines = program.others;
    if (lines.empty()) return;
    const auto listed = lines.begin() + static_cast<std::ptrdiff_t>(std::min(most, lines.size()));
    const std::string more =
        lines.size() > most ? fmt::format(" and {} more", lines.size() - most) : "";
    print_warning(fmt::format(
        "{}: not corrected: {} {}{}: no joint values of all joints, or added to other targets",
        arguments.poses, lines.size() == 1 ? "line" : "lines",
        fmt::join(lines.begin(), listed, ", "), more));
}

/// FANUC's and KUKA's files are called as the program in them.
void warn_of_name(const CorrectArguments& arguments, io::ProgramFormat format) {
    if (arguments.out.empty()) return;
    if (format != io::ProgramFormat::Fanuc && format != io::ProgramFormat::Kuka) return;
    const std::string name = std::filesystem::path(arguments.poses).filename().string();
    if (std::filesystem::path(arguments.out).filename() == name) return;
    print_warning(
        fmt::format("{}: has another name than the program in it; write it to another folder as {}",
                    arguments.out, name));
}

ProgramToCorrect read_program_to_correct(const CorrectArguments& arguments,
                                         const io::CampaignFile& file) {
    const io::ProgramFormat format = io::parse_program_format(arguments.format);
    if (file.robot.configuration_size() != file.robot.joint_count()) {
        throw input_error_at({file.path},
                             "measures torques with each configuration, which no program holds");
    }
    program_steps(format, file);
    return {format,
            io::read_program_targets(arguments.poses, format, file.controller,
                                     arguments.is_cartesian ? io::TargetKinds::JointsAndPlaces
                                                            : io::TargetKinds::Joints)};
}

/// Throws InputError where the tool of a program's places is not stated, or the program states
/// another one, unless it is forced. Only distances from the flange are compared: the axes of the
/// controller's flange may be others than the model's.
void check_tool(const CorrectArguments& arguments, const io::TargetProgram& program,
                const CartesianFrames& frames) {
    if (program.places.empty()) return;
    const auto& tool = program.tool;
    const Vector3d mm = tool ? Vector3d(tool->position * mm_per_m) : Vector3d::Zero();
    const std::string stated = tool ? fmt::format("the tool at {:g}, {:g}, {:g} mm in line {}",
                                                  mm[0], mm[1], mm[2], tool->line)
                                    : "";
    if (!arguments.has_tool_mm && arguments.tool_target == 0) {
        throw input_error_at(
            {arguments.poses},
            fmt::format("has places of a tool that is not stated{}; state --tool-mm (0,0,0 if they "
                        "are the flange's), or --tool-target",
                        tool ? "; the program has " + stated : ""));
    }
    constexpr double tolerance = 1;  // mm, of digits and of a target's place that was found
    const Vector3d used = frames.flange_from_tool.translation() * mm_per_m;
    if (!tool || arguments.is_forced || std::abs(used.norm() - mm.norm()) <= tolerance) return;
    throw input_error_at(
        {arguments.poses},
        fmt::format("has {}, {:.4g} mm from the flange, {} states one at {:.4g}, {:.4g}, {:.4g} "
                    "mm, {:.4g} mm from it; must be the same (--force takes the latter)",
                    stated, mm.norm(), arguments.has_tool_mm ? "--tool-mm" : "--tool-target",
                    used[0], used[1], used[2], used.norm()));
}

/// Appends places of the tool as the nominal robot reaches them.
void append(io::Configurations& poses, const io::CampaignFile& file,
            const std::vector<CartesianTarget>& targets, const CartesianFrames& frames) {
    const Index before = poses.joints.rows();
    poses.joints.conservativeResize(before + std::ssize(targets), file.robot.joint_count());
    poses.joints.bottomRows(std::ssize(targets)) = nominal_configurations(file, targets, frames);
    for (const CartesianTarget& target : targets) poses.ids.push_back(target.id);
}

std::vector<CartesianTarget> targets_of(const ProgramToCorrect& read,
                                        const io::CampaignFile& file) {
    std::vector<CartesianTarget> targets;
    for (const io::PlaceTarget& place : read.program.places) {
        CartesianTarget& target = targets.emplace_back();
        target.id = place.id;
        target.frame_from_tool = place.frame_from_tool;
        if (place.configuration.empty()) continue;
        target.is_wanted = [&](const VectorXd& q) {
            return io::is_of_configuration(place, read.format, file.controller.to_controller(q));
        };
    }
    return targets;
}

/// The model's joints at a target; one that its digits have rounded beyond a limit is at it.
VectorXd joints_of(const io::JointTarget& target, const io::CampaignFile& file) {
    constexpr double most = 1e-4;  // rad or m; more is no matter of digits
    VectorXd joints = file.controller.to_model(target.joints);
    VectorXd rounding = VectorXd::Zero(joints.size());
    for (Index i = 0; i < target.joints.size(); ++i) {
        VectorXd moved = target.joints;
        moved[i] += target.rounding[i];
        rounding += (file.controller.to_model(moved) - joints).cwiseAbs();
    }
    for (Index j = 0; j < joints.size(); ++j) {
        const Joint& joint = file.robot.joint(j);
        const double nearest = std::clamp(joints[j], joint.lower, joint.upper);
        constexpr double noise = 1e-12;  // of the way to the model's joints
        const double allowed = std::min(rounding[j], most) + noise;
        if (std::abs(joints[j] - nearest) <= allowed) joints[j] = nearest;
    }
    return joints;
}

/// The targets in joint values, in the model's joints.
io::Configurations configurations_of(const io::TargetProgram& program,
                                     const io::CampaignFile& file) {
    io::Configurations poses;
    poses.joints.resize(std::ssize(program.targets), file.robot.joint_count());
    for (std::size_t k = 0; k < program.targets.size(); ++k) {
        poses.ids.push_back(program.targets[k].id);
        poses.joints.row(static_cast<Index>(k)) = joints_of(program.targets[k], file).transpose();
    }
    return poses;
}

io::Configurations read_poses(const CorrectArguments& arguments, const io::CampaignFile& file,
                              const std::optional<ProgramToCorrect>& program,
                              const CartesianFrames& frames) {
    io::Configurations poses;
    if (!program && !arguments.is_cartesian) {
        poses = io::read_program(arguments.poses, file);
        if (poses.is_corrected && !arguments.is_forced) {
            throw input_error_at({arguments.poses},
                                 "has a column uncorrected_..., so is what correct wrote; must "
                                 "be nominal configurations (--force corrects it once more)");
        }
        return poses;
    }
    std::vector<CartesianTarget> targets;
    if (program) {
        poses = configurations_of(program->program, file);
        io::check_within_limits(arguments.poses, file, poses);
        targets = targets_of(*program, file);
    } else {
        targets = io::read_cartesian_targets(arguments.poses, file);
    }
    compute_from(arguments.poses, [&] { append(poses, file, targets, frames); });
    return poses;
}

/// What replaces the places of a program, which are corrected last.
std::vector<io::CorrectedPlace> corrected_places(const CorrectArguments& arguments,
                                                 const io::CampaignFile& file,
                                                 const ProgramToCorrect& read,
                                                 const CorrectedPoses& corrected,
                                                 const CartesianFrames& frames) {
    if (read.program.places.empty()) return {};
    const std::vector<Isometry3d> targets =
        compute_from(arguments.poses, [&] { return corrected_targets(corrected, frames); });
    std::vector<io::CorrectedPlace> places;
    for (std::size_t k = read.program.targets.size(); k < targets.size(); ++k) {
        const VectorXd nominal = corrected.nominal.row(static_cast<Index>(k)).transpose();
        places.push_back({targets[k], file.controller.to_controller(nominal),
                          file.controller.to_controller(corrected.corrections[k].joints)});
    }
    return places;
}

void write_corrected(const CorrectArguments& arguments, const io::CampaignFile& file,
                     const io::Configurations& poses, const CorrectedPoses& corrected,
                     const std::optional<ProgramToCorrect>& program,
                     const CartesianFrames& frames) {
    if (arguments.out.empty()) return;
    if (!program) {
        return io::write_corrections_csv(arguments.out, file, poses.ids, corrected.corrections,
                                         poses.purposes);
    }
    std::vector<VectorXd> values;
    for (std::size_t k = 0; k < program->program.targets.size(); ++k) {
        values.push_back(file.controller.to_controller(
            rounded_within_limits(corrected.corrections[k].joints, file, file.controller,
                                  program->program.targets[k].steps)));
    }
    const auto places = corrected_places(arguments, file, *program, corrected, frames);
    compute_from(arguments.poses, [&] {
        io::write_program_targets(arguments.out, program->program, program->format, file.controller,
                                  values, places);
    });
}

void correct(const CorrectArguments& arguments, const CommonOptions& common) {
    const io::CampaignFile file = io::read_campaign(arguments.paths.campaign);
    check_outputs({&file}, {arguments.estimate, arguments.poses}, {arguments.out}, common);
    const Parameters found =
        read_usable_estimate(arguments.estimate, file, arguments.is_forced).parameters;
    std::optional<ProgramToCorrect> program;
    if (!arguments.format.empty()) program = read_program_to_correct(arguments, file);
    const auto base =
        arguments.base == "campaign" ? CorrectionBase::Campaign : CorrectionBase::Estimate;
    if (base == CorrectionBase::Campaign && !file.has_nominal_base) {
        throw input_error_at({arguments.paths.campaign},
                             "does not state a base; --base campaign needs it");
    }
    const CartesianFrames frames = cartesian_frames(arguments, file, found);
    if (program) check_tool(arguments, program->program, frames);
    const io::Configurations poses = read_poses(arguments, file, program, frames);
    io::check_within_limits(arguments.poses, file, poses);
    const CorrectedPoses corrected = compute_from(arguments.poses, [&] {
        return correct_poses(file, found, poses.joints, poses.ids, base,
                             correction_options(arguments, frames));
    });
    check_corrected(arguments, corrected);
    if (!corrected.collisions.empty()) {
        print_warning(arguments.poses + ": " + corrected.collisions);
    }
    if (program) {
        warn_of_others(arguments, program->program);
        warn_of_name(arguments, program->format);
    }
    write_corrected(arguments, file, poses, corrected, program, frames);
    if (common.json) {
        return print_document(
            io::to_json(corrected, file, program ? program->program.others : std::vector<long>{}));
    }
    print(fmt::format(
        "{}: {} corrected{}\n", file.name,
        detail::count_of(std::ssize(poses.ids),
                         program || arguments.is_cartesian ? "target" : "configuration"),
        arguments.out.empty() ? "" : ": " + detail::escape_controls(arguments.out)));
    print(format(corrected));
}

void add_cartesian_options(CLI::App& command, CorrectArguments& arguments) {
    CLI::Option* const cartesian = command.add_flag(
        "--cartesian", arguments.is_cartesian,
        "Targets are, or with --for may be, places of the tool: x, y, z and an orientation");
    const auto add_triple = [&](const char* name, std::array<double, 3>& triple, double most,
                                const char* description) {
        command.add_option(name, triple, description)
            ->delimiter(',')
            ->check(real_number(-most, most))
            ->needs(cartesian);
    };
    constexpr double farthest = 1e6;  // mm
    constexpr double whole_turn = 360;
    add_triple("--tool-rpy-deg", arguments.tool_rpy_deg, whole_turn,
               "Orientation of the tool in the flange frame: R,P,Y (default: as the flange)");
    command
        .add_option("--frame", arguments.frame,
                    "What Cartesian targets, or --frame-mm and --frame-rpy-deg, refer to: base or "
                    "world (the instrument)")
        ->check(CLI::IsMember({"base", "world"}))
        ->capture_default_str()
        ->needs(cartesian);
    add_triple("--frame-mm", arguments.frame_mm, farthest,
               "Origin of the frame of Cartesian targets: X,Y,Z");
    add_triple("--frame-rpy-deg", arguments.frame_rpy_deg, whole_turn,
               "Its orientation: R,P,Y, about fixed x, y, z");
    command
        .add_option("--near", arguments.near,
                    "Joint values near which Cartesian targets are meant, deg or mm (default: the "
                    "cell's home)")
        ->delimiter(',')
        ->check(real_number(-1e6, 1e6))
        ->needs(cartesian);
}

void add_correct_options(CLI::App& command, CorrectArguments& arguments) {
    command
        .add_option("--poses", arguments.poses,
                    "Nominal configurations (CSV), as plan --csv writes it; with --for a program")
        ->required()
        ->check(file_name());
    command
        .add_option("--for", arguments.format,
                    "Kind of controller whose program is to be corrected, in place")
        ->check(CLI::IsMember(io::target_format_names()));
    command
        .add_option("-o,--out", arguments.out,
                    "Write the corrected configurations (CSV), or the corrected program")
        ->check(file_name());
    command
        .add_option("--base", arguments.base,
                    "Base frame of the nominal poses: estimate, or campaign (its key base)")
        ->check(CLI::IsMember({"estimate", "campaign"}))
        ->capture_default_str();
    command
        .add_option("--tool-mm", arguments.tool_mm,
                    "Point whose position counts, in the flange frame: X,Y,Z (default: the flange; "
                    "must be stated for Cartesian targets of a program)")
        ->delimiter(',')
        ->check(real_number(-1e4, 1e4));
    command
        .add_option("--tool-target", arguments.tool_target,
                    "Take the place that the estimate found for the target of this number as the "
                    "tool's point")
        ->check(whole_number(1, 1000))
        ->excludes("--tool-mm");
    add_cartesian_options(command, arguments);
    command
        .add_option("--mm-per-mrad", arguments.mm_per_mrad,
                    "What 1 mrad counts as where not all of the pose can be had; 0: nothing")
        ->check(real_number(0, 1e6))
        ->capture_default_str();
    command
        .add_option("--largest-change-deg", arguments.largest_change_deg,
                    "No revolute joint is moved further")
        ->check(real_number(1e-6, 180))
        ->capture_default_str();
    command
        .add_option("--largest-change-mm", arguments.largest_change_mm,
                    "No prismatic joint is moved further")
        ->check(real_number(1e-6, 1e4))
        ->capture_default_str();
}

}  // namespace

void add_correct(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<CorrectArguments>();
    CLI::App* command = program.add_subcommand(
        "correct", "Joint values that bring the calibrated robot to nominal poses");
    add_campaign_argument(*command, arguments->paths);
    command->add_option("ESTIMATE", arguments->estimate, "Estimate (JSON), from calibrate --out")
        ->required()
        ->check(file_name());
    add_correct_options(*command, *arguments);
    add_force_option(*command, arguments->is_forced);
    command->footer(correct_footer);
    command->callback([arguments, command, &common] {
        arguments->has_tool_mm = command->count("--tool-mm") > 0;
        correct(*arguments, common);
    });
}

}  // namespace posewise::cli
