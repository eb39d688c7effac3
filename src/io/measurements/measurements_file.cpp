#include "posewise/io/measurements_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "calibration_data.hpp"
#include "core/text.hpp"
#include "foreign_tables.hpp"
#include "io/format/atomic_file.hpp"
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
    return detail::read_measurements_table(path, std::move(content), table);
}

/// The campaign with the controller's joints in place of the model's: their names, and limits as
/// wide as those of the model allow.
Campaign with_controller_joints(const CampaignFile& file) {
    Campaign campaign = file;
    campaign.robot =
        Chain(file.controller.limited(file.robot), file.robot.elements(), file.robot.torques());
    return campaign;
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
    if (!file.has_controller_columns) return read_as_stated(path, file, file, points);
    MeasurementsFile read = read_as_stated(path, file, with_controller_joints(file), points);
    if (read.is_joined) return read;  // with the plan's joints
    const Index joints = file.robot.joint_count();
    for (Index i = 0; i < read.configurations.rows(); ++i) {
        const VectorXd c = read.configurations.row(i).head(joints).transpose();
        read.configurations.row(i).head(joints) = file.controller.to_model(c).transpose();
    }
    return read;
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
