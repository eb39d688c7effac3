#include <fmt/format.h>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_stops.hpp"

/// Universal Robots URScript (.script).
namespace posewise::detail {
namespace {

/// The slowest joint of the arms turns at this speed, of which the program takes its per cent.
constexpr double joint_speed = to_radians(120);  // rad/s
constexpr double acceleration = 0.5;             // rad/s^2

std::string ur_stop(const io::RobotProgram& program, const io::ProgramStop& stop) {
    const ProgramRules& rules = ur_program().rules;
    std::string text =
        fmt::format("  # {}\n  movej([{}], a={}, v={:.4f}, r=0)\n", stop.label,
                    joints_text(rules, program.joints, stop.joints, ", "), acceleration,
                    joint_speed * static_cast<double>(program.speed_percent) / 100);
    if (!stop.is_measured) return text;
    if (const double dwell = dwell_of(program, stop); dwell > 0) {
        text += fmt::format("  sleep({})\n", seconds_text(dwell));
    }
    if (program.handshake == io::Handshake::Pause) {
        return text +
               fmt::format("  popup(\"{}\", title=\"posewise\", blocking=True)\n", stop.label);
    }
    text += fmt::format("  textmsg(\"{}\")\n", stop.label);
    if (program.handshake == io::Handshake::Io) {
        text +=
            "  set_digital_out(0, True)\n  while not get_digital_in(0):\n    sync()\n  end\n"
            "  set_digital_out(0, False)\n  while get_digital_in(0):\n    sync()\n  end\n";
    }
    return text;
}

/// What is between the brackets of "movej([...], ...".
std::string_view ur_joints(const TextLine& line) {
    const std::size_t open = line.text.find('[');
    const std::size_t close = line.text.find(']', std::min(open, line.text.size()));
    if (!line.text.starts_with("movej") && line.begins_with("movej")) {
        throw line.error("is no word of URScript, which tells capitals apart; must be movej");
    }
    if (!line.text.starts_with("movej([") || close == std::string_view::npos) {
        throw line.error("is no joint move to numbers; must be like movej([0, -1.57, ...], ...)");
    }
    return line.text.substr(open + 1, close - open - 1);
}

/// Throws InputError unless the blend radius is zero: "r=...", or the fifth argument; for numbers
/// below 0, and for a call that does not end.
void check_ur_stop(const TextLine& line) {
    const std::size_t begin = line.text.find(']') + 1;
    const std::size_t end = line.text.find(')', begin);
    if (end == std::string_view::npos) throw line.error("has no ) at its end; must have one");
    std::string_view rest = line.text.substr(begin, end - begin);
    for (int position = 1; !rest.empty(); ++position) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        const std::string_view argument = trim(rest.substr(0, comma));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        const std::size_t equals = argument.find('=');
        const bool has_name = equals != std::string_view::npos;
        const std::string_view name = has_name ? trim(argument.substr(0, equals)) : "";
        const ParsedNumber value = parse_number(trim(argument.substr(has_name ? equals + 1 : 0)));
        if (value.ok() && value.value < 0) {
            throw line.error(fmt::format("has {}; must not be below 0", quote(argument)));
        }
        if (has_name ? name != "r" : position != 5) continue;
        if (value.ok() && value.value == 0) continue;
        throw line.error("does not stop at its position; must have r=0");
    }
}

std::vector<FileContent> ur_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = io::legal_program_name(io::ProgramFormat::Ur, stem_of(path));
    std::string text = fmt::format("def {}():\n  # {}\n", name, comment_text(program.title));
    for (const io::ProgramStop& stop : program.stops) text += ur_stop(program, stop);
    return {{path, text + fmt::format("end\n{}()\n", name)}};
}

void check_ur_statement(const TextLine& line) {
    for (const char* const other : {"movel", "movep", "movec", "servo", "speedj", "speedl"}) {
        if (line.begins_with(other)) throw line.error("is no joint move; must be movej([...])");
    }
    if (line.has("movej(") && !line.has("\"")) {
        throw line.error("moves under a condition; must be movej in a line of its own");
    }
}

/// What stands before a comment.
TextLine without_comment(TextLine line) {
    line.text = trim(line.text.substr(0, line.text.find('#')));
    return line;
}

std::vector<io::ProgramStop> read_ur(const std::string& path, const ControllerJoints& joints) {
    const ProgramFile file(path);
    StopCollector stops(ur_program().rules, joints);
    for (const TextLine& whole : file.lines()) {
        const TextLine line = without_comment(whole);
        if (line.text.empty()) {
            stops.note(whole.text.substr(1));
        } else if (line.begins_with("movej")) {
            const std::string_view numbers = ur_joints(line);
            check_ur_stop(line);
            stops.move(line, read_numbers(line, numbers));
        } else {
            check_ur_statement(line);
            stops.pass(line);
        }
    }
    return stops.finish();
}

}  // namespace

const ProgramKind& ur_program() {
    static const ProgramKind kind{
        {.ending = ".script",
         .decimals = 6,
         .is_in_radians = true,
         .has_program_name = false,
         .words = "and break continue def elif else end enter_critical exit_critical "
                  "False global halt if join kill local not or pass return run sec thread "
                  "True while xor movej sleep popup textmsg sync",
         .flow = {.routines = "def sec",
                  .opens = "if while thread switch",
                  .closes = "end",
                  .leaves = "return halt",
                  .has_then = false},
         .waits = "sleep popup",
         .messages = "textmsg popup",
         .target = "(["},
        &ur_files,
        &read_ur};
    return kind;
}

}  // namespace posewise::detail
