#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_stops.hpp"
#include "reserved_words.hpp"

/// ABB RAPID modules (.mod), whose lines end in CR LF.
namespace posewise::detail {
namespace {

/// Speeds of the controller's v1000, of which the program takes its per cent: mm/s and deg/s.
constexpr Index tcp_speed = 1000;
constexpr Index turn_speed = 500;

std::string with_carriage_returns(const std::string& text) {
    std::string lines;
    for (const char letter : text) {
        if (letter == '\n') lines += '\r';
        lines += letter;
    }
    return lines;
}

std::string abb_stop(const io::RobotProgram& program, const io::ProgramStop& stop) {
    const ProgramRules& rules = abb_program().rules;
    std::string text = fmt::format(
        "    ! {}\n    MoveAbsJ [[{}],[9E9,9E9,9E9,9E9,9E9,9E9]]\\NoEOffs,slow,fine,tool0;\n",
        stop.label, joints_text(rules, program.joints, stop.joints, ","));
    if (!stop.is_measured) return text;
    text += fmt::format("    TPWrite \"{}\";\n", stop.label);
    for (const double wait : waits_of(rules, program, stop)) {
        text += fmt::format("    WaitTime \\InPos,{};\n", seconds_text(wait));
    }
    if (program.handshake == io::Handshake::Pause) text += "    Stop;\n";
    if (program.handshake == io::Handshake::Io) {
        text += "    SetDO do1,1;\n    WaitDI di1,1;\n    SetDO do1,0;\n    WaitDI di1,0;\n";
    }
    return text;
}

/// What is between the first "[[" and the "]" after it.
std::string_view abb_joints(const TextLine& line) {
    const std::size_t open = line.text.find("[[");
    const std::size_t close = line.text.find(']', std::min(open, line.text.size()));
    if (close == std::string_view::npos) {
        throw line.error("is no joint move to numbers; must be like MoveAbsJ [[0,0,0,0,90,0],[...");
    }
    return line.text.substr(open + 2, close - open - 2);
}

std::vector<FileContent> abb_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = io::legal_program_name(io::ProgramFormat::Abb, stem_of(path));
    std::string text = fmt::format(
        "MODULE {}\n  ! {}\n  LOCAL CONST speeddata slow:=[{},{},{},{}];\n  PROC {}_run()\n", name,
        comment_text(program.title), tcp_speed * program.speed_percent / 100,
        turn_speed * program.speed_percent / 100, tcp_speed * program.speed_percent / 100,
        turn_speed * program.speed_percent / 100, name);
    for (const io::ProgramStop& stop : program.stops) text += abb_stop(program, stop);
    return {{path, with_carriage_returns(text + "  ENDPROC\nENDMODULE\n")}};
}

/// The statements of a line, and its comment with the mark in front.
std::vector<TextLine> abb_statements(const TextLine& line) {
    std::vector<TextLine> statements;
    const auto add = [&](std::size_t begin, std::size_t end) {
        const std::string_view text = trim(line.text.substr(begin, end - begin));
        if (text.empty()) return;
        TextLine& statement = statements.emplace_back(line);
        statement.text = text;
        statement.place.column += text.data() - line.text.data();
    };
    std::size_t begin = 0;
    bool is_quoted = false;
    for (std::size_t k = 0; k < line.text.size(); ++k) {
        const char letter = line.text[k];
        if (letter == '"') is_quoted = !is_quoted;
        if (is_quoted || (letter != ';' && letter != '!')) continue;
        add(begin, k);
        begin = letter == '!' ? k : k + 1;
        if (letter == '!') break;
    }
    add(begin, line.text.size());
    return statements;
}

/// Throws InputError for a time to wait below 0, and for a declared speed of the tool or of its
/// turning, the first two of a speeddata, that is not above 0.
void check_abb_amounts(const TextLine& statement) {
    const std::string_view text = statement.text;
    if (statement.begins_with("WaitTime")) {
        check_time(statement, text, text.substr(std::max<std::size_t>(text.rfind(',') + 1, 8)));
    }
    const std::size_t open = text.find(":=[");
    if (!statement.has("speeddata") || open == text.npos) return;
    const std::string_view speeds = text.substr(open + 3);
    const std::size_t comma = std::min(speeds.find(','), speeds.size() - 1);
    check_speed(statement, text, speeds.substr(0, comma));
    const std::string_view turning = speeds.substr(comma + 1);
    check_speed(statement, text, turning.substr(0, turning.find_first_of(",]")));
}

void check_abb(const TextLine& line) {
    const std::string_view moves = abb_program().rules.moves;
    for (const TextLine& statement : abb_statements(line)) {
        if (statement.begins_with("!")) continue;
        // What begins with a bracket goes on with an array of the line before.
        if (!statement.begins_with("[")) check_target(abb_program().rules, statement, moves);
        check_abb_amounts(statement);
        if (!is_word(first_word(statement.text), moves)) continue;
        if (statement.text.ends_with(',')) continue;  // goes on in the next line
        const auto end = statement.text.data() + statement.text.size() - line.text.data();
        if (!line.text.substr(static_cast<std::size_t>(end)).starts_with(';')) {
            throw statement.error("has no ; at its end; must have one, in the same line");
        }
        check_brackets(statement);
    }
}

/// Throws InputError unless the move to joints ends in an exact stop, and moves nothing else.
void check_abb_move(const TextLine& line) {
    if (!line.has(",fine,") && !line.has(", fine,")) {
        throw line.error("does not stop at its position; must have the zone fine");
    }
    const std::size_t open = line.text.find('[', line.text.find(']'));
    const std::size_t close = line.text.find(']', std::min(open, line.text.size()));
    if (close == std::string_view::npos) return;
    for (const double axis : read_numbers(line, line.text.substr(open + 1, close - open - 1))) {
        if (axis == 0 || axis == 9e9) continue;
        throw line.error(fmt::format(
            "moves an external axis to {}, which is not of the robot's joints; must be 9E9", axis));
    }
}

/// Whether a call has a speed or a zone of RAPID among its arguments, as moves and processes have.
bool has_move_arguments(const TextLine& statement) {
    std::string_view rest = statement.text.substr(0, statement.text.find('"'));
    if (rest.find(":=") < rest.find(',')) return false;  // an assignment
    while (!rest.empty()) {
        const std::size_t comma = std::min(rest.find(','), rest.size());
        const std::string one = lower_case(std::string(trim(rest.substr(0, comma))));
        rest.remove_prefix(std::min(comma + 1, rest.size()));
        const bool is_numbered = one.size() > 1 && (one[0] == 'v' || one[0] == 'z') &&
                                 one.find_first_not_of("0123456789", 1) == one.npos;
        if (is_numbered || one == "vmax" || one == "fine") return true;
    }
    return false;
}

void check_abb_statement(const TextLine& line) {
    if (line.begins_with("%")) {
        throw line.error("calls a routine whose name is calculated; must be MoveAbsJ by its name");
    }
    for (const char* const other : {"MoveJ", "MoveL", "MoveC", "MoveExtJ"}) {
        if (line.begins_with(other)) throw line.error("is no move to joints; must be MoveAbsJ");
    }
    if (line.has("MoveAbsJ") && !line.has("\"")) {
        throw line.error("moves under a condition; must be MoveAbsJ in a statement of its own");
    }
}

std::vector<io::ProgramStop> read_abb(const std::string& path, const ControllerJoints& joints) {
    const ProgramFile file(path, "ENDMODULE");
    StopCollector stops(abb_program().rules, joints);
    for (const TextLine& line : file.lines()) {
        for (const TextLine& one : abb_statements(line)) {
            if (one.begins_with("!")) {
                stops.note(one.text.substr(1));
            } else if (one.begins_with("MoveAbsJ")) {
                if (one.text.ends_with(',')) {
                    throw one.error("goes on in the next line; must stand in one");
                }
                const std::vector<double> numbers = read_numbers(one, abb_joints(one));
                check_abb_move(one);
                stops.move(one, numbers);
            } else {
                check_abb_statement(one);
                stops.pass(one);
                if (has_move_arguments(one)) {
                    throw one.error(
                        "has a speed or a zone as moves have; must be MoveAbsJ, or be removed");
                }
            }
        }
        check_abb(line);
    }
    return stops.finish();
}

}  // namespace

const ProgramKind& abb_program() {
    static const ProgramKind kind{
        {.ending = ".mod",
         .decimals = 4,
         .has_program_name = false,
         .longest_name = 28,
         .words = rapid_words,
         .flow = {.routines = "PROC FUNC TRAP",
                  .opens = "IF FOR WHILE TEST",
                  .closes = "ENDPROC ENDFUNC ENDTRAP ENDIF ENDFOR ENDWHILE ENDTEST",
                  .jumps = "GOTO",
                  .leaves = "RETURN EXIT ExitCycle ERROR UNDO BACKWARD RAISE",
                  .modifiers = "LOCAL TASK"},
         .waits = "WaitTime WaitDI WaitUntil Stop Break",
         .messages = "TPWrite",
         .moves = "MoveAbsJ MoveAbsJDO MoveAbsJAO MoveAbsJGO TriggAbsJ",
         .others = "MoveL* MoveJ* MoveC* MoveExtJ TriggL* TriggJ* TriggC* TriggAbsJ ArcL* ArcC* "
                   "SearchL SearchC SearchExtJ EOffsOn EOffsSet SoftAct IndAMove IndCMove IndDMove "
                   "IndRMove PathRecMoveBwd PathRecMoveFwd StepBwdPath ManLoadIdProc LoadId",
         .target = "[[",
         .target_numbers = 6},
        &abb_files,
        &read_abb,
        &check_abb};
    return kind;
}

}  // namespace posewise::detail
