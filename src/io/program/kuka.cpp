#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iterator>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_parts.hpp"
#include "program_stops.hpp"
#include "reserved_words.hpp"

/// KUKA KRL (.src, .dat).
namespace posewise::detail {
namespace {

constexpr std::size_t most_kuka_lines = 1400;
constexpr std::size_t other_kuka_lines = 20;  // those before the first stop, and END

constexpr std::string_view krl_header = "&ACCESS RVP\n&REL 1\n";

constexpr std::string_view kuka_others =
    "PTP PTP_REL SPTP SPTP_REL LIN LIN_REL SLIN SLIN_REL CIRC CIRC_REL SCIRC SCIRC_REL SPL SPL_REL "
    "SPLINE PTP_SPLINE ASYPTP";
/// What begins statements of KRL that are none of these, nor calls, assignments or labels.
constexpr std::string_view kuka_harmless =
    "DEF DEFFCT DEFDAT END ENDFCT ENDDAT GLOBAL PUBLIC DECL CONST EXT EXTFCT EXTP IMPORT ENUM "
    "STRUC "
    "SIGNAL INT REAL BOOL CHAR FRAME POS E3POS E6POS AXIS E3AXIS E6AXIS LOAD IF THEN ELSE ENDIF "
    "FOR "
    "ENDFOR WHILE ENDWHILE LOOP ENDLOOP REPEAT UNTIL SWITCH CASE DEFAULT ENDSWITCH EXIT WAIT HALT "
    "GOTO RETURN RESUME BRAKE CONTINUE INTERRUPT TRIGGER ANIN ANOUT DIGIN CHANNEL CONFIRM";

/// Lines of one stop, each ended.
std::string kuka_stop(const io::RobotProgram& program, const io::ProgramStop& stop) {
    const ProgramRules& rules = kuka_program().rules;
    std::string text = fmt::format("; {}\nPTP {{", stop.label);
    for (Index i = 0; i < stop.joints.size(); ++i) {
        fmt::format_to(std::back_inserter(text), "{}A{} {}", i == 0 ? "" : ",", i + 1,
                       joint_text(rules, program.joints.motion(i), stop.joints[i]));
    }
    text += "}\n";
    if (!stop.is_measured) return text;
    for (const double wait : waits_of(rules, program, stop)) {
        text += fmt::format("WAIT SEC {}\n", seconds_text(wait));
    }
    if (program.handshake == io::Handshake::Pause) text += "HALT\n";
    if (program.handshake == io::Handshake::Io) {
        text += "$OUT[1]=TRUE\nWAIT FOR $IN[1]\n$OUT[1]=FALSE\nWAIT FOR NOT $IN[1]\n";
    }
    return text;
}

/// What a program does first, the interpolation's data, and no jump at the first block; then its
/// stops.
std::string kuka_body(const io::RobotProgram& program) {
    std::string text =
        fmt::format("BAS(#INITMOV,0)\nBAS(#VEL_PTP,{})\n$TOOL=$NULLFRAME\nPTP $AXIS_ACT\n",
                    program.speed_percent);
    for (const io::ProgramStop& stop : program.stops) text += kuka_stop(program, stop);
    return text;
}

void add_module(const std::string& path, const std::string& name, const std::string& body,
                std::vector<FileContent>& files) {
    files.push_back({sibling_of(path, name + ending_of(path)),
                     fmt::format("{}DEF {}( )\n{}END\n", krl_header, name, body)});
    files.push_back(
        {sibling_of(path, name + ".dat"), fmt::format("{}DEFDAT {}\nENDDAT\n", krl_header, name)});
}

/// Throws InputError for an axis "E1 10.0" that is not one of the robot's joints, unless it is 0.
void check_external_axis(const TextLine& line, std::string_view axis) {
    const std::size_t blank = std::min(axis.find_first_of(" \t"), axis.size());
    if (read_numbers(line, axis.substr(blank)).front() == 0) return;
    throw line.error(
        fmt::format("has {}, an axis that is not of the robot's joints; must be 0", quote(axis)));
}

/// The numbers of "{A1 10.00,A2 -90.0, ...}", in order.
std::vector<double> read_axes(const TextLine& line) {
    const std::size_t open = line.text.find('{');
    const std::size_t close = line.text.find('}', std::min(open, line.text.size()));
    if (close == std::string_view::npos) {
        throw line.error("is no joint move to numbers; must be like PTP {A1 10.0,A2 -90.0,...}");
    }
    std::string_view rest = line.text.substr(open + 1, close - open - 1);
    if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
        rest.remove_prefix(colon + 1);  // {E6AXIS: A1 ...}
    }
    std::vector<double> numbers;
    while (!rest.empty()) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        const std::string_view one = trim(rest.substr(0, comma));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        if (one.starts_with('E') || one.starts_with('e')) {
            check_external_axis(line, one);
            continue;
        }
        const std::string name = fmt::format("A{}", numbers.size() + 1);
        if (upper_case(std::string(one.substr(0, name.size()))) != name) {
            throw line.error(fmt::format("has {} where {} must be", quote(one), name));
        }
        numbers.push_back(read_numbers(line, one.substr(name.size())).front());
    }
    return numbers;
}

/// Throws InputError unless the move to joints ends in an exact stop.
void check_kuka_move(const TextLine& line) {
    if (line.has("C_PTP") || line.has("C_DIS")) {
        throw line.error("does not stop at its position; must have no C_PTP");
    }
    const std::string_view behind =
        trim(line.text.substr(std::min(line.text.find('}'), line.text.size() - 1) + 1));
    if (behind.empty()) return;
    throw line.error(
        fmt::format("has {} behind its target; must stand in a line of its own", quote(behind)));
}

void check_kuka_statement(const TextLine& line) {
    for (const char* const other : {"LIN", "CIRC", "SPL", "SPTP", "SLIN", "SCIRC", "ASYPTP"}) {
        if (line.begins_with(other)) throw line.error("is no joint move; must be PTP {A1 ...}");
    }
}

/// What stands before a comment.
TextLine without_comment(TextLine line) {
    line.text = trim(line.text.substr(0, line.text.find(';')));
    return line;
}

void check_kuka(const TextLine& line) {
    const TextLine statement = without_comment(line);
    const std::string_view moves = kuka_program().rules.moves;
    check_target(kuka_program().rules, statement, moves);
    if (is_word(first_word(statement.text), moves)) check_brackets(statement);
    const std::string_view text = statement.text;
    if (const std::size_t wait = text.find("SEC");
        statement.begins_with("WAIT") && wait != text.npos) {
        check_time(statement, text, text.substr(wait + 3));
    }
    const std::string_view speed = "#VEL_PTP";
    if (const std::size_t set = text.find(speed);
        statement.begins_with("BAS") && set != text.npos) {
        const std::size_t comma = std::min(text.find(',', set), text.size() - 1);
        check_percent(statement, text, text.substr(comma + 1, text.find(')', comma) - comma - 1));
    }
}

/// The file of the part that "NAME_1( )" calls; empty: it calls none.
std::string called_kuka_part(const std::string& path, const TextLine& line) {
    const std::size_t open = line.text.find('(');
    if (open == std::string_view::npos || !line.text.ends_with(')')) return "";
    return part_path(path, trim(line.text.substr(0, open)));
}

/// The stops of a file and, if it has parts, of the programs NAME_1 ... that it calls.
std::vector<io::ProgramStop> read_kuka_module(const std::string& path,
                                              const ControllerJoints& joints, bool has_parts) {
    const ProgramFile file(path, "END");
    StopCollector stops(kuka_program().rules, joints);
    for (const TextLine& line : file.lines()) {
        check_kuka(line);
        if (line.begins_with(";FOLD") || line.begins_with(";ENDFOLD")) continue;
        if (line.begins_with(";")) {
            stops.note(line.text.substr(1));
        } else if (const std::string part = called_kuka_part(path, line);
                   has_parts && !part.empty()) {
            stops.call(line, read_part(line, part, joints, &read_kuka_module));
        } else if (line.begins_with("PTP") && line.has("$AXIS_ACT")) {
            continue;
        } else if (line.begins_with("PTP_REL")) {
            throw line.error("is no move to joints; must be PTP {A1 ...}");
        } else if (line.begins_with("PTP")) {
            const std::vector<double> numbers = read_axes(line);
            check_kuka_move(without_comment(line));
            stops.move(line, numbers);
        } else {
            check_kuka_statement(line);
            stops.pass(without_comment(line));
        }
    }
    return stops.finish();
}

std::vector<FileContent> kuka_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = stem_of(path);
    const std::vector<io::RobotProgram> parts =
        parts_of(program, most_kuka_lines - other_kuka_lines, [&](const io::ProgramStop& stop) {
            return static_cast<std::size_t>(std::ranges::count(kuka_stop(program, stop), '\n'));
        });
    const std::string title = fmt::format("; {}\n", comment_text(program.title));
    std::vector<FileContent> files;
    if (parts.size() == 1) {
        add_module(path, name, title + kuka_body(program), files);
        return files;
    }
    const std::vector<std::string> names = part_names(kuka_program().rules, name, parts.size());
    add_module(path, name, fmt::format("{}{}( )\n", title, fmt::join(names, "( )\n")), files);
    for (std::size_t k = 0; k < parts.size(); ++k) {
        add_module(path, names[k], kuka_body(parts[k]), files);
    }
    return files;
}

std::vector<io::ProgramStop> read_kuka(const std::string& path, const ControllerJoints& joints) {
    return read_kuka_module(path, joints, true);
}

}  // namespace

const ProgramKind& kuka_program() {
    static const ProgramKind kind{
        {.ending = ".src",
         .decimals = 5,
         .longest_name = 20,
         .has_parts = true,
         .words = krl_words,
         .flow = {.routines = "DEF DEFFCT",
                  .opens = "IF FOR WHILE LOOP REPEAT SWITCH",
                  .closes = "END ENDFCT ENDIF ENDFOR ENDWHILE ENDLOOP UNTIL ENDSWITCH",
                  .jumps = "GOTO RESUME",
                  .leaves = "RETURN",
                  .modifiers = "GLOBAL"},
         .waits = "WAIT HALT",
         .moves = "PTP PTP_REL SPTP SPTP_REL LIN LIN_REL SLIN CIRC SCIRC SPL",
         .others = kuka_others,
         .harmless = kuka_harmless,
         .target = "{A1",
         .target_numbers = 6},
        &kuka_files,
        &read_kuka,
        &check_kuka};
    return kind;
}

}  // namespace posewise::detail
