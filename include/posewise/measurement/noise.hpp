#pragma once

#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// Covariance of the mean of `repeats` observations at a pose: the sensor's divided by repeats,
/// plus model_error^2 on the diagonal, which repeats do not reduce. Sensor rows square, m^2.
MatrixXd mean_covariance(const Campaign& campaign, const Isometry3d& world_from_flange,
                         const VectorXd& sensor_unknowns, double repeats);

/// Multiplies `rows` from the left by L^-1, where covariance = L L^T (Cholesky): errors with this
/// covariance become independent with variance 1.
void whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows);

/// L such that covariance = L L^T, for drawing noise. A sensor's covariance is
/// positive definite because its constructor requires positive sigmas.
MatrixXd cholesky_factor(const MatrixXd& covariance);

}  // namespace posewise
