#include "posewise/io/measurements_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "calibration_data.hpp"
#include "core/text.hpp"
#include "foreign_tables.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/units.hpp"
#include "model/joint_limits.hpp"
#include "planned_points.hpp"
#include "points_list.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::io {
namespace {

bool is_matlab(const std::string& path) { return path.ends_with(".mat") || path.ends_with(".MAT"); }

Configurations read_matlab(const std::string& path, const CampaignFile& file) {
    Measurements read = read_measurements_mat(path, file, file.mat);
    const Index count = read.configuration_count();
    return {std::move(read.ids),
            std::move(read.configurations),
            all_seen(count, file.sensor->target_count()),
            {}};
}

/// Throws InputError where a table has joints of the model in place of the controller's, or the
/// other way round: their names are alike, their angles are not.
void check_joint_columns(const std::string& path, const std::string& content,
                         const std::vector<std::string>& model, const CampaignFile& file) {
    const std::vector<std::string>& shown = file.controller.names();
    if (shown == model) return;
    detail::CsvReader header(path, content, detail::CsvStyle::Table);
    if (!header.next_row()) return;
    const bool wants_shown = file.has_controller_columns;
    const auto& wanted = wants_shown ? shown : model;
    const auto& other = wants_shown ? model : shown;
    const auto has = [](const std::vector<std::string>& names, std::string_view name) {
        return std::ranges::find(names, name) != names.end();
    };
    std::size_t found = 0;
    std::optional<std::size_t> wrong;
    for (std::size_t field = 0; field < header.fields().size(); ++field) {
        const std::string_view name = detail::split_unit(header.fields()[field]).stem;
        if (has(wanted, name)) {
            ++found;
        } else if (!wrong && has(other, name)) {
            wrong = field;
        }
    }
    if (!wrong || found >= wanted.size()) return;
    const std::string column = detail::quote(header.fields()[*wrong]);
    throw input_error_at(
        header.locate(*wrong),
        wants_shown
            ? fmt::format("column {} is a joint of the model, but `measurements: {{columns: "
                          "controller}}` in the campaign says that joints are the controller's, "
                          "which are called {}",
                          column, detail::list_words(shown))
            : fmt::format("column {} is a joint of the controller; state `measurements: "
                          "{{columns: controller}}` in the campaign if joints are as it shows them",
                          column));
}

/// `table`: the campaign whose joints a table has.
MeasurementsFile read_as_stated(const std::string& path, const CampaignFile& file,
                                const Campaign& table, const PointsSource& points) {
    if (is_matlab(path)) return {read_measurements_mat(path, table, file.mat)};
    std::string content = detail::read_file(path);
    if (detail::is_calibration_data(content)) {
        return detail::read_calibration_data(path, content, table, file.observation);
    }
    if (const auto kind = detail::foreign_table(path, content, file);
        kind != detail::ForeignTable::None) {
        return detail::read_foreign_table(path, std::move(content), file, kind);
    }
    std::vector<std::string> joints;
    for (const Joint& joint : file.robot.joints()) joints.push_back(joint.name);
    if (detail::is_points_list(path, content, joints, points.plan != nullptr)) {
        return detail::read_planned_points(path, std::move(content), file, points);
    }
    check_joint_columns(path, content, joints, file);
    return detail::read_measurements_table(path, std::move(content), table);
}

/// The campaign with the joints that measurements have: where they are the controller's, these in
/// place of the model's, with limits as wide as those of the model allow.
Campaign with_measured_joints(const CampaignFile& file) {
    Campaign campaign = file;
    if (!file.has_controller_columns) return campaign;
    campaign.robot =
        Chain(file.controller.limited(file.robot), file.robot.elements(), file.robot.torques());
    return campaign;
}

/// The joints of each configuration, rad or m, before what else it states.
template <typename Convert>
void replace_joints(Measurements& measurements, Index joints, const Convert& convert) {
    for (auto configuration : measurements.configurations.rowwise()) {
        const VectorXd before = configuration.head(joints).transpose();
        configuration.head(joints) = convert(before).transpose();
    }
}

}  // namespace

std::vector<std::string> describe_passed_over(const MeasurementsFile& measured) {
    std::vector<std::string> sentences;
    if (!measured.unused_columns.empty()) {
        std::vector<std::string> names;
        for (const std::string& name : measured.unused_columns) {
            names.push_back(detail::quote(name));
        }
        const bool is_one = names.size() == 1;
        sentences.push_back(fmt::format("column{} {} {} not used", is_one ? "" : "s",
                                        fmt::join(names, ", "), is_one ? "is" : "are"));
    }
    if (!measured.joined.empty()) sentences.push_back(measured.joined);
    return sentences;
}

MeasurementsFile read_measurements(const std::string& path, const CampaignFile& file,
                                   const PointsSource& points) {
    MeasurementsFile read = read_as_stated(path, file, with_measured_joints(file), points);
    if (!file.has_controller_columns || read.is_joined) return read;  // with the plan's joints
    replace_joints(read, file.robot.joint_count(),
                   [&](const VectorXd& c) { return file.controller.to_model(c); });
    return read;
}

void write_measurements(const std::string& path, const CampaignFile& file,
                        const Measurements& measurements,
                        const std::vector<std::string>& comment_lines) {
    Measurements written = measurements;
    if (file.has_controller_columns) {
        replace_joints(written, file.robot.joint_count(),
                       [&](const VectorXd& q) { return file.controller.to_controller(q); });
    }
    write_measurements_csv(path, with_measured_joints(file), written, comment_lines);
}

Configurations read_configurations(const std::string& path, const CampaignFile& file) {
    Configurations read =
        is_matlab(path) ? read_matlab(path, file) : read_configurations_csv(path, file);
    check_within_limits(path, file, read);
    return read;
}

void check_within_limits(const std::string& path, const CampaignFile& file,
                         const Configurations& configurations) {
    for (Index i = 0; i < configurations.joints.rows(); ++i) {
        const std::string violation =
            detail::describe_limit_violation(file.robot, configurations.joints.row(i).transpose());
        if (violation.empty()) continue;
        throw input_error_at({path},
                             "configuration " +
                                 detail::quote(configurations.ids[static_cast<std::size_t>(i)]) +
                                 " is beyond the joint limits: " + violation);
    }
}

Configurations read_program(const std::string& path, const CampaignFile& file) {
    return is_matlab(path) ? read_matlab(path, file) : read_program_csv(path, file);
}

}  // namespace posewise::io
