#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "io/format/text.hpp"
#include "program_text.hpp"

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
    if (const double dwell = dwell_of(program, stop); dwell > 0) {
        text += fmt::format("    WaitTime \\InPos,{};\n", seconds_text(dwell));
    }
    text += fmt::format("    TPWrite \"{}\";\n", stop.label);
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

std::vector<io::ProgramStop> read_abb(const std::string& path, const ControllerJoints& joints) {
    const ProgramFile file(path, "ENDMODULE");
    std::vector<io::ProgramStop> stops;
    std::string comment;
    for (const TextLine& line : file.lines()) {
        if (line.begins_with("!")) note_comment(line.text.substr(1), comment);
        for (const char* const other : {"MoveJ", "MoveL", "MoveC"}) {
            if (line.begins_with(other)) throw line.error("is no move to joints; must be MoveAbsJ");
        }
        if (!line.begins_with("MoveAbsJ")) continue;
        if (!line.has(",fine,") && !line.has(", fine,")) {
            throw line.error("does not stop at its position; must have the zone fine");
        }
        stops.push_back(make_stop(line, abb_program().rules, joints,
                                  read_numbers(line, abb_joints(line)), comment));
    }
    return stops;
}

}  // namespace

const ProgramKind& abb_program() {
    static const ProgramKind kind{
        {.ending = ".mod",
         .decimals = 4,
         .has_program_name = false,
         .longest_name = 28,
         .words = "ALIAS AND BACKWARD CASE CONNECT CONST DEFAULT DIV DO ELSE ELSEIF "
                  "ENDFOR ENDFUNC ENDIF ENDMODULE ENDPROC ENDRECORD ENDTEST ENDTRAP "
                  "ENDWHILE ERROR EXIT FALSE FOR FROM FUNC GOTO IF INOUT LOCAL MOD MODULE "
                  "NOSTEPIN NOT NOVIEW OR PERS PROC RAISE READONLY RECORD RETRY RETURN "
                  "STEP SYSMODULE TASK TEST THEN TO TRAP TRUE TRYNEXT UNDO VAR VIEWONLY "
                  "WHILE WITH XOR main user base"},
        &abb_files,
        &read_abb};
    return kind;
}

}  // namespace posewise::detail
