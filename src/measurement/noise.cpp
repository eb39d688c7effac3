#include "posewise/measurement/noise.hpp"

#include <Eigen/Cholesky>
#include <cassert>

namespace posewise {

MatrixXd mean_covariance(const Campaign& campaign, const Isometry3d& world_from_flange,
                         const VectorXd& sensor_unknowns, double repeats) {
    MatrixXd covariance = campaign.sensor->covariance(world_from_flange, sensor_unknowns) / repeats;
    covariance.diagonal().array() += campaign.model_error * campaign.model_error;
    return covariance;
}

void whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows) {
    const MatrixXd L = cholesky_factor(covariance);
    L.triangularView<Eigen::Lower>().solveInPlace(rows);
}

MatrixXd cholesky_factor(const MatrixXd& covariance) {
    const Eigen::LLT<MatrixXd> cholesky(covariance);
    assert(cholesky.info() == Eigen::Success);
    return cholesky.matrixL();
}

}  // namespace posewise
