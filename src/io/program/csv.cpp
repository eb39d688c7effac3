#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "io/format/csv_reader.hpp"
#include "io/format/text.hpp"
#include "program_stops.hpp"

/// Plain CSV in the units of the controller.
namespace posewise::detail {
namespace {

std::string column_of(const ControllerJoints& joints, Index joint) {
    return joints.names()[static_cast<std::size_t>(joint)] +
           (joints.motion(joint) == Motion::Rotation ? "_deg" : "_mm");
}

/// Where each wanted column is.
std::vector<std::size_t> find_columns(const CsvReader& reader,
                                      const std::vector<std::string>& wanted) {
    std::vector<std::size_t> columns;
    for (const std::string& name : wanted) {
        const auto& fields = reader.fields();
        const auto found = std::ranges::find(fields, std::string_view(name));
        if (found == fields.end()) {
            throw input_error_at(reader.locate(0),
                                 "column " + quote(name) + " is missing; must be in the header");
        }
        columns.push_back(static_cast<std::size_t>(found - fields.begin()));
    }
    return columns;
}

std::vector<FileContent> csv_files(const std::string& path, const io::RobotProgram& program) {
    const ProgramRules& rules = csv_program().rules;
    std::string text = "name";
    for (Index i = 0; i < program.joints.count(); ++i) text += ',' + column_of(program.joints, i);
    text += ",dwell_s\n";
    for (const io::ProgramStop& stop : program.stops) {
        fmt::format_to(std::back_inserter(text), "{},{},{}\n", stop.label,
                       joints_text(rules, program.joints, stop.joints, ","),
                       seconds_text(dwell_of(rules, program, stop)));
    }
    return {{path, text}};
}

std::vector<io::ProgramStop> read_program_table(const std::string& path,
                                                const ControllerJoints& joints) {
    CsvReader reader(path);
    if (!reader.next_row()) throw input_error_at({path}, "is empty; must have a header");
    std::vector<std::string> wanted{"name"};
    for (Index i = 0; i < joints.count(); ++i) wanted.push_back(column_of(joints, i));
    const std::vector<std::size_t> columns = find_columns(reader, wanted);
    const std::size_t width = reader.fields().size();
    const auto& fields = reader.fields();
    const auto dwell = static_cast<std::size_t>(
        std::ranges::find(fields, std::string_view("dwell_s")) - fields.begin());
    StopCollector stops(csv_program().rules, joints);
    while (reader.next_row()) {
        if (reader.fields().size() != width) {
            throw input_error_at(reader.locate(0), fmt::format("has {} fields; must have {}",
                                                               reader.fields().size(), width));
        }
        const auto number_at = [&](std::size_t column) {
            const TextLine field{reader.fields()[column], reader.locate(column)};
            return read_numbers(field, field.text).front();
        };
        stops.name(reader.fields()[columns[0]]);
        std::vector<double> numbers;
        for (std::size_t k = 1; k < columns.size(); ++k) numbers.push_back(number_at(columns[k]));
        stops.move({"", reader.locate(0)}, numbers);
        if (dwell < width) {
            const TextLine time{reader.fields()[dwell], reader.locate(dwell)};
            check_time(time, time.text, time.text);
            if (number_at(dwell) > 0) stops.wait();
        }
    }
    return stops.finish();
}

}  // namespace

const ProgramKind& csv_program() {
    static const ProgramKind kind{{.ending = ".csv",
                                   .decimals = 6,
                                   .has_six_joints = false,
                                   .has_program_name = false,
                                   .has_pause = false,
                                   .has_io = false},
                                  &csv_files,
                                  &read_program_table};
    return kind;
}

}  // namespace posewise::detail
