#include "posewise/jacobian/pose_information.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/noise.hpp"

namespace posewise {

PoseInformation::PoseInformation(const Campaign& campaign, Parameters parameters, double repeats)
    : campaign_(campaign),
      parameters_(std::move(parameters)),
      repeats_(repeats),
      scale_(parameter_scale(campaign)) {
    check_noise(campaign);
    if (!(repeats > 0) || !std::isfinite(repeats)) {
        throw InputError("repeats is " + std::to_string(repeats) + ", must be positive and finite");
    }
}

MatrixXd PoseInformation::evaluate(const VectorXd& q) const {
    FlangeMotion motion;
    RowMatrixXd B(campaign_.sensor->row_count(), parameter_count());
    differentiate_pose(campaign_, parameters_, q, motion, B);
    whiten(mean_covariance(campaign_, motion, parameters_.sensor, repeats_), B);
    B *= scale_.asDiagonal();
    MatrixXd M = MatrixXd::Zero(B.cols(), B.cols());
    M.selfadjointView<Eigen::Lower>().rankUpdate(B.transpose());
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

VectorXd PoseInformation::differentiate(const VectorXd& q, const MatrixXd& Z) const {
    const Sensor& sensor = *campaign_.sensor;
    FlangeMotion motion;
    std::vector<FlangeMotionRate> rates;
    campaign_.robot.differentiate_twice(parameters_.world_from_base, q, parameters_.robot, motion,
                                        rates);
    RowMatrixXd P(sensor.row_count(), parameter_count());
    sensor.differentiate(motion.world_from_flange, motion.twists, parameters_.sensor, P);
    P *= scale_.asDiagonal();
    const Eigen::LLT<MatrixXd> cholesky(
        mean_covariance(campaign_, motion, parameters_.sensor, repeats_));
    cholesky.solveInPlace(P);
    RowMatrixXd PZ = P * Z;
    const MatrixXd X = PZ * P.transpose();
    PZ *= scale_.asDiagonal();

    const bool is_constant = has_constant_noise(campaign_);
    RowMatrixXd J_rate(P.rows(), P.cols());
    VectorXd gradient(q.size());
    for (Index j = 0; j < q.size(); ++j) {
        const FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
        sensor.differentiate_along(motion.world_from_flange, motion.twists,
                                   motion.joint_twists.col(j), rate.twists, parameters_.sensor,
                                   J_rate);
        gradient[j] = 2 * PZ.cwiseProduct(J_rate).sum();
        if (is_constant) continue;
        gradient[j] -= X.cwiseProduct(mean_covariance_rate(campaign_, motion, j, rate,
                                                           parameters_.sensor, repeats_))
                           .sum();
    }
    return gradient;
}

}  // namespace posewise
