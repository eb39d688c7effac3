#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <map>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "io/format/xml_document.hpp"
#include "program_stops.hpp"

/// Staubli VAL3 projects: a folder.
namespace posewise::detail {
namespace {

constexpr std::string_view xml_begin = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n";
constexpr std::string_view xml_instance = "xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\"";
constexpr std::string_view val3_schemas = "http://www.staubli.com/robotics/VAL3/";

std::string folder_name(const std::string& path) {
    return std::filesystem::path(path).filename().string();
}

std::string file_in(const std::string& folder, const std::string& name) {
    return (std::filesystem::path(folder) / name).string();
}

std::string val3_project(const std::string& name) {
    return fmt::format(
        "{}<Project xmlns=\"{}Project/3\">\n  <Parameters version=\"s7.10.2\" stackSize=\"5000\" "
        "millimeterUnit=\"true\"/>\n  <Programs>\n    <Program file=\"start.pgx\"/>\n    <Program "
        "file=\"stop.pgx\"/>\n  </Programs>\n  <Database>\n    <Data file=\"{}.dtx\"/>\n  "
        "</Database>\n  <Libraries/>\n</Project>\n",
        xml_begin, val3_schemas, name);
}

std::string val3_data(const io::RobotProgram& program) {
    const ProgramRules& rules = staubli_program().rules;
    std::string text = fmt::format(
        "{}<Database {} xmlns=\"{}Data/2\">\n  <Datas>\n    <Data name=\"joints\" "
        "access=\"private\" xsi:type=\"array\" type=\"jointRx\" size=\"{}\">\n",
        xml_begin, xml_instance, val3_schemas, program.stops.size());
    for (std::size_t k = 0; k < program.stops.size(); ++k) {
        fmt::format_to(std::back_inserter(text), "      <Value key=\"{}\"", k);
        const VectorXd& joints = program.stops[k].joints;
        for (Index i = 0; i < joints.size(); ++i) {
            fmt::format_to(std::back_inserter(text), " j{}=\"{}\"", i + 1,
                           joint_text(rules, program.joints.motion(i), joints[i]));
        }
        text += "/>\n";
    }
    return text + fmt::format(
                      "    </Data>\n    <Data name=\"slow\" access=\"private\" xsi:type=\"array\" "
                      "type=\"mdesc\" size=\"1\">\n      <Value key=\"0\" accel=\"{0}\" "
                      "vel=\"{0}\" decel=\"{0}\" tmax=\"99999\" rmax=\"99999\" blend=\"off\" "
                      "leave=\"50\" reach=\"50\"/>\n    </Data>\n  </Datas>\n</Database>\n",
                      program.speed_percent);
}

std::string val3_program(const std::string& name, const std::string& access,
                         const std::string& code) {
    return fmt::format(
        "{}<Programs {} xmlns=\"{}Program/2\">\n  <Program name=\"{}\" access=\"{}\">\n    "
        "<Code><![CDATA[\nbegin\n{}end\n]]></Code>\n  </Program>\n</Programs>\n",
        xml_begin, xml_instance, val3_schemas, name, access, code);
}

std::string staubli_stop(const io::RobotProgram& program, const io::ProgramStop& stop,
                         std::size_t number) {
    std::string text = fmt::format("  // {}\n  movej(joints[{}],flange,slow)\n  waitEndMove()\n",
                                   stop.label, number);
    if (!stop.is_measured) return text;
    text += fmt::format("  putln(\"{}\")\n", stop.label);
    for (const double wait : waits_of(staubli_program().rules, program, stop)) {
        text += fmt::format("  delay({})\n", seconds_text(wait));
    }
    if (program.handshake == io::Handshake::Pause) text += "  get()\n";
    return text;
}

using Val3Positions = std::map<std::string, std::vector<double>>;

pugi::xml_node data_named(const XmlDocument& document, std::string_view name) {
    return document.root().child("Datas").find_child_by_attribute("Data", "name",
                                                                  std::string(name).c_str());
}

/// Attributes j1, j2, ... of each value of `joints`, by key.
Val3Positions read_val3_positions(const XmlDocument& document) {
    const pugi::xml_node joints = data_named(document, "joints");
    if (!joints) {
        throw input_error_at({document.path()},
                             "has no Data joints; must be of a program's project");
    }
    Val3Positions positions;
    for (const pugi::xml_node value : joints.children("Value")) {
        std::vector<double>& numbers = positions[value.attribute("key").value()];
        if (!numbers.empty()) throw document.error(value, "states a key twice");
        for (int i = 1;; ++i) {
            const pugi::xml_attribute joint = value.attribute(fmt::format("j{}", i).c_str());
            if (!joint) break;
            const ParsedNumber number = parse_number(joint.value());
            if (!number.ok()) {
                throw document.error(value, fmt::format("j{} {}", i, number.problem));
            }
            numbers.push_back(number.value);
        }
    }
    return positions;
}

std::vector<double> val3_position(const TextLine& line, const Val3Positions& positions) {
    constexpr std::string_view array = "joints[";
    const std::size_t open = line.text.find(array);
    const std::size_t close = line.text.find(']', std::min(open, line.text.size()));
    if (close == std::string_view::npos) {
        throw line.error("moves to no position of joints; must be like movej(joints[0],...)");
    }
    const std::string_view key =
        trim(line.text.substr(open + array.size(), close - open - array.size()));
    const auto found = positions.find(std::string(key));
    if (found == positions.end()) {
        throw line.error("moves to a position that the project's data have none of");
    }
    return found->second;
}

std::vector<FileContent> staubli_files(const std::string& path, const io::RobotProgram& program) {
    const std::string name = folder_name(path);
    std::string code = fmt::format("  // {}\n", comment_text(program.title));
    for (std::size_t k = 0; k < program.stops.size(); ++k) {
        code += staubli_stop(program, program.stops[k], k);
    }
    return {{file_in(path, name + ".pjx"), val3_project(name)},
            {file_in(path, name + ".dtx"), val3_data(program)},
            {file_in(path, "start.pgx"), val3_program("start", "public", code)},
            {file_in(path, "stop.pgx"), val3_program("stop", "public", "  resetMotion()\n")}};
}

/// Throws InputError where the motion descriptor, the third argument, is not one without blending.
void check_val3_move(const TextLine& line, const XmlDocument& data) {
    const std::size_t close = std::min(line.text.rfind(')'), line.text.size());
    const std::size_t comma = line.text.rfind(',', close);
    const std::string_view third =
        comma == std::string_view::npos ? "" : trim(line.text.substr(comma + 1, close - comma - 1));
    const std::string_view name = third.substr(0, third.find('['));
    const pugi::xml_node values = data_named(data, name);
    if (!values) {
        throw line.error(
            fmt::format("moves as {} says, which the project's data have none of", quote(name)));
    }
    for (const pugi::xml_node value : values.children("Value")) {
        for (const char* const speed : {"accel", "vel", "decel"}) {
            const std::string_view stated = value.attribute(speed).value();
            check_speed(line, fmt::format("{}=\"{}\"", speed, stated), stated);
        }
        if (std::string_view(value.attribute("blend").value()) == "off") continue;
        throw line.error(
            fmt::format("does not stop at its position; {} must have blend=\"off\"", quote(name)));
    }
}

void check_val3_statement(const TextLine& line) {
    for (const char* const other : {"movel", "movec"}) {
        if (line.begins_with(other)) throw line.error("is no joint move; must be movej(...)");
    }
    if (line.has("movej(") && !line.has("\"")) {
        throw line.error("moves under a condition; must be movej in a line of its own");
    }
}

/// Throws InputError where a file of the project is missing or was not copied to its end.
void check_val3_files(const std::string& folder) {
    for (const std::string& name : {folder_name(folder) + ".pjx", std::string("stop.pgx")}) {
        const XmlDocument whole(file_in(folder, name));
    }
}

std::vector<io::ProgramStop> read_staubli(const std::string& path, const ControllerJoints& joints) {
    const XmlDocument data(file_in(path, folder_name(path) + ".dtx"));
    const Val3Positions positions = read_val3_positions(data);
    const XmlDocument whole(file_in(path, "start.pgx"));
    const ProgramFile file(whole.path(), "end");
    check_val3_files(path);
    StopCollector stops(staubli_program().rules, joints);
    for (const TextLine& line : file.lines()) {
        if (line.begins_with("//")) {
            stops.note(line.text.substr(2));
        } else if (line.begins_with("movej(")) {
            const std::vector<double> position = val3_position(line, positions);
            check_val3_move(line, data);
            stops.move(line, position);
        } else {
            check_val3_statement(line);
            check_time(line, line.text, first_argument(line, "delay"));
            stops.pass(line);
        }
    }
    return stops.finish();
}

}  // namespace

const ProgramKind& staubli_program() {
    static const ProgramKind kind{
        {.ending = "",
         .decimals = 5,
         .longest_name = 15,
         .words = "start stop begin end if then else endif for to do while endwhile until "
                  "switch case call return and or not true false flange world",
         .has_io = false,
         .flow = {.opens = "if while for do switch",
                  .closes = "endIf endWhile endFor until endSwitch",
                  .leaves = "return",
                  .has_then = false},
         .waits = "delay get wait call",
         .messages = "putln",
         .target = "joints["},
        &staubli_files,
        &read_staubli};
    return kind;
}

}  // namespace posewise::detail
