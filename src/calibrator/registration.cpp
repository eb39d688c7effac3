#include "posewise/calibrator/registration.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

#include "least_squares.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/point_sensor.hpp"
#include "posewise/measurement/pose_sensor.hpp"
#include "posewise/model/transforms.hpp"

namespace posewise {
namespace {

Matrix3d project_on_rotations(const Matrix3d& X) {
    const Eigen::JacobiSVD<Matrix3d> svd(X, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d D = Matrix3d::Identity();
    D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixU() * D * svd.matrixV().transpose();
}

/// Base and targets that solve the linear equations.
struct LinearSolution {
    Isometry3d world_from_base = Isometry3d::Identity();
    VectorXd targets;  ///< the unknown coordinates
};

/// Least squares for (rows of X, c, unknown targets) of X p_ij + c - R_i t_j = p_i, X projected on
/// the rotations.
LinearSolution solve_linear(const Campaign& campaign, const Targets& targets,
                            const Measurements& means) {
    const Index unknowns = targets.unknown_count();
    const Index point_count = means.is_seen.count();
    MatrixXd A = MatrixXd::Zero(3 * point_count, 12 + unknowns);
    VectorXd b(A.rows());
    Index row = 0;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        const Isometry3d flange = campaign.robot.base_from_flange(
            means.configurations.row(i).transpose(), campaign.nominal.robot);
        for (Index j = 0; j < targets.count(); ++j) {
            if (!means.is_seen(i, j)) continue;
            for (Index axis = 0; axis < 3; ++axis) {
                A.block<1, 3>(row + axis, 3 * axis) = means.observation(i, j);
            }
            A.block<3, 3>(row, 9).setIdentity();
            b.segment<3>(row) = flange * targets.position(j, VectorXd::Zero(unknowns));
            for (Index axis = 0; axis < 3; ++axis) {
                const Index k = targets.unknown_index(j, axis);
                if (k >= 0) A.block<3, 1>(row, 12 + k) = -flange.linear().col(axis);
            }
            row += 3;
        }
    }
    Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    qr.setThreshold(1e-9);
    if (A.rows() < A.cols() || qr.rank() < A.cols()) {
        const bool is_poses = dynamic_cast<const PoseSensor*>(campaign.sensor.get()) != nullptr;
        throw InputError(
            "these " + std::to_string(means.configuration_count()) +
            (is_poses ? " poses do not determine base and tool"
                      : " configurations with " + std::to_string(point_count) +
                            " points do not determine base and targets") +
            "; more configurations that turn the tool in different ways are needed or, "
            "where all axes are parallel (SCARA), base or " +
            (is_poses ? "tool" : "targets") + " known along them, like known: [z]");
    }
    const VectorXd solution = qr.solve(b);
    LinearSolution found;
    const Matrix3d R =
        project_on_rotations(
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(solution.data()))
            .transpose();
    found.world_from_base.linear() = R;
    found.world_from_base.translation() = -R * solution.segment<3>(9);
    found.targets = solution.tail(unknowns);
    return found;
}

// ---- Poses, as four points of the body: its origin and one on each axis ----

constexpr double along_axis = 0.3;  // m

Eigen::Matrix3Xd points_of(const Isometry3d& frame) {
    Eigen::Matrix3Xd points = frame.translation().replicate<1, 4>();
    points.rightCols<3>() += along_axis * frame.linear();
    return points;
}

Isometry3d frame_of(const VectorXd& points) {
    Isometry3d frame = Isometry3d::Identity();
    frame.translation() = points.head<3>();
    const Eigen::Map<const Matrix3d> tips(points.data() + 3);
    frame.linear() = project_on_rotations((tips.colwise() - points.head<3>()) / along_axis);
    return frame;
}

Measurements as_points(const Measurements& poses) {
    Measurements points = poses;
    points.observations.resize(poses.observations.rows(), 12);
    points.is_seen = poses.is_seen.replicate(1, 4);
    for (Index i = 0; i < poses.observations.rows(); ++i) {
        Isometry3d body = Isometry3d::Identity();
        body.translation() = poses.observations.row(i).head<3>();
        body.linear() = rotation_from_vector(poses.observations.row(i).tail<3>());
        points.observations.row(i) = points_of(body).reshaped().transpose();
    }
    return points;
}

LinearSolution solve_linear(const Campaign& campaign, const PoseSensor& sensor,
                            const Measurements& means) {
    const bool is_known = sensor.unknown_names().empty();
    std::vector<std::optional<Vector3d>> points(4);
    const Eigen::Matrix3Xd known = points_of(is_known ? sensor.tool({}) : Isometry3d::Identity());
    for (Index k = 0; k < 4 && is_known; ++k) points[static_cast<std::size_t>(k)] = known.col(k);
    LinearSolution found = solve_linear(campaign, Targets(points), as_points(means));
    if (!is_known) found.targets = tool_unknowns(frame_of(found.targets));
    return found;
}

/// Where the polish begins; the robot has no parameters.
Parameters find_start(const Campaign& campaign, const Measurements& measurements) {
    Parameters start = campaign.nominal;
    const Sensor& sensor = *campaign.sensor;
    const auto* const points = dynamic_cast<const PointSensor*>(&sensor);
    const auto* const poses = dynamic_cast<const PoseSensor*>(&sensor);
    const bool is_base_free = base_parameter_count(campaign) == 6;
    if (is_base_free && (points != nullptr || poses != nullptr)) {
        const Measurements means = mean_measurements(sensor, measurements);
        const LinearSolution found = points != nullptr
                                         ? solve_linear(campaign, points->targets(), means)
                                         : solve_linear(campaign, *poses, means);
        start.world_from_base = found.world_from_base;
        start.sensor = found.targets;
        return start;
    }
    if (!campaign.has_nominal_base || !campaign.has_nominal_targets) {
        throw InputError(
            "base and targets cannot be found from nothing by lengths alone or beside a base that "
            "is partly known; the campaign must state base and targets, if only roughly");
    }
    return start;
}

}  // namespace

Parameters register_roughly(const Campaign& campaign, const Measurements& measurements) {
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    check_all_seen(nominal, measurements);
    Parameters start = find_start(nominal, measurements);
    start.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return start;
}

Parameters register_base_and_targets(const Campaign& campaign, const Measurements& measurements) {
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    Parameters registered =
        identify(nominal, measurements, register_roughly(nominal, measurements)).parameters;
    registered.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return registered;
}

}  // namespace posewise
