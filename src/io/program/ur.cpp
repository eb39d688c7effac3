#include <fmt/format.h>

#include "io/format/text.hpp"
#include "program_text.hpp"

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
    if (!line.begins_with("movej([") || close == std::string_view::npos) {
        throw line.error("is no joint move to numbers; must be like movej([0, -1.57, ...], ...)");
    }
    return line.text.substr(open + 1, close - open - 1);
}

/// A blend radius that is not zero.
bool is_blended(const TextLine& line) {
    const std::size_t at = line.text.find("r=");
    return at != std::string_view::npos &&
           line.text.find_first_of("123456789", at) != std::string_view::npos;
}

std::vector<FileContent> ur_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = io::legal_program_name(io::ProgramFormat::Ur, stem_of(path));
    std::string text = fmt::format("def {}():\n  # {}\n", name, comment_text(program.title));
    for (const io::ProgramStop& stop : program.stops) text += ur_stop(program, stop);
    return {{path, text + fmt::format("end\n{}()\n", name)}};
}

std::vector<io::ProgramStop> read_ur(const std::string& path, const ControllerJoints& joints) {
    const ProgramFile file(path);
    std::vector<io::ProgramStop> stops;
    std::string comment;
    for (const TextLine& line : file.lines()) {
        if (line.begins_with("#")) note_comment(line.text.substr(1), comment);
        for (const char* const other : {"movel", "movep", "movec", "servoj", "speedj"}) {
            if (line.begins_with(other)) throw line.error("is no joint move; must be movej([...])");
        }
        if (!line.begins_with("movej")) continue;
        const std::string_view numbers = ur_joints(line);
        if (is_blended(line)) throw line.error("does not stop at its position; must have r=0");
        stops.push_back(
            make_stop(line, ur_program().rules, joints, read_numbers(line, numbers), comment));
    }
    return stops;
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
                  "True while xor movej sleep popup textmsg sync"},
        &ur_files,
        &read_ur};
    return kind;
}

}  // namespace posewise::detail
