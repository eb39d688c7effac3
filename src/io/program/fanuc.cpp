#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "program_parts.hpp"
#include "program_stops.hpp"

/// FANUC TP programs as text (.LS).
namespace posewise::detail {
namespace {

constexpr std::size_t most_fanuc_lines = 9999;
constexpr std::size_t other_fanuc_lines = 3;  // before the first stop

class FanucBody {
  public:
    /// `text` in the column where a motion begins.
    void add(std::string_view text) {
        ++count_;
        fmt::format_to(std::back_inserter(text_), "{:4}:{} ;\n", count_, text);
    }
    std::size_t count() const { return count_; }
    const std::string& text() const { return text_; }

  private:
    std::size_t count_ = 0;
    std::string text_;
};

void add_fanuc_stop(const io::RobotProgram& program, const io::ProgramStop& stop,
                    std::size_t number, FanucBody& body) {
    body.add(fmt::format("  !{}", stop.label));
    body.add(fmt::format("J P[{}] {}% FINE   ", number, program.speed_percent));
    if (!stop.is_measured) return;
    for (const double wait : waits_of(fanuc_program().rules, program, stop)) {
        body.add(fmt::format("  WAIT {:6.2f}(sec)", wait));
    }
    if (program.handshake == io::Handshake::Pause) body.add("  PAUSE");
    if (program.handshake == io::Handshake::Io) {
        for (const char* const step :
             {"  DO[1]=ON", "  WAIT DI[1]=ON", "  DO[1]=OFF", "  WAIT DI[1]=OFF"}) {
            body.add(step);
        }
    }
}

std::string fanuc_position(const io::RobotProgram& program, const io::ProgramStop& stop,
                           std::size_t number) {
    const ProgramRules& rules = fanuc_program().rules;
    std::string text = fmt::format("P[{}]{{\n   GP1:\n\tUF : 0, UT : 1,\n", number);
    for (Index i = 0; i < stop.joints.size(); ++i) {
        const bool ends_line = i % 3 == 2 || i + 1 == stop.joints.size();
        fmt::format_to(std::back_inserter(text), "\tJ{}= {:>9} deg{}{}", i + 1,
                       joint_text(rules, program.joints.motion(i), stop.joints[i]),
                       i + 1 == stop.joints.size() ? "" : ",", ends_line ? "\n" : "");
    }
    return text + "};\n";
}

/// The number in the brackets that follow, as in "P[3:P003]".
std::size_t read_fanuc_index(const TextLine& line, std::string_view text) {
    const std::size_t end = text.find_first_of(":]");
    const ParsedNumber number = parse_number(trim(text.substr(0, end)));
    if (end == std::string_view::npos || !number.ok() ||
        !(number.value >= 1 && number.value < 1e6)) {
        throw line.error("names no position; must be like P[1]");
    }
    return static_cast<std::size_t>(number.value);
}

/// The joints of "J1= 10.000 deg, J2= ...". Throws InputError for axes that no plan moves, which
/// are E1 and those of other groups, unless they are 0.
void read_fanuc_axes(const TextLine& line, bool is_first_group, std::vector<double>& joints) {
    const std::string lower = lower_case(std::string(line.text));
    std::string_view rest = lower;
    for (std::size_t at = rest.find('='); at != std::string_view::npos; at = rest.find('=')) {
        const std::string_view before = rest.substr(0, at);
        const std::string name = upper_case(std::string(
            trim(before.substr(std::min(before.find_first_not_of(", \t"), before.size())))));
        rest.remove_prefix(at + 1);
        const std::size_t end = std::min(rest.find("deg"), rest.find("mm"));
        const bool is_other = name.starts_with('E') || !is_first_group;
        const bool is_joint = !is_other && name.starts_with('J') && end == rest.find("deg");
        if ((!is_joint && !is_other) || end >= rest.size()) return;
        const std::vector<double> values = read_numbers(line, rest.substr(0, end));
        if (values.size() != 1) {
            throw line.error(fmt::format("has {} at {}; must be one number, with a point",
                                         quote(std::string(trim(rest.substr(0, end)))), name));
        }
        const double value = values.front();
        const std::string wanted = fmt::format("J{}", joints.size() + 1);
        if (is_joint && name != wanted) {
            throw line.error(fmt::format("has {} where {} must be", name, wanted));
        }
        if (is_joint) joints.push_back(value);
        if (is_other && value != 0) {
            throw line.error(
                fmt::format("has {} at {}, an axis that is not of the robot's joints; must be 0",
                            name, trim(rest.substr(0, end))));
        }
        rest.remove_prefix(end);
        rest.remove_prefix(std::min(rest.find_first_of(", \t"), rest.size()));
    }
}

/// The first group's joints of each position; a Cartesian one has none.
std::map<std::size_t, std::vector<double>> read_fanuc_positions(const std::vector<TextLine>& lines,
                                                                std::size_t begin) {
    std::map<std::size_t, std::vector<double>> positions;
    std::vector<double>* joints = nullptr;
    bool is_first_group = true;
    for (std::size_t k = begin; k < lines.size(); ++k) {
        const TextLine& line = lines[k];
        if (line.begins_with("/END")) break;
        if (line.begins_with("P[")) {
            joints = &positions[read_fanuc_index(line, line.text.substr(2))];
            is_first_group = true;
        } else if (line.begins_with("GP")) {
            is_first_group = line.begins_with("GP1");
        }
        if (joints != nullptr) read_fanuc_axes(line, is_first_group, *joints);
    }
    return positions;
}

/// What stands behind a line's number, without the semicolon.
TextLine fanuc_statement(TextLine line) {
    const std::size_t colon = line.text.find(':');
    if (colon == std::string_view::npos) return line;
    std::string_view text = line.text.substr(colon + 1);
    if (const std::size_t end = text.rfind(';'); end != std::string_view::npos) {
        text = text.substr(0, end);
    }
    text = trim(text);
    if (!text.empty()) line.place.column += text.data() - line.text.data();
    line.text = text;
    return line;
}

/// The number of the position that a move, or the line that goes on with it, leads to; 0: none.
std::size_t fanuc_move_index(const TextLine& statement) {
    const std::string_view word = first_word(statement.text);
    const bool goes_on = is_word(word, "P");
    const std::string_view rest =
        goes_on ? statement.text : trim(statement.text.substr(word.size()));
    const bool is_move = goes_on || is_word(word, fanuc_program().rules.moves);
    if (!is_move || !is_word(rest.substr(0, 2), "P[")) return 0;
    return read_fanuc_index(statement, rest.substr(2));
}

void check_fanuc(const TextLine& line) {
    const TextLine statement = fanuc_statement(line);
    for (const char* const comment : {"!", "//", "--"}) {
        if (statement.begins_with(comment)) return;
    }
    check_target(fanuc_program().rules, statement, fanuc_program().rules.moves);
    const std::string_view text = statement.text;
    if (statement.begins_with("WAIT")) {
        const std::string_view time = trim(text.substr(4));
        check_time(statement, time, time.substr(0, time.find('(')));
    }
    if (fanuc_move_index(statement) == 0) return;
    std::string_view speed = trim(text.substr(text.find(']') + 1));
    speed = speed.substr(0, speed.find_first_of(" \t"));
    const std::string_view number = speed.substr(0, speed.find_first_not_of("+-.0123456789"));
    speed.ends_with('%') ? check_percent(statement, speed, number)
                         : check_speed(statement, speed, number);
}

/// Throws InputError where a position is stated twice, or a move's nowhere.
void check_fanuc_positions(const std::vector<TextLine>& lines) {
    const auto begins = [](std::string_view word) {
        return [word](const TextLine& line) { return line.begins_with(word); };
    };
    const auto moves = std::ranges::find_if(lines, begins("/MN"));
    const auto positions = std::find_if(moves, lines.end(), begins("/POS"));
    std::set<std::size_t> stated;
    for (auto line = positions; line != lines.end() && !line->begins_with("/END"); ++line) {
        if (!line->begins_with("P[")) continue;
        if (stated.insert(read_fanuc_index(*line, line->text.substr(2))).second) continue;
        throw line->error("states a position twice");
    }
    for (auto line = moves; line != positions; ++line) {
        const TextLine statement = fanuc_statement(*line);
        const std::size_t index = fanuc_move_index(statement);
        if (index == 0 || stated.contains(index)) continue;
        throw statement.error(
            fmt::format("moves to P[{}], which is not under /POS; must be there", index));
    }
}

FileContent fanuc_file(const std::string& path, const std::string& name, const FanucBody& body,
                       const std::string& positions) {
    return {path, fmt::format("/PROG  {}\n/ATTR\nCOMMENT\t\t= \"posewise\";\nDEFAULT_GROUP\t= "
                              "1,*,*,*,*;\n/MN\n{}/POS\n{}/END\n",
                              name, body.text(), positions)};
}

FileContent fanuc_module(const std::string& path, const std::string& name,
                         const io::RobotProgram& program) {
    FanucBody body;
    std::string positions;
    body.add(fmt::format("  !{}", comment_text(program.title, 32)));
    body.add("  UFRAME_NUM=0");
    body.add("  UTOOL_NUM=1");
    for (std::size_t k = 0; k < program.stops.size(); ++k) {
        add_fanuc_stop(program, program.stops[k], k + 1, body);
        positions += fanuc_position(program, program.stops[k], k + 1);
    }
    return fanuc_file(path, name, body, positions);
}

std::vector<FileContent> fanuc_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = io::legal_program_name(io::ProgramFormat::Fanuc, stem_of(path));
    const std::vector<io::RobotProgram> parts =
        parts_of(program, most_fanuc_lines - other_fanuc_lines, [&](const io::ProgramStop& stop) {
            FanucBody body;
            add_fanuc_stop(program, stop, 1, body);
            return body.count();
        });
    if (parts.size() == 1) return {fanuc_module(path, name, program)};
    const std::vector<std::string> names = part_names(fanuc_program().rules, name, parts.size());
    FanucBody calls;
    calls.add(fmt::format("  !{}", comment_text(program.title, 32)));
    for (const std::string& part : names) calls.add("  CALL " + part);
    std::vector<FileContent> files{fanuc_file(path, name, calls, "")};
    for (std::size_t k = 0; k < parts.size(); ++k) {
        files.push_back(fanuc_module(part_path(path, names[k]), names[k], parts[k]));
    }
    return files;
}

/// Throws InputError unless the joint move ends in an exact stop at its position.
void check_fanuc_move(const TextLine& line) {
    if (!line.has("FINE")) throw line.error("does not stop at its position; must end FINE");
    const std::size_t fine = upper_case(std::string(line.text)).find("FINE");
    const std::string_view options = trim(line.text.substr(fine + 4));
    if (options.empty() || is_word(options.substr(0, 3), "ACC")) return;
    throw line.error(fmt::format(
        "has {} after FINE, which may lead elsewhere; must have none but ACC", quote(options)));
}

void check_fanuc_statement(const TextLine& line) {
    for (const char* const other : {"L P", "C P", "A P", "S P", "J PR"}) {
        if (!line.begins_with(other)) continue;
        throw line.error("is no joint move to a position of the program; must be J P[...]");
    }
    if (!line.begins_with("P[")) return;
    throw line.error("changes a position as the program runs; must be removed");
}

/// Throws InputError unless the group of "DEFAULT_GROUP = 1,*,*,*,*;" that moves is the first.
void check_fanuc_group(const TextLine& line) {
    const std::size_t sign = line.text.find('=');
    if (!line.begins_with("DEFAULT_GROUP") || sign == std::string_view::npos) return;
    const std::string_view groups = trim(line.text.substr(sign + 1));
    if (trim(groups.substr(0, groups.find_first_of(",;"))) == "1") return;
    throw line.error("moves another group than the first, which is the robot; must be 1,*,*,*,*");
}

/// The file of the part that "CALL NAME_1" calls; empty: it calls none.
std::string called_fanuc_part(const std::string& path, const TextLine& statement) {
    if (!is_word(first_word(statement.text), "CALL")) return "";
    return part_path(path, trim(statement.text.substr(4)));
}

/// The stops of a file and, if it has parts, of the programs NAME_1 ... that it calls.
std::vector<io::ProgramStop> read_fanuc_module(const std::string& path,
                                               const ControllerJoints& joints, bool has_parts) {
    const ProgramFile file(path);
    const std::vector<TextLine>& lines = file.lines();
    const auto section = [&](std::string_view name) {
        std::size_t k = 0;
        while (k < lines.size() && !lines[k].begins_with(name)) ++k;
        if (k == lines.size()) {
            throw input_error_at({path},
                                 fmt::format("has no {}; must be a program for fanuc", name));
        }
        return k + 1;
    };
    for (const TextLine& line : lines) check_fanuc_group(line);
    const std::size_t end = section("/POS") - 1;
    section("/END");
    check_fanuc_positions(lines);
    const auto positions = read_fanuc_positions(lines, end + 1);
    StopCollector stops(fanuc_program().rules, joints);
    for (std::size_t k = section("/MN"); k < end; ++k) {
        check_fanuc(lines[k]);
        const TextLine line = fanuc_statement(lines[k]);
        if (line.begins_with("!")) {
            stops.note(line.text.substr(1));
        } else if (line.begins_with("J P[")) {
            check_fanuc_move(line);
            const auto found = positions.find(read_fanuc_index(line, line.text.substr(4)));
            if (found == positions.end() || found->second.empty()) {
                throw line.error(
                    "moves to a position without joints; must be in degrees under /POS");
            }
            stops.move(line, found->second);
        } else if (const std::string part = called_fanuc_part(path, line);
                   has_parts && !part.empty()) {
            stops.call(line, read_part(line, part, joints, &read_fanuc_module));
        } else if (!line.begins_with("//")) {
            check_fanuc_statement(line);
            stops.pass(line);
        }
    }
    return stops.finish();
}

std::vector<io::ProgramStop> read_fanuc(const std::string& path, const ControllerJoints& joints) {
    return read_fanuc_module(path, joints, true);
}

}  // namespace

const ProgramKind& fanuc_program() {
    static const ProgramKind kind{{.ending = ".ls",
                                   .decimals = 3,
                                   .longest_name = 32,
                                   .has_parts = true,
                                   .is_upper = true,
                                   .words = "CON PRN AUX NUL COM1 LPT1",
                                   .wait_step = 0.01,
                                   .longest_wait = 327.67,  // 2^15 - 1 steps
                                   .flow = {.opens = "IF FOR",
                                            .closes = "ENDIF ENDFOR",
                                            .jumps = "JMP TIMEOUT",
                                            .leaves = "END ABORT"},
                                   .waits = "WAIT PAUSE CALL",
                                   .moves = "J L C A S",
                                   .others = "SOFTFLOAT TRACK WEAVE TOUCH SEARCH STITCH",
                                   .target = " P["},
                                  &fanuc_files,
                                  &read_fanuc,
                                  &check_fanuc,
                                  &check_fanuc_positions};
    return kind;
}

}  // namespace posewise::detail
