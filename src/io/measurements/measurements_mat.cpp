#include <cmath>
#include <map>

#include "io/format/mat_reader.hpp"
#include "posewise/io/measurements_file.hpp"
#include "sample_collector.hpp"

namespace posewise::io {
namespace {

/// Joint values, samples x joints, in rad and m.
MatrixXd read_joints(const detail::MatReader& file, const std::string& path, const Chain& robot,
                     const MatMapping& mapping) {
    const Index count = robot.joint_count();
    MatrixXd joints = file.read(mapping.joints, count);
    for (Index j = 0; j < count; ++j) {
        const bool turns = robot.joint(j).motion == Motion::Rotation;
        joints.col(j) *= turns ? mapping.angle_unit : mapping.length_unit;
        if (mapping.angle_unit != 1) continue;
        for (Index row = 0; row < joints.rows(); ++row) {
            detail::check_not_degrees(robot, j, joints(row, j), [&] {
                return FileLocation{path + ": variable '" + mapping.joints + "', row " +
                                    std::to_string(row + 1)};
            });
        }
    }
    if (robot.torques().empty()) return joints;
    const auto torque_count = static_cast<Index>(robot.torques().size());
    const MatrixXd torques = file.read(mapping.torques, torque_count);
    if (torques.rows() != joints.rows()) {
        throw input_error_at({path}, "variable '" + mapping.torques + "' has " +
                                         std::to_string(torques.rows()) + " rows; must have " +
                                         std::to_string(joints.rows()) + " as '" + mapping.joints +
                                         "'");
    }
    joints.conservativeResize(Eigen::NoChange, count + torque_count);
    joints.rightCols(torque_count) = torques;
    return joints;
}

/// Three numbers a target; NaN: it was not seen.
void take_seen(const VectorXd& points, detail::Sample& sample) {
    sample.observation = points;
    sample.is_seen.resize(points.size() / 3);
    for (Index k = 0; k < points.size(); k += 3) {
        sample.is_seen[k / 3] = !std::isnan(points[k]);
        if (!sample.is_seen[k / 3]) sample.observation.segment<3>(k).setZero();
    }
}

}  // namespace

Measurements read_measurements_mat(const std::string& path, const Campaign& campaign,
                                   const MatMapping& mapping) {
    if (!campaign.sensor->observes_targets()) {
        throw input_error_at({path},
                             "is a MATLAB file, which is read for sensors of points only; "
                             "must be CSV");
    }
    const Index rows = campaign.sensor->row_count();
    if (static_cast<Index>(mapping.points.size()) * 3 != rows) {
        throw input_error_at({path}, "the campaign maps " + std::to_string(mapping.points.size()) +
                                         " variables to points; must map " +
                                         std::to_string(rows / 3) +
                                         " under measurements.mat.points");
    }
    const detail::MatReader file(path);
    const MatrixXd joints = read_joints(file, path, campaign.robot, mapping);
    MatrixXd observations(joints.rows(), rows);
    for (std::size_t k = 0; k < mapping.points.size(); ++k) {
        const MatrixXd points = file.read_with_gaps(mapping.points[k], 3);
        if (points.rows() != joints.rows()) {
            throw input_error_at({path}, "variable '" + mapping.points[k] + "' has " +
                                             std::to_string(points.rows()) + " rows; must have " +
                                             std::to_string(joints.rows()) + " as '" +
                                             mapping.joints + "'");
        }
        observations.middleCols(3 * static_cast<Index>(k), 3) = mapping.length_unit * points;
    }
    detail::SampleCollector samples(campaign);
    std::map<std::vector<double>, std::string> ids;
    for (Index row = 0; row < joints.rows(); ++row) {
        detail::Sample sample;
        sample.joints = joints.row(row).transpose();
        const auto next = std::to_string(ids.size());
        const auto end = sample.joints.begin() + campaign.robot.joint_count();
        sample.id =
            ids.emplace(std::vector<double>(sample.joints.begin(), end), next).first->second;
        take_seen(observations.row(row).transpose(), sample);
        if (!sample.is_seen.any()) {
            throw input_error_at({path}, "row " + std::to_string(row + 1) +
                                             " shows no target, all points are NaN; must show one "
                                             "at least, or be left out");
        }
        samples.add(sample, [&path](Index) { return FileLocation{path}; });
    }
    return samples.finish(path);
}

}  // namespace posewise::io
