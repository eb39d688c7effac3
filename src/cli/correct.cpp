#include <fmt/format.h>

#include <array>
#include <cmath>
#include <memory>

#include "commands.hpp"
#include "common.hpp"
#include "files.hpp"
#include "options.hpp"
#include "posewise/calibrator/correction.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/format.hpp"
#include "posewise/core/text.hpp"
#include "posewise/core/units.hpp"
#include "posewise/io/correction_file.hpp"
#include "posewise/io/estimate_file.hpp"

namespace posewise::cli {
namespace {

constexpr const char* footer = R"(
Example:
  posewise correct campaign.yaml estimate.json --poses program.csv -o corrected.csv

For a controller that knows only the nominal robot: joint values that bring the calibrated robot (the
estimate, from calibrate --out) to where the nominal robot would be at the configurations of the
file. Written are config, joints in degrees or mm, the pose error left and the one without
correction, and what held a joint: its limit, or the largest change (see --largest-change-deg), which
near a singular pose keeps joints from running away for a small error.

Where it would be is taken from the base frame: that of the estimate, whose axis of the first joint is
where it was measured (--base estimate), or that the campaign file states (--base campaign), if
programs refer to the instrument's frame. Base and flange of the estimate absorb errors that no
measurement tells from theirs, so the error without correction is that of these frames, too.

With six joints or more position and orientation are both brought to zero, by the smallest change
of joints if there are several ways. With fewer the sum of squares is least, in which 1 mrad counts as
--mm-per-mrad; at 0 only the position of --tool-mm counts.)";

struct Arguments {
    InputPaths paths;
    std::string estimate;
    std::string poses;
    std::string out;
    std::string base = "estimate";
    std::array<double, 3> tool_mm{};
    double mm_per_mrad = 1;
    double largest_change_deg = 5;
    double largest_change_mm = 50;
};

CorrectionOptions correction_options(const Arguments& arguments) {
    CorrectionOptions options;
    options.tool = Vector3d(arguments.tool_mm[0], arguments.tool_mm[1], arguments.tool_mm[2]) / 1e3;
    options.length_per_angle = arguments.mm_per_mrad;
    options.largest_turn = to_radians(arguments.largest_change_deg);
    options.largest_slide = arguments.largest_change_mm / 1e3;
    return options;
}

/// From the base frame of the estimate to that which the nominal poses are in.
Isometry3d estimated_base_from_base(const Arguments& arguments, const Campaign& campaign,
                                    const Parameters& found) {
    if (arguments.base == "estimate") return Isometry3d::Identity();
    if (!campaign.has_nominal_base) {
        throw input_error_at({arguments.paths.campaign},
                             "does not state a base; --base campaign needs it");
    }
    return found.world_from_base.inverse() * campaign.nominal.world_from_base;
}

std::vector<Correction> correct_all(const Arguments& arguments, const Campaign& campaign,
                                    const Parameters& found, const io::Configurations& poses) {
    const CorrectionOptions options = correction_options(arguments);
    const Isometry3d base = estimated_base_from_base(arguments, campaign, found);
    const VectorXd no_errors = VectorXd::Zero(campaign.robot.parameter_count());
    std::vector<Correction> corrections;
    for (Index i = 0; i < poses.joints.rows(); ++i) {
        const VectorXd nominal = poses.joints.row(i).transpose();
        try {
            corrections.push_back(correct_configuration(
                campaign.robot, found.robot, nominal,
                base * campaign.robot.base_from_flange(nominal, no_errors), options));
        } catch (const InputError& error) {
            throw input_error_at(
                {arguments.poses},
                fmt::format("configuration {}: {}", quote(poses.ids[static_cast<std::size_t>(i)]),
                            error.what()));
        }
    }
    return corrections;
}

/// RMS and maximum before and after.
Table error_table(const std::vector<Correction>& corrections) {
    const auto count = static_cast<Index>(corrections.size());
    Eigen::ArrayXXd errors(count, 4);
    for (Index i = 0; i < count; ++i) {
        const Correction& correction = corrections[static_cast<std::size_t>(i)];
        errors.row(i) << correction.uncorrected.position, correction.residual.position,
            correction.uncorrected.orientation, correction.residual.orientation;
    }
    const auto row = [&](const char* name, Index first, const auto& measure) {
        return std::vector<std::string>{name, format_mm(measure(errors.col(first))),
                                        format_mm(measure(errors.col(first + 1)))};
    };
    const auto rms = [&](const auto& column) { return std::sqrt(column.square().mean()); };
    const auto largest = [](const auto& column) { return column.maxCoeff(); };
    return {{"pose error", "uncorrected", "corrected"},
            {row("position RMS/mm", 0, rms), row("position max/mm", 0, largest),
             row("orientation RMS/mrad", 2, rms), row("orientation max/mrad", 2, largest)}};
}

Table change_table(const Campaign& campaign, const io::Configurations& poses,
                   const std::vector<Correction>& corrections) {
    Table table{{"joint", "largest change", ""}, {}};
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        double largest = 0;
        for (std::size_t i = 0; i < corrections.size(); ++i) {
            const double change = corrections[i].joints[j] - poses.joints(static_cast<Index>(i), j);
            largest = std::max(largest, std::abs(change));
        }
        const Joint& joint = campaign.robot.joint(j);
        const AmountUnits& units = units_of(joint.motion);
        table.rows.push_back(
            {joint.name, format_fixed(units.to_reading(largest), 4), std::string(units.reading)});
    }
    return table;
}

/// The poses whose correction is not complete, the first ones.
void print_shortfalls(const Campaign& campaign, const io::Configurations& poses,
                      const std::vector<Correction>& corrections) {
    constexpr std::size_t most = 20;
    Table table{{"config", "left/mm", "left/mrad", "why"}, {}};
    std::size_t count = 0;
    for (std::size_t i = 0; i < corrections.size(); ++i) {
        const std::string why = describe_shortfall(campaign.robot, corrections[i]);
        if (why.empty() || ++count > most) continue;
        const PoseError& left = corrections[i].residual;
        table.rows.push_back({escape_controls(poses.ids[i]), format_mm(left.position),
                              format_mm(left.orientation), why});
    }
    if (count == 0) return;
    print_section(fmt::format("Not corrected completely: {} of {}", count, corrections.size()),
                  table);
    if (count > most) print(fmt::format("... and {} more\n", count - most));
}

void correct(const Arguments& arguments) {
    check_outputs({arguments.paths.campaign, arguments.estimate, arguments.poses}, {arguments.out});
    const io::CampaignFile file = io::read_campaign(arguments.paths.campaign);
    const Parameters found = io::read_estimate(arguments.estimate, file);
    const io::Configurations poses = io::read_configurations(arguments.poses, file);
    const auto corrections = correct_all(arguments, file, found, poses);
    if (!arguments.out.empty()) {
        io::write_corrections_csv(arguments.out, file, poses.ids, corrections);
    }
    print(fmt::format("{}: {} configurations corrected{}\n", file.name, corrections.size(),
                      arguments.out.empty() ? "" : ": " + escape_controls(arguments.out)));
    print_section("Accuracy as the estimate predicts it", error_table(corrections));
    print_section("Corrections", change_table(file, poses, corrections));
    print_shortfalls(file, poses, corrections);
}

void add_options(CLI::App& command, Arguments& arguments) {
    command
        .add_option("--poses", arguments.poses,
                    "Nominal configurations (CSV), as plan --csv writes it")
        ->required()
        ->check(file_name());
    command.add_option("-o,--out", arguments.out, "Write the corrected configurations (CSV)")
        ->check(file_name());
    command
        .add_option("--base", arguments.base,
                    "Base frame of the nominal poses: estimate, or campaign (its key base)")
        ->check(CLI::IsMember({"estimate", "campaign"}))
        ->capture_default_str();
    command
        .add_option("--tool-mm", arguments.tool_mm,
                    "Point whose position counts, in the flange frame: X Y Z (default: the flange)")
        ->check(real_number(-1e4, 1e4));
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

void add_correct(CLI::App& program) {
    const auto arguments = std::make_shared<Arguments>();
    CLI::App* command = program.add_subcommand(
        "correct", "Joint values that bring the calibrated robot to nominal poses");
    add_campaign_argument(*command, arguments->paths);
    command->add_option("ESTIMATE", arguments->estimate, "Estimate (JSON), from calibrate --out")
        ->required()
        ->check(file_name());
    add_options(*command, *arguments);
    command->footer(footer);
    command->callback([arguments] { correct(*arguments); });
}

}  // namespace posewise::cli
