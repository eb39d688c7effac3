#include <fmt/format.h>

#include <array>
#include <map>
#include <optional>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_stops.hpp"
#include "reserved_words.hpp"

/// Universal Robots URScript (.script).
namespace posewise::detail {
namespace {

/// The slowest joint of the arms turns at this speed, of which the program takes its per cent.
constexpr double joint_speed = to_radians(120);  // rad/s
constexpr double acceleration = 0.5;             // rad/s^2

/// Beyond what any of the arms does: twice as fast as their fastest joints and tools.
constexpr double fastest_joint = to_radians(720);  // rad/s
constexpr double fastest_tool = 10;                // m/s

std::string ur_stop(const io::RobotProgram& program, const io::ProgramStop& stop) {
    const ProgramRules& rules = ur_program().rules;
    std::string text =
        fmt::format("  # {}\n  movej([{}], a={}, v={:.4f}, r=0)\n", stop.label,
                    joints_text(rules, program.joints, stop.joints, ", "), acceleration,
                    joint_speed * static_cast<double>(program.speed_percent) / 100);
    if (!stop.is_measured) return text;
    text += fmt::format("  textmsg(\"{}\")\n", stop.label);
    for (const double wait : waits_of(rules, program, stop)) {
        text += fmt::format("  sleep({})\n", seconds_text(wait));
    }
    if (program.handshake == io::Handshake::Pause) {
        text += fmt::format("  popup(\"{}\", title=\"posewise\", blocking=True)\n", stop.label);
    }
    if (program.handshake == io::Handshake::Io) {
        text +=
            "  set_digital_out(0, True)\n  while not get_digital_in(0):\n    sync()\n  end\n"
            "  set_digital_out(0, False)\n  while get_digital_in(0):\n    sync()\n  end\n";
    }
    return text;
}

/// What stands before a comment.
TextLine without_comment(TextLine line) {
    line.text = trim(line.text.substr(0, line.text.find('#')));
    return line;
}

/// An argument of a call: "r=0.05", or the third one.
struct UrArgument {
    std::string_view text;
    std::string_view name;  ///< empty: it has none
    ParsedNumber value;
};

/// What stands behind the target of a move: "movej([...], a=0.5, r=0)" has two.
std::vector<UrArgument> ur_arguments(const TextLine& move) {
    const std::size_t begin = std::min(move.text.rfind(']'), move.text.size() - 1) + 1;
    const std::size_t end = std::min(move.text.find(')', begin), move.text.size());
    std::string_view rest = move.text.substr(begin, end - begin);
    std::vector<UrArgument> arguments;
    while (!rest.empty()) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        UrArgument& one = arguments.emplace_back();
        one.text = trim(rest.substr(0, comma));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        const std::size_t equals = one.text.find('=');
        if (equals != std::string_view::npos) one.name = trim(one.text.substr(0, equals));
        one.value = parse_number(trim(one.text.substr(one.name.empty() ? 0 : equals + 1)));
    }
    return arguments;
}

/// Throws InputError where a move has no acceleration or speed (a and v, or the first two), unless
/// it states the time that it takes (t, or the third) in their place.
void check_ur_speed(const TextLine& move, const std::vector<UrArgument>& arguments) {
    constexpr std::array<std::string_view, 3> names{"a", "v", "t"};
    std::array<const UrArgument*, 3> of{};
    for (std::size_t k = 0; k < arguments.size(); ++k) {
        for (std::size_t n = 0; n < names.size(); ++n) {
            const auto& [text, name, value] = arguments[k];
            if (!text.empty() && (name.empty() ? k == n + 1 : name == names[n])) {
                of[n] = &arguments[k];
            }
        }
    }
    if (of[2] != nullptr && !(of[2]->value.ok() && of[2]->value.value == 0)) return;
    for (const UrArgument* const one : {of[0], of[1]}) {
        if (one == nullptr || !one->value.ok() || one->value.value > 0) continue;
        throw move.error(fmt::format("has {}; must be above 0", quote(one->text)));
    }
    const bool turns = first_word(move.text) == "movej";
    const double fastest = turns ? fastest_joint : fastest_tool;
    if (of[1] == nullptr || !of[1]->value.ok() || of[1]->value.value <= fastest) return;
    throw move.error(fmt::format("has {}, over {:.3g} {}, which no such arm does; must be less",
                                 quote(of[1]->text), fastest, turns ? "rad/s" : "m/s"));
}

void check_ur(const TextLine& line) {
    const std::string_view moves = ur_program().rules.moves;
    const TextLine statement = without_comment(line);
    check_target(ur_program().rules, statement, moves);
    check_time(statement, statement.text, first_argument(statement, "sleep"));
    const std::string_view word = first_word(statement.text);
    if (!is_word(word, moves)) return;
    if (lower_case(std::string(word)) != word) {
        throw line.error(
            fmt::format("is no word of URScript, which tells capitals apart; must be {}",
                        lower_case(std::string(word))));
    }
    check_brackets(statement);
    const std::vector<UrArgument> arguments = ur_arguments(statement);
    for (const UrArgument& argument : arguments) {
        if (!argument.value.ok() || argument.value.value >= 0) continue;
        throw line.error(fmt::format("has {}; must not be below 0", quote(argument.text)));
    }
    if (word.starts_with("move")) check_ur_speed(statement, arguments);
}

/// What is between the brackets of "movej([...], ...".
std::string_view ur_joints(const TextLine& line) {
    const std::size_t open = line.text.find('[');
    const std::size_t close = line.text.find(']', std::min(open, line.text.size()));
    if (!line.text.starts_with("movej([") || close == std::string_view::npos) {
        throw line.error("is no joint move to numbers; must be like movej([0, -1.57, ...], ...)");
    }
    return line.text.substr(open + 1, close - open - 1);
}

/// What stands behind the bracket that closes the first call.
std::string_view behind_call(std::string_view text) {
    long depth = 0;
    for (std::size_t k = 0; k < text.size(); ++k) {
        if (text[k] == '(') ++depth;
        if (text[k] == ')' && --depth == 0) return text.substr(k + 1);
    }
    return {};
}

/// Throws InputError unless the blend radius is zero: "r=...", or the fifth argument.
void check_ur_stop(const TextLine& line) {
    const std::vector<UrArgument> arguments = ur_arguments(line);
    for (std::size_t k = 0; k < arguments.size(); ++k) {
        const auto& [text, name, value] = arguments[k];
        const bool is_radius = name.empty() ? k == 4 : name == "r";
        if (!is_radius || (value.ok() && value.value == 0)) continue;
        throw line.error("does not stop at its position; must have r=0");
    }
    const std::string_view behind = trim(behind_call(line.text));
    if (behind.empty()) return;
    throw line.error(
        fmt::format("has {} behind its move; must stand in a line of its own", quote(behind)));
}

/// The routine of the moves, which must run once.
class UrRoutine {
  public:
    void take(const TextLine& line) {
        const std::string_view word = first_word(line.text);
        if (word == "def") {
            const std::string_view rest = trim(line.text.substr(word.size()));
            calls_.try_emplace(std::string(first_word(rest)));
            if (!is_found_) name_ = first_word(rest);
            line_ = is_found_ ? line_ : line;
            return;
        }
        for (std::size_t at = line.text.find('('); at != line.text.npos;
             at = line.text.find('(', at + 1)) {
            calls_[std::string(word_before(line.text, at))].push_back(line);
        }
    }
    void move() { is_found_ = true; }
    void check() const {
        if (!is_found_ || !line_) return;
        const std::vector<TextLine>& calls = calls_.at(name_);
        if (calls.empty()) {
            throw line_->error(fmt::format(
                "defines {}, which is never called, so that no move is made; must be, behind its "
                "end",
                quote(name_)));
        }
        if (calls.size() == 1) return;
        throw calls[1].error(
            fmt::format("calls {} again; must not, the poses are visited once then", quote(name_)));
    }

  private:
    std::string name_;
    std::optional<TextLine> line_;  ///< that defines it
    bool is_found_ = false;
    std::map<std::string, std::vector<TextLine>> calls_;
};

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
    const std::size_t move = line.text.find("movej(");
    const bool is_move = move != line.text.npos && word_before(line.text, move + 5) == "movej";
    if (is_move && !line.has("\"")) {
        throw line.error("moves under a condition; must be movej in a line of its own");
    }
}

std::vector<io::ProgramStop> read_ur(const std::string& path, const ControllerJoints& joints) {
    const ProgramFile file(path);
    StopCollector stops(ur_program().rules, joints);
    UrRoutine routine;
    for (const TextLine& whole : file.lines()) {
        check_ur(whole);
        const TextLine line = without_comment(whole);
        if (line.text.empty()) {
            stops.note(whole.text.substr(1));
        } else if (line.begins_with("movej")) {
            const std::string_view numbers = ur_joints(line);
            check_ur_stop(line);
            stops.move(line, read_numbers(line, numbers));
            routine.move();
        } else {
            check_ur_statement(line);
            stops.pass(line);
            routine.take(line);
        }
    }
    const std::vector<io::ProgramStop> read = stops.finish();
    routine.check();
    return read;
}

}  // namespace

const ProgramKind& ur_program() {
    static const ProgramKind kind{{.ending = ".script",
                                   .decimals = 6,
                                   .is_in_radians = true,
                                   .has_program_name = false,
                                   .words = urscript_words,
                                   .flow = {.routines = "def sec",
                                            .opens = "if while thread switch",
                                            .closes = "end",
                                            .leaves = "return halt",
                                            .has_then = false},
                                   .waits = "sleep popup",
                                   .messages = "textmsg popup",
                                   .moves = "movej movel movep movec servoj speedj speedl",
                                   .others = "movej movel movep movec optimovej optimovel servo* "
                                             "speedj speedl path_offset_* track_conveyor_* "
                                             "force_mode freedrive_mode* teach_mode screw_driving",
                                   .target = "([",
                                   .target_numbers = 6},
                                  &ur_files,
                                  &read_ur,
                                  &check_ur};
    return kind;
}

}  // namespace posewise::detail
