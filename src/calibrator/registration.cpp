#include "posewise/calibrator/registration.hpp"

#include <Eigen/QR>
#include <Eigen/SVD>

#include "least_squares.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/point_sensor.hpp"

namespace posewise {
namespace {

Matrix3d project_on_rotations(const Matrix3d& X) {
    const Eigen::JacobiSVD<Matrix3d> svd(X, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Matrix3d D = Matrix3d::Identity();
    D(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
    return svd.matrixU() * D * svd.matrixV().transpose();
}

/// Least squares for (rows of X, c, unknown targets) of X p_ij + c - R_i t_j = p_i.
VectorXd solve_linear(const Campaign& campaign, const PointSensor& sensor,
                      const Measurements& measurements) {
    const Measurements means = mean_measurements(measurements);
    const auto unknowns = static_cast<Index>(sensor.unknown_names().size());
    const Index point_count = means.is_seen.count();
    MatrixXd A = MatrixXd::Zero(3 * point_count, 12 + unknowns);
    VectorXd b(A.rows());
    Index row = 0;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        const Isometry3d flange = campaign.robot.base_from_flange(
            means.configurations.row(i).transpose(), campaign.nominal.robot);
        for (Index j = 0; j < sensor.target_count(); ++j) {
            if (!means.is_seen(i, j)) continue;
            for (Index axis = 0; axis < 3; ++axis) {
                A.block<1, 3>(row + axis, 3 * axis) = means.observation(i, j);
            }
            A.block<3, 3>(row, 9).setIdentity();
            b.segment<3>(row) = flange.translation();
            if (sensor.is_known(j)) {
                b.segment<3>(row) += flange.linear() * sensor.target(j, VectorXd());
            } else {
                A.block<3, 3>(row, 12 + sensor.unknown_offset(j)) = -flange.linear();
            }
            row += 3;
        }
    }
    Eigen::ColPivHouseholderQR<MatrixXd> qr(A);
    qr.setThreshold(1e-9);
    if (A.rows() < A.cols() || qr.rank() < A.cols()) {
        throw InputError("these " + std::to_string(means.configuration_count()) +
                         " configurations with " + std::to_string(point_count) +
                         " points do not determine base and targets; more configurations "
                         "that turn the tool in different ways are needed");
    }
    return qr.solve(b);
}

}  // namespace

Parameters register_base_and_targets(const Campaign& campaign, const Measurements& measurements) {
    const auto* sensor = dynamic_cast<const PointSensor*>(campaign.sensor.get());
    if (sensor == nullptr) throw InputError("registration needs a sensor that measures points");
    const Campaign nominal = with_robot(campaign, without_parameters(campaign.robot));
    check_all_seen(nominal, measurements);
    const VectorXd solution = solve_linear(nominal, *sensor, measurements);

    Parameters start = nominal.nominal;
    const Matrix3d R_base =
        project_on_rotations(
            Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(solution.data()))
            .transpose();
    start.world_from_base.linear() = R_base;
    start.world_from_base.translation() = -R_base * solution.segment<3>(9);
    start.sensor = solution.tail(solution.size() - 12);

    Parameters registered = identify(nominal, measurements, start).parameters;
    registered.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return registered;
}

}  // namespace posewise
