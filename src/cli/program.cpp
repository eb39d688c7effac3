#include <fmt/chrono.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <optional>

#include "commands.hpp"
#include "common.hpp"
#include "core/format.hpp"
#include "core/text.hpp"
#include "estimates.hpp"
#include "files.hpp"
#include "options.hpp"
#include "plan_inputs.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/io/robot_programs.hpp"
#include "posewise/task/planning.hpp"
#include "report/sentences.hpp"

namespace posewise::cli {
namespace {

constexpr const char* program_footer = R"(
Example:
  posewise program measurements.plan.json --for fanuc -o CELL.ls
  posewise program measurements.plan.json --for ur --handshake pause -o cell.script
  posewise program measurements.plan.json --for fanuc --read CELL.ls -o back.csv

Writes a plan as a program of joint moves that stop at each pose: for FANUC (.ls), KUKA (.src, .dat),
ABB (.mod), Universal Robots (.script), Yaskawa (.jbi), Staubli (a VAL3 folder), ROS 2 (.yaml, a goal
a pose) or as plain CSV in the controller's units. A comment before each move names the pose. It
begins and ends at the cell's home. A plan with a BLOCKED move, or with a pose that violates joint
limits or the cell, is refused.

The campaign's section controller says how the controller counts its joints (couplings, signs, zeros,
pulses); without it they are the model's. posewise help controller explains it, designs/programs.md
has an example for each maker. Nothing is guessed: what is not stated and is needed is asked for.

Joints are rounded to the digits of the file first, then checked again. They are what is measured:
they are written to PLAN.as_sent.csv, in the model's joints, for calibrate and select. The loss by
rounding is printed: the criterion's value and the predicted accuracy, as planned and as sent.

--reference p3 --every 5 visits pose p3 again after each five others, as ref1, ref2, ..., with targets of
these names; they stand in PLAN.as_sent.csv, too. What residuals change by meanwhile is drift, of robot or
instrument, whatever the model lacks: calibrate says so ("Drift").

--read converts a program that was edited on the pendant to configurations (CSV), lists the poses that
were dropped, moved (which joint most, and by how much) or lost their name, and warns of stops and
ways that violate joint limits, joint sums or the cell. Jumps and moves within conditions are refused.
A campaign file will do instead of the plan, but then nothing is compared.

These formats were not tested on real controllers: read the program, and run it first with --dry-run
(no waiting, at most 10 % speed) and a hand on the stop.)";

struct ProgramArguments {
    std::string plan;
    std::string campaign;
    std::string format;
    std::string out;
    std::string read;
    std::optional<double> dwell;
    std::optional<Index> speed_percent;
    std::string handshake = "none";
    RouteOptions route;
    std::string reference;  ///< pose that is visited again; empty: none
    Index every = 5;
    bool is_dry_run = false;
};

constexpr Index dry_run_percent = 10;
constexpr Index usual_percent = 20;
constexpr double usual_dwell = 2;  // s

/// The campaign of a plan as its poses were planned with, and the plan.
struct PlanAndCampaign {
    Plan plan;
    io::CampaignFile campaign;
};

PlanAndCampaign read_both(const ProgramArguments& arguments) {
    Plan plan = io::read_plan(arguments.plan);
    if (plan.kind == CandidateKind::Blocks) {
        throw input_error_at({arguments.plan},
                             "is a choice from plain blocks, which have no joints");
    }
    if (!arguments.campaign.empty()) plan.request.sources.campaign = arguments.campaign;
    const PlanRequest& request = plan.request;
    io::CampaignFile campaign =
        read_planned(request.sources, request.earlier, request.has_prior, true);
    const std::string mismatch = describe_mismatch(plan, campaign);
    if (!mismatch.empty()) throw input_error_at({arguments.plan}, mismatch);
    return {std::move(plan), std::move(campaign)};
}

/// Of a file; empty if it cannot be read.
std::string content_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// "plan.json" to "plan.as_sent.csv".
std::string sent_path_of(const std::string& plan) {
    std::filesystem::path path(plan);
    if (path.extension() == ".json") path.replace_extension();
    return path.string() + ".as_sent.csv";
}

io::Handshake parse_handshake(const std::string& word) {
    if (word == "pause") return io::Handshake::Pause;
    return word == "io" ? io::Handshake::Io : io::Handshake::None;
}

/// Ids of the plan's poses, then of its verification.
std::vector<std::string> ids_of(const Plan& plan) {
    std::vector<std::string> ids;
    for (const auto* poses : {&plan.poses, &plan.verification}) {
        for (const PlannedPose& pose : *poses) ids.push_back(pose.id);
    }
    return ids;
}

std::vector<io::ProgramStop> stops_of(const std::vector<RouteStop>& route, const Plan& plan,
                                      const ControllerJoints& controller) {
    const std::vector<std::string> ids = ids_of(plan);
    const std::vector<std::string> labels = io::pose_labels(ids);
    std::map<std::string, std::string> label_of;
    for (std::size_t k = 0; k < ids.size(); ++k) label_of[ids[k]] = labels[k];
    std::vector<io::ProgramStop> stops;
    for (const RouteStop& one : route) {
        const bool is_pose = one.kind == RouteStop::Kind::Pose;
        const std::string passed = one.kind == RouteStop::Kind::Home ? "home" : "via";
        stops.push_back({is_pose ? label_of[one.id] : passed,
                         controller.to_controller(one.configuration.head(controller.count())),
                         is_pose, one.times});
    }
    return stops;
}

io::RobotProgram make_program(const ProgramArguments& arguments, const io::CampaignFile& campaign,
                              const std::vector<io::ProgramStop>& stops) {
    io::RobotProgram program;
    program.title =
        fmt::format("posewise, {}{}", campaign.name, arguments.is_dry_run ? ", dry run" : "");
    program.date = fmt::format("{:%Y/%m/%d %H:%M}", fmt::localtime(std::time(nullptr)));
    program.joints = campaign.controller;
    program.stops = stops;
    program.joint_speed = campaign.cell.speed;
    program.speed_percent = arguments.speed_percent.value_or(usual_percent);
    program.settle = campaign.cell.settle;
    program.dwell =
        arguments.dwell.value_or(campaign.cell.dwell > 0 ? campaign.cell.dwell : usual_dwell);
    program.handshake = parse_handshake(arguments.handshake);
    if (arguments.is_dry_run) {
        program.speed_percent = std::min(program.speed_percent, dry_run_percent);
        program.settle = program.dwell = 0;
        program.handshake = io::Handshake::None;
    }
    return program;
}

/// Nothing of configurations that were measured: their measurements are at the planned joints.
std::optional<RoundingLoss> find_loss(const PlanAndCampaign& both, const Plan& sent) {
    const Plan& plan = both.plan;
    if (plan.is_continuous()) {
        return rounding_loss(plan, sent, both.campaign,
                             read_planning_inputs(plan.request, both.campaign));
    }
    if (plan.kind == CandidateKind::Measurements) return std::nullopt;
    const ChoiceInputs inputs =
        read_choice_inputs(plan.request, plan.kind, plan.candidate_count, both.campaign);
    return rounding_loss(plan, sent, both.campaign, inputs.candidates, inputs.options);
}

std::string describe(const RoundingLoss& loss) {
    std::string text;
    if (loss.largest_turn > 0) {
        text += fmt::format(" by {} deg", detail::format_short(to_degrees(loss.largest_turn), 2));
    }
    if (loss.largest_slide > 0) {
        text += fmt::format("{} by {} mm", text.empty() ? "" : ",",
                            detail::format_short(mm_per_m * loss.largest_slide, 2));
    }
    text = fmt::format("Rounding moves joints{}.\n{}: {} planned, {} as sent",
                       text.empty() ? " by nothing" : text, criterion_name(loss.criterion),
                       detail::format_short(loss.planned, 8), detail::format_short(loss.sent, 8));
    if (loss.planned_rms && loss.sent_rms) {
        text += fmt::format("; predicted RMS/mm: {} planned, {} as sent",
                            detail::format_short(mm_per_m * *loss.planned_rms, 6),
                            detail::format_short(mm_per_m * *loss.sent_rms, 6));
    }
    return text + '\n';
}

/// More than any controller's digits do.
void warn_of_rounding(const io::ProgramReport& report) {
    constexpr double usual_turn = to_radians(0.05);
    constexpr double usual_slide = 1e-4;  // m
    const auto& loss = report.loss;
    if (!loss || (loss->largest_turn <= usual_turn && loss->largest_slide <= usual_slide)) return;
    print_warning(fmt::format(
        "the digits of a program for {} move joints by {}: are the sums and pulses under "
        "controller right?",
        io::program_format_name(report.format),
        loss->largest_turn > usual_turn
            ? detail::format_short(to_degrees(loss->largest_turn), 2) + " deg"
            : detail::format_short(mm_per_m * loss->largest_slide, 2) + " mm"));
}

/// Warns where nobody has compared J3 with the pendant's.
void warn_of_coupling(const io::CampaignFile& campaign, io::ProgramFormat format) {
    const bool is_stated = !campaign.controller_maker.empty() || !campaign.controller.is_identity();
    if (format != io::ProgramFormat::Fanuc || is_stated) return;
    print_warning(
        "J3 is q3 of the model, but most FANUCs count J3 from the ground: compare one pose with "
        "the pendant and state in the campaign controller: {maker: fanuc, j23_factor: -1, 0 or 1}");
}

std::string describe(const io::ProgramReport& report) {
    std::string text = fmt::format(
        "{}: {} in {} for {}\n", detail::escape_controls(report.files.front()),
        detail::count_of(report.visit_count, "pose"), detail::count_of(report.stop_count, "move"),
        io::program_format_name(report.format));
    if (!report.by_hand.empty()) text += "by hand: " + report.by_hand + '\n';
    for (std::size_t k = 1; k < report.files.size(); ++k) {
        text += detail::escape_controls(report.files[k]) + '\n';
    }
    text += fmt::format("{}: the plan as it is sent, to calibrate with\n",
                        detail::escape_controls(report.sent));
    if (report.loss) text += describe(*report.loss);
    return text;
}

/// Rounded, and with the visits of the reference pose.
Plan as_sent(const ProgramArguments& arguments, const Plan& plan, const Campaign& campaign,
             const ControllerJoints& controller, const VectorXd& steps) {
    const Plan sent = sent_plan(plan, campaign, controller, steps);
    if (arguments.reference.empty()) return sent;
    return with_revisits(sent, arguments.reference, arguments.every);
}

void write_program(const ProgramArguments& arguments, const CommonOptions& common) {
    const io::ProgramFormat format = io::parse_program_format(arguments.format);
    const PlanAndCampaign both = read_both(arguments);
    const ControllerJoints& controller = both.campaign.controller;
    const VectorXd steps = program_steps(format, both.campaign);
    const Plan sent = compute_from(arguments.plan, [&] {
        return as_sent(arguments, both.plan, both.campaign, controller, steps);
    });
    const std::vector<RouteStop> route = compute_from(arguments.plan, [&] {
        return route_of(sent, both.campaign, controller, steps, arguments.route);
    });
    const io::RobotProgram program =
        make_program(arguments, both.campaign, stops_of(route, sent, controller));
    compute_from(arguments.plan, [&] { io::check_stops(program); });
    io::ProgramReport report;
    report.format = format;
    report.files = io::program_files(arguments.out, format, program);
    report.sent = sent_path_of(arguments.plan);
    report.by_hand = detail::describe_by_hand(both.plan, both.campaign.cell);
    report.stop_count = std::ssize(program.stops);
    report.visit_count = std::ranges::count(program.stops, true, &io::ProgramStop::is_measured);
    std::vector<std::string> outputs = report.files;
    const bool is_new_folder =
        format == io::ProgramFormat::Staubli && !std::filesystem::exists(arguments.out);
    if (is_new_folder) outputs = {arguments.out};
    outputs.push_back(report.sent);
    check_outputs({&both.campaign}, {arguments.plan}, outputs, common);
    report.loss = compute_from(arguments.plan, [&] {
        return find_loss(both, sent_plan(both.plan, both.campaign, controller, steps));
    });
    warn_of_rounding(report);
    warn_of_coupling(both.campaign, format);
    report.stale = io::stale_program_files(arguments.out, format, program);
    const std::string before = content_of(report.sent);
    io::write_robot_program(arguments.out, format, program, report.sent, both.campaign, sent);
    if (!before.empty() && before != content_of(report.sent)) {
        print_warning(
            fmt::format("{}: held other joint values, of an earlier program or plan; measurements "
                        "made with those need them: write that program again before they are used",
                        report.sent));
    }
    for (const std::string& part : report.stale) {
        print_warning(fmt::format(
            "{}: is of an earlier, longer program, which {} does not call; remove it here and on "
            "the controller",
            part, detail::escape_controls(report.files.front())));
    }
    if (common.json) return print_document(io::to_json(report, both.campaign));
    print(describe(report));
}

std::string describe(const std::string& what, const std::vector<std::string>& ids) {
    if (ids.empty()) return "";
    return fmt::format("{}: {}\n", what,
                       detail::escape_controls(fmt::format("{}", fmt::join(ids, ", "))));
}

std::string times_text(Index count) { return count == 1 ? "once" : fmt::format("{} times", count); }

/// What differs from the plan.
std::string describe(const io::ProgramContent& content, const ControllerJoints& controller) {
    std::vector<std::string> moved;
    for (const io::MovedPose& pose : content.moved) {
        const AmountUnits& units = units_of(controller.motion(pose.joint));
        moved.push_back(fmt::format("{} ({} by {} {}{})", pose.id,
                                    controller.names()[static_cast<std::size_t>(pose.joint)],
                                    detail::format_short(units.to_reading(pose.change), 4),
                                    units.reading, controller.count() > 1 ? " at most" : ""));
    }
    std::vector<std::string> again;
    for (const auto& [id, pose] : content.again) {
        again.push_back(fmt::format("{} (at {})", id, pose));
    }
    std::vector<std::string> visits;
    for (const auto& [id, count] : content.other_visits) {
        visits.push_back(fmt::format("{} ({})", id, times_text(count)));
    }
    return describe("dropped", content.dropped) + describe("moved", moved) +
           describe("not of the plan", content.added) +
           describe("poses of the plan under another name", again) +
           describe("without a name, known by their joints", content.recognised) +
           describe("without a name, measured at no pose of the plan", content.unnamed) +
           describe("not visited " + times_text(content.visits) + " as the others", visits);
}

/// They are still read: what was measured there is measured.
void warn_of_faults(const io::ProgramContent& content) {
    constexpr std::size_t most = 10;
    for (std::size_t k = 0; k < std::min(most, content.faults.size()); ++k) {
        print_warning(content.faults[k]);
    }
    if (content.faults.size() <= most) return;
    print_warning(
        fmt::format("{} more of this kind (--json has all)", content.faults.size() - most));
}

void read_program(const ProgramArguments& arguments, const CommonOptions& common) {
    const io::ProgramFormat format = io::parse_program_format(arguments.format);
    const bool is_plan = std::filesystem::path(arguments.plan).extension() == ".json";
    std::optional<Plan> sent;
    io::CampaignFile campaign;
    if (is_plan) {
        PlanAndCampaign both = read_both(arguments);
        campaign = std::move(both.campaign);
        sent = std::move(both.plan);
    } else {
        campaign = io::read_campaign(arguments.plan);
    }
    if (!sent && !arguments.reference.empty()) {
        throw input_error_at({arguments.plan},
                             "is no plan, which --reference is of; must be one, as plan writes it");
    }
    check_outputs({&campaign}, {arguments.plan, arguments.read}, {arguments.out}, common);
    if (campaign.robot.configuration_size() != campaign.robot.joint_count()) {
        throw input_error_at({campaign.path},
                             "measures torques with each configuration, which no program holds");
    }
    const VectorXd steps = program_steps(format, campaign);
    if (sent) {
        sent = compute_from(arguments.plan, [&] {
            return as_sent(arguments, *sent, campaign, campaign.controller, steps);
        });
    }
    const io::ProgramContent content = io::program_content(
        arguments.read, io::read_robot_program(arguments.read, format, campaign.controller),
        campaign, steps, sent);
    warn_of_faults(content);
    warn_of_coupling(campaign, format);
    if (!arguments.out.empty()) io::write_program_content(arguments.out, campaign, content);
    if (common.json) return print_document(io::to_json(content, campaign));
    print(fmt::format("{}: {}\n", detail::escape_controls(arguments.read),
                      detail::count_of(std::ssize(content.ids), "configuration")));
    print(describe(content, campaign.controller));
    if (content.dropped.empty() || !sent || !sent->is_continuous()) return;
    print(fmt::format("To plan others instead: posewise plan ... --plan {} --drop {}\n",
                      detail::escape_controls(arguments.plan),
                      detail::escape_controls(fmt::format("{}", fmt::join(content.dropped, ",")))));
}

/// A folder may be typed with a slash at its end.
void drop_slashes(std::string& path) {
    while (path.size() > 1 && path.back() == '/') path.pop_back();
}

void run_program(ProgramArguments arguments, const CommonOptions& common) {
    drop_slashes(arguments.out);
    drop_slashes(arguments.read);
    if (!arguments.read.empty()) return read_program(arguments, common);
    if (arguments.out.empty()) throw CLI::RequiredError("--out");
    if (arguments.route.is_reversed && arguments.route.repeats < 2) {
        throw CLI::ValidationError("--reverse",
                                   "needs --repeats 2 or more, of which every second "
                                   "pass is reversed");
    }
    arguments.route.finds_ways = !arguments.reference.empty();
    if (arguments.speed_percent && arguments.format == "csv") {
        throw CLI::ValidationError("--speed", "a CSV file has no speed");
    }
    write_program(arguments, common);
}

void add_program_options(CLI::App& command, ProgramArguments& arguments) {
    command.add_option("--for", arguments.format, "Kind of controller")
        ->required()
        ->check(CLI::IsMember(io::program_format_names()));
    command
        .add_option("-o,--out", arguments.out,
                    "Write the program to this file (staubli: folder); with --read its "
                    "configurations (CSV)")
        ->check(file_name());
    CLI::Option* const read =
        command.add_option("--read", arguments.read, "Read this program instead of writing one")
            ->check(file_name());
    command.add_option("--campaign", arguments.campaign, "Campaign file, if it is elsewhere now")
        ->check(file_name());
    const auto writing = [&](CLI::Option* option) { option->excludes(read); };
    writing(command
                .add_option("--dwell", arguments.dwell,
                            "Standstill at each pose, s (default: dwell_s of the cell, or 2)")
                ->check(real_number(0, 1e4)));
    writing(command
                .add_option("--speed", arguments.speed_percent,
                            "Per cent of full speed (abb: of 1000 mm/s; ur: of 120 deg/s; ros2: of "
                            "the cell's speed); default: 20")
                ->transform([](std::string percent) {
                    if (percent.ends_with('%')) percent.pop_back();
                    return percent;
                })
                ->check(whole_number(1, 100)));
    writing(command
                .add_option("--handshake", arguments.handshake,
                            "What the robot waits for at a pose, after the dwell: pause (an "
                            "operator continues) or io (output 1, of ur 0, is set until the input "
                            "of that number answers)")
                ->check(CLI::IsMember({"none", "pause", "io"}))
                ->capture_default_str());
    writing(
        command.add_option("--repeats", arguments.route.repeats, "Number of passes over all poses")
            ->check(whole_number(1, 1000))
            ->capture_default_str());
    writing(command.add_flag("--reverse", arguments.route.is_reversed,
                             "Go back the same way in every second pass: poses are reached from "
                             "the other side"));
    CLI::Option* const reference = command.add_option(
        "--reference", arguments.reference,
        "Visit this pose again and again, as ref1, ref2, ...: what changes there drifts");
    command
        .add_option("--every", arguments.every,
                    "With --reference: after so many other poses, and after the last")
        ->check(whole_number(1, 1000))
        ->capture_default_str()
        ->needs(reference);
    writing(command.add_flag("--dry-run", arguments.is_dry_run,
                             "Without dwell and handshake, at 10 % speed or less"));
}

}  // namespace

void add_program(CLI::App& program, const CommonOptions& common) {
    const auto arguments = std::make_shared<ProgramArguments>();
    CLI::App* command =
        program.add_subcommand("program", "Write a plan as a robot's program, or read one back");
    command
        ->add_option("PLAN", arguments->plan,
                     "Plan file, as plan or select writes it; with --read a campaign will do")
        ->required()
        ->check(file_name());
    add_program_options(*command, *arguments);
    command->footer(program_footer);
    command->callback([arguments, &common] { run_program(*arguments, common); });
}

}  // namespace posewise::cli
