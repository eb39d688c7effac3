#include "posewise/io/robot_programs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>

#include "core/names.hpp"
#include "core/text.hpp"
#include "io/format/text.hpp"
#include "io/result/configurations_text.hpp"
#include "program_text.hpp"

namespace posewise::io {
namespace {

using detail::FileContent;
using detail::lower_case;
using detail::ProgramRules;

constexpr detail::Names<ProgramFormat, 8> formats{{{ProgramFormat::Fanuc, "fanuc"},
                                                   {ProgramFormat::Kuka, "kuka"},
                                                   {ProgramFormat::Abb, "abb"},
                                                   {ProgramFormat::Ur, "ur"},
                                                   {ProgramFormat::Yaskawa, "yaskawa"},
                                                   {ProgramFormat::Staubli, "staubli"},
                                                   {ProgramFormat::Ros2, "ros2"},
                                                   {ProgramFormat::Csv, "csv"}}};

const detail::ProgramKind& kind_of(ProgramFormat format) {
    using namespace detail;
    switch (format) {
        case ProgramFormat::Fanuc:
            return fanuc_program();
        case ProgramFormat::Kuka:
            return kuka_program();
        case ProgramFormat::Abb:
            return abb_program();
        case ProgramFormat::Ur:
            return ur_program();
        case ProgramFormat::Yaskawa:
            return yaskawa_program();
        case ProgramFormat::Staubli:
            return staubli_program();
        case ProgramFormat::Ros2:
            return ros2_program();
        case ProgramFormat::Csv:
            break;
    }
    return csv_program();
}

std::string_view name_of(ProgramFormat format) { return detail::name_of(formats, format); }

void check_joints(ProgramFormat format, const ControllerJoints& joints) {
    constexpr Index six = 6;
    const ProgramRules& rules = kind_of(format).rules;
    if (!rules.has_six_joints) return;
    bool turn = true;
    for (Index i = 0; i < joints.count(); ++i) turn = turn && joints.motion(i) == Motion::Rotation;
    if (joints.count() == six && turn) return;
    throw InputError(fmt::format(
        "a program for {} has six joints that turn, the robot has {}{}; ros2 and csv take any",
        name_of(format), detail::count_of(joints.count(), "joint"),
        turn ? "" : ", not all of which do"));
}

void check_program(ProgramFormat format, const RobotProgram& program) {
    const ProgramRules& rules = kind_of(format).rules;
    const bool is_pause = program.handshake == Handshake::Pause;
    const bool is_io = program.handshake == Handshake::Io;
    if ((is_pause && !rules.has_pause) || (is_io && !rules.has_io)) {
        throw InputError(fmt::format("a program for {} has no handshake {}; must be none{}",
                                     name_of(format), is_pause ? "pause" : "io",
                                     rules.has_pause ? " or pause" : ""));
    }
    check_stops(program);
}

void check_path(const std::string& path, ProgramFormat format) {
    const ProgramRules& rules = kind_of(format).rules;
    const std::string stem = detail::stem_of(path);
    if (stem.empty() || lower_case(stem) == rules.ending) {
        throw InputError(fmt::format("{}: has no name before its ending; must be like {}", path,
                                     detail::sibling_of(path, "cell" + std::string(rules.ending))));
    }
    if (lower_case(detail::ending_of(path)) != rules.ending) {
        throw InputError(
            rules.ending.empty()
                ? fmt::format("{}: a project for {} is a folder, whose name has no ending", path,
                              name_of(format))
                : fmt::format("{}: a program for {} must end in {}", path, name_of(format),
                              rules.ending));
    }
    if (!rules.has_program_name) return;
    const std::string legal = legal_program_name(format, stem);
    if (lower_case(legal) == lower_case(stem)) return;
    throw InputError(fmt::format(
        "{}: the file has the program's name, which the controller would not take, since it is too "
        "long, has other characters, or is a name of the controller's own; must be like {}",
        path, detail::sibling_of(path, legal + std::string(rules.ending))));
}

}  // namespace

std::string_view program_format_name(ProgramFormat format) { return name_of(format); }

std::vector<std::string> program_format_names() { return detail::words_of(formats); }

ProgramFormat parse_program_format(const std::string& name) {
    if (const auto format = detail::find_named(formats, name)) return *format;
    throw InputError(detail::quote(name) + " is no kind of program; " +
                     detail::suggest(name, program_format_names()));
}

VectorXd joint_steps(ProgramFormat format, const ControllerJoints& joints) {
    check_joints(format, joints);
    if (format == ProgramFormat::Yaskawa) {
        if (joints.pulses_per_unit().size() == 0) {
            throw InputError(
                "controller.pulses_per_deg is not stated; must be, a program for yaskawa is in "
                "pulses: they stand in the controller's parameters (ALL.PRM)");
        }
        return joints.pulses_per_unit().cwiseInverse();
    }
    const ProgramRules& rules = kind_of(format).rules;
    VectorXd steps(joints.count());
    for (Index i = 0; i < steps.size(); ++i) {
        const AmountUnits& units = units_of(joints.motion(i));
        const double unit = rules.is_in_radians ? 1 : units.to_si(1);
        steps[i] = unit * std::pow(10.0, -rules.decimals);
    }
    return steps;
}

std::vector<std::string> pose_labels(const std::vector<std::string>& ids) {
    constexpr std::size_t longest = detail::longest_label;
    std::set<std::string> taken;
    std::map<std::string, Index> next;  // number to try for names alike
    std::vector<std::string> labels;
    for (const std::string& id : ids) {
        std::string label = detail::legal_name(id, longest, false, "home via");
        // Numbers are usual names of measured poses.
        const bool is_plain =
            !id.empty() && id.size() <= longest && detail::is_identifier('_' + id);
        if (is_plain && id != "home" && id != "via") label = id;
        const std::string base = lower_case(label);
        for (Index& number = next[base]; !taken.insert(lower_case(label)).second;) {
            const std::string suffix = fmt::format("_{}", ++number + 1);
            label = label.substr(0, std::min(base.size(), longest - suffix.size())) + suffix;
        }
        labels.push_back(label);
    }
    return labels;
}

std::string legal_program_name(ProgramFormat format, std::string_view text) {
    const ProgramRules& rules = kind_of(format).rules;
    return detail::legal_name(text, rules.longest_name, rules.is_upper, rules.words);
}

void check_stops(const RobotProgram& program) {
    for (const ProgramStop& stop : program.stops) {
        if (stop.joints.size() != program.joints.count() || !stop.joints.allFinite()) {
            throw InputError("stop " + detail::quote(stop.label) +
                             " has a joint that is missing or not finite");
        }
        for (Index i = 0; i < stop.joints.size(); ++i) {
            const detail::Quantity quantity = detail::quantity_of(program.joints.motion(i));
            if (detail::is_plausible(stop.joints[i], quantity)) continue;
            const AmountUnits& units = units_of(program.joints.motion(i));
            throw InputError(fmt::format("stop {} has {:g} {} for {}, which no robot reaches",
                                         detail::quote(stop.label),
                                         units.to_reading(stop.joints[i]), units.reading,
                                         program.joints.names()[static_cast<std::size_t>(i)]));
        }
    }
}

std::vector<std::string> program_files(const std::string& path, ProgramFormat format,
                                       const RobotProgram& program) {
    check_path(path, format);
    std::vector<std::string> paths;
    for (const FileContent& file : kind_of(format).write(path, program)) {
        paths.push_back(file.path);
    }
    return paths;
}

std::vector<std::string> stale_program_files(const std::string& path, ProgramFormat format,
                                             const RobotProgram& program) {
    std::vector<std::string> stale;
    if (!kind_of(format).rules.has_parts) return stale;
    const std::vector<std::string> files = program_files(path, format, program);
    for (Index part = 1;; ++part) {
        const std::string name = fmt::format("{}_{}", detail::stem_of(path), part);
        const std::string source = detail::sibling_of(path, name + detail::ending_of(path));
        if (std::ranges::find(files, source) != files.end()) continue;
        if (!std::filesystem::exists(source)) return stale;
        stale.push_back(source);
    }
}

void write_robot_program(const std::string& path, ProgramFormat format, const RobotProgram& program,
                         const std::string& sent_path, const Campaign& campaign, const Plan& sent) {
    joint_steps(format, program.joints);
    check_program(format, program);
    check_path(path, format);
    std::vector<FileContent> files = kind_of(format).write(path, program);
    if (!sent_path.empty()) {
        files.push_back(
            {sent_path, detail::configurations_text(campaign, sent.poses, sent.verification)});
    }
    const bool is_folder = kind_of(format).rules.ending.empty();
    std::error_code problem;
    const bool is_new = is_folder && std::filesystem::create_directory(path, problem);
    if (problem) throw InputError(fmt::format("{}: {}; must be writable", path, problem.message()));
    try {
        detail::write_files(files);
    } catch (const InputError&) {
        if (is_new) std::filesystem::remove(path, problem);
        throw;
    }
}

std::vector<ProgramStop> read_robot_program(const std::string& path, ProgramFormat format,
                                            const ControllerJoints& joints) {
    joint_steps(format, joints);
    std::vector<ProgramStop> stops = kind_of(format).read(path, joints);
    if (stops.empty()) {
        throw input_error_at(
            {path}, fmt::format("has no joint move; must be a program for {}", name_of(format)));
    }
    return stops;
}

}  // namespace posewise::io
