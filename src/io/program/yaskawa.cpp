#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_parts.hpp"
#include "program_stops.hpp"

/// Yaskawa INFORM jobs (.jbi) in pulses, whose lines end in CR LF.
namespace posewise::detail {
namespace {

constexpr std::size_t most_yaskawa_lines = 9999;
constexpr std::size_t other_yaskawa_lines = 3;  // before the first stop, and END
constexpr double most_pulses = 2147483647;

/// What begins instructions of INFORM that neither move nor shift.
constexpr std::string_view yaskawa_harmless =
    "NOP END RET ABORT CALL PAUSE TIMER WAIT CWAIT MSG PRINT CLEAR DOUT DIN PULSE AOUT AOUTON "
    "ARATION ARATIOF SET SETE SETFILE GETE GETS GETPOS GETFILE INC DEC ADD SUB MUL DIV AND OR NOT "
    "XOR "
    "CNVRT MFRAME MULMAT INVMAT SIN COS ATAN SQRT SETREG GETREG ADVINIT ADVSTOP VALUE STRVAL CHR$ "
    "MID$ ASC LEN CAT$ SPEED COMM IFTHEN IFTHENEXP ELSEIF ELSEIFEXP ELSE ENDIF FOR NEXT WHILE "
    "WHILEEXP ENDWHILE SWITCH CASE DEFAULT ENDSWITCH FUNCTION PSTART PWAIT UALM HAND HSEN SFTOF";

std::string pulses_text(const ControllerJoints& joints, const VectorXd& values) {
    std::string text;
    for (Index i = 0; i < values.size(); ++i) {
        const double pulses = values[i] * joints.pulses_per_unit()[i];
        if (!(std::abs(pulses) < most_pulses)) {
            throw InputError(fmt::format(
                "joint {} has {:.4g} pulses; must be fewer: look at controller.pulses_per_deg",
                i + 1, pulses));
        }
        fmt::format_to(std::back_inserter(text), "{}{}", i == 0 ? "" : ",", std::llround(pulses));
    }
    return text;
}

std::string yaskawa_stop(const io::RobotProgram& program, const io::ProgramStop& stop,
                         std::size_t number) {
    std::string text = fmt::format("'{}\r\nMOVJ C{:05} VJ={:.2f} PL=0\r\n", stop.label, number,
                                   static_cast<double>(program.speed_percent));
    if (!stop.is_measured) return text;
    for (const double wait : waits_of(yaskawa_program().rules, program, stop)) {
        text += fmt::format("TIMER T={:.2f}\r\n", wait);
    }
    if (program.handshake == io::Handshake::Pause) text += "PAUSE\r\n";
    if (program.handshake == io::Handshake::Io) {
        text += "DOUT OT#(1) ON\r\nWAIT IN#(1)=ON\r\nDOUT OT#(1) OFF\r\nWAIT IN#(1)=OFF\r\n";
    }
    return text;
}

/// "C00000" of "C00000=..." or "MOVJ C00000 VJ=...".
std::string position_name(const TextLine& line, std::size_t begin) {
    const std::string_view rest = line.text.substr(begin);
    const std::size_t end = std::min(rest.find_first_of(" =\t"), rest.size());
    return upper_case(std::string(rest.substr(0, end)));
}

/// Throws InputError for pulses behind those of the robot's joints that are not 0.
std::vector<double> degrees_of(const TextLine& move, const std::vector<double>& pulses,
                               const ControllerJoints& joints) {
    const auto is_moved = [](double one) { return one != 0; };
    const auto others = std::min(joints.count(), std::ssize(pulses));
    if (std::any_of(pulses.begin() + others, pulses.end(), is_moved)) {
        throw move.error(fmt::format(
            "moves to a position of {} axes; must be of {}, as the robot has, or the others 0",
            pulses.size(), joints.count()));
    }
    std::vector<double> degrees;
    for (std::size_t i = 0; i < pulses.size() && std::ssize(degrees) < joints.count(); ++i) {
        degrees.push_back(to_degrees(pulses[i] / joints.pulses_per_unit()[static_cast<Index>(i)]));
    }
    return degrees;
}

/// Throws InputError unless "MOVJ C00000 VJ=5.00 PL=0" ends in an exact stop of these axes only.
void check_yaskawa_move(const TextLine& line) {
    if (!line.has("PL=0")) throw line.error("does not stop at its position; must have PL=0");
    std::string_view rest = line.text;
    for (int position = 0; !rest.empty(); ++position) {
        const std::size_t blank = std::min(rest.find_first_of(" \t"), rest.size());
        const std::string capitals = upper_case(std::string(rest.substr(0, blank)));
        const std::string_view word = capitals;
        rest = trim(rest.substr(blank));
        if (position < 2) continue;
        if (word.starts_with("VJ=")) check_percent(line, word, word.substr(3));
        const bool is_known = word.starts_with("VJ=") || word == "PL=0" ||
                              word.starts_with("ACC=") || word.starts_with("DEC=");
        if (is_known) continue;
        throw line.error(
            fmt::format("has {}, which may lead elsewhere; must have none but VJ, PL, ACC and DEC",
                        quote(word)));
    }
}

/// Throws InputError unless "///NPOS 12,0,0,..." counts the positions.
void check_count(const TextLine& line, std::size_t count) {
    const double stated =
        read_numbers(line, line.text.substr(std::string_view("///NPOS").size())).front();
    if (stated == static_cast<double>(count)) return;
    throw line.error(fmt::format(
        "counts {} positions where the job states {}; lines were lost or added", stated, count));
}

/// Throws InputError unless the positions are in pulses of joints.
void check_kind(const TextLine& line) {
    if (line.begins_with("///POSTYPE") && !line.has("PULSE")) {
        throw line.error("states positions that are no joints; must be ///POSTYPE PULSE");
    }
    if (line.begins_with("///GROUP")) {
        const std::string_view group = first_word(line.text.substr(3));
        const std::string_view robot = first_word(trim(line.text.substr(3 + group.size())));
        if (!is_word(group, "GROUP1") || !is_word(robot, "RB1")) {
            throw line.error("moves another group than the robot; must be ///GROUP1 RB1");
        }
    }
    for (const char* const other : {"MOVL", "MOVC", "MOVS", "IMOV"}) {
        if (line.begins_with(other)) throw line.error("is no joint move; must be MOVJ");
    }
}

FileContent yaskawa_file(const std::string& path, const std::string& name,
                         const io::RobotProgram& program, const std::string& positions,
                         const std::string& body) {
    return {path, fmt::format("/JOB\r\n//NAME {}\r\n//POS\r\n///NPOS {},0,0,0,0,0\r\n///TOOL 0\r\n"
                              "///POSTYPE PULSE\r\n///PULSE\r\n{}//INST\r\n///DATE {}\r\n///ATTR "
                              "SC,RW\r\n///GROUP1 RB1\r\nNOP\r\n'{}\r\n{}END\r\n",
                              name, std::ranges::count(positions, '\n'), positions, program.date,
                              comment_text(program.title, 32), body)};
}

FileContent yaskawa_job(const std::string& path, const std::string& name,
                        const io::RobotProgram& program) {
    std::string positions;
    std::string body;
    for (std::size_t k = 0; k < program.stops.size(); ++k) {
        const io::ProgramStop& stop = program.stops[k];
        positions += fmt::format("C{:05}={}\r\n", k, pulses_text(program.joints, stop.joints));
        body += yaskawa_stop(program, stop, k);
    }
    return yaskawa_file(path, name, program, positions, body);
}

std::vector<FileContent> yaskawa_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = io::legal_program_name(io::ProgramFormat::Yaskawa, stem_of(path));
    const std::vector<io::RobotProgram> parts = parts_of(
        program, most_yaskawa_lines - other_yaskawa_lines, [&](const io::ProgramStop& stop) {
            return static_cast<std::size_t>(
                std::ranges::count(yaskawa_stop(program, stop, 0), '\n'));
        });
    if (parts.size() == 1) return {yaskawa_job(path, name, program)};
    const std::vector<std::string> names = part_names(yaskawa_program().rules, name, parts.size());
    std::string calls;
    for (const std::string& part : names) calls += fmt::format("CALL JOB:{}\r\n", part);
    std::vector<FileContent> files{yaskawa_file(path, name, program, "", calls)};
    for (std::size_t k = 0; k < parts.size(); ++k) {
        files.push_back(yaskawa_job(part_path(path, names[k]), names[k], parts[k]));
    }
    return files;
}

/// The file of the part that "CALL JOB:NAME_1" calls; empty: it calls none.
std::string called_yaskawa_part(const std::string& path, const TextLine& line) {
    constexpr std::string_view call = "CALL JOB:";
    if (!line.begins_with(call)) return "";
    return part_path(path, trim(line.text.substr(call.size())));
}

/// The stops of a file and, if it has parts, of the jobs NAME_1 ... that it calls.
std::vector<io::ProgramStop> read_yaskawa_job(const std::string& path,
                                              const ControllerJoints& joints, bool has_parts) {
    const ProgramFile file(path, "END");
    std::map<std::string, std::vector<double>> positions;
    StopCollector stops(yaskawa_program().rules, joints);
    bool is_instruction = false;
    std::optional<TextLine> counted;
    for (const TextLine& line : file.lines()) {
        check_kind(line);
        if (line.begins_with("//INST")) is_instruction = true;
        const std::size_t equals = line.text.find('=');
        if (line.begins_with("'")) {
            stops.note(line.text.substr(1));
        } else if (line.begins_with("///NPOS")) {
            counted = line;
        } else if (!is_instruction) {
            if (!line.begins_with("C") || equals == std::string_view::npos) continue;
            positions[position_name(line, 0)] = read_numbers(line, line.text.substr(equals + 1));
        } else if (line.begins_with("MOVJ")) {
            check_yaskawa_move(line);
            const auto found =
                positions.find(position_name(line, std::min<std::size_t>(5, line.text.size())));
            if (found == positions.end()) {
                throw line.error(
                    "moves to a position that the job does not state; must be like MOVJ C00000");
            }
            stops.move(line, degrees_of(line, found->second, joints));
        } else if (const std::string part = called_yaskawa_part(path, line);
                   has_parts && !part.empty()) {
            stops.call(line, read_part(line, part, joints, &read_yaskawa_job));
        } else {
            if (line.begins_with("TIMER") && equals != std::string_view::npos) {
                check_time(line, line.text, line.text.substr(equals + 1));
            }
            stops.pass(line);
        }
    }
    if (counted) check_count(*counted, positions.size());
    return stops.finish();
}

std::vector<io::ProgramStop> read_yaskawa(const std::string& path, const ControllerJoints& joints) {
    return read_yaskawa_job(path, joints, true);
}

}  // namespace

const ProgramKind& yaskawa_program() {
    static const ProgramKind kind{{.ending = ".jbi",
                                   .decimals = 0,
                                   .longest_name = 32,
                                   .has_parts = true,
                                   .is_upper = true,
                                   .wait_step = 0.01,
                                   .longest_wait = 655.35,  // 2^16 - 1 steps
                                   .flow = {.opens = "IFTHEN IFTHENEXP FOR WHILE WHILEEXP SWITCH",
                                            .closes = "ENDIF NEXT ENDWHILE ENDSWITCH",
                                            .jumps = "JUMP",
                                            .leaves = "RET ABORT"},
                                   .waits = "TIMER PAUSE WAIT CALL",
                                   .harmless = yaskawa_harmless,
                                   .target = " C0"},
                                  &yaskawa_files,
                                  &read_yaskawa};
    return kind;
}

}  // namespace posewise::detail
