#include "pose_information.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "measurement/noise.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::detail {
namespace {

bool is_blind(const SeenTargets& is_seen) { return is_seen.size() > 0 && !is_seen.any(); }

/// Rows of the sensor that a pose shows; empty: all.
std::vector<Index> rows_shown(const Sensor& sensor, const SeenTargets& is_seen) {
    if (is_seen.all()) return {};
    return seen_rows(is_seen, sensor.rows_per_target());
}

/// Rows that a pose does not show leave.
void keep_rows(const std::vector<Index>& rows, RowMatrixXd& A) {
    if (!rows.empty()) A = A(rows, Eigen::all).eval();
}
void keep_rows_and_columns(const std::vector<Index>& rows, MatrixXd& A) {
    if (!rows.empty()) A = A(rows, rows).eval();
}

}  // namespace

PoseInformation::PoseInformation(const Campaign& campaign, Parameters parameters, double repeats)
    : campaign_(campaign),
      parameters_(std::move(parameters)),
      repeats_(repeats),
      scale_(parameter_scale(campaign)) {
    check_noise(campaign);
    if (!(repeats > 0) || !std::isfinite(repeats)) {
        throw InputError(fmt::format("repeats is {:g}, must be positive and finite", repeats));
    }
}

RowMatrixXd PoseInformation::rows(const VectorXd& q, const SeenTargets& is_seen) const {
    if (is_blind(is_seen)) return RowMatrixXd::Zero(0, parameter_count());
    const std::vector<Index> shown = rows_shown(*campaign_.sensor, is_seen);
    FlangeMotion motion;
    RowMatrixXd B(campaign_.sensor->row_count(), parameter_count());
    differentiate_pose(campaign_, parameters_, q, motion, B);
    MatrixXd S = mean_covariance(campaign_, motion, parameters_.sensor, repeats_);
    keep_rows(shown, B);
    keep_rows_and_columns(shown, S);
    whiten(S, B);
    B *= scale_.asDiagonal();
    return B;
}

MatrixXd PoseInformation::evaluate(const VectorXd& q, const SeenTargets& is_seen) const {
    const RowMatrixXd B = rows(q, is_seen);
    MatrixXd M = MatrixXd::Zero(B.cols(), B.cols());
    if (B.rows() == 0) return M;
    M.selfadjointView<Eigen::Lower>().rankUpdate(B.transpose());
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

VectorXd PoseInformation::differentiate(const VectorXd& q, const MatrixXd& Z,
                                        const SeenTargets& is_seen) const {
    return differentiate_weighed(
        q, [&](const RowMatrixXd& B) -> RowMatrixXd { return B * Z; }, is_seen);
}

VectorXd PoseInformation::differentiate_weighed(const VectorXd& q, const Weigh& weigh,
                                                const SeenTargets& is_seen) const {
    if (is_blind(is_seen)) {
        weigh(RowMatrixXd::Zero(0, parameter_count()));
        return VectorXd::Zero(q.size());
    }
    const Sensor& sensor = *campaign_.sensor;
    const std::vector<Index> rows = rows_shown(sensor, is_seen);
    FlangeMotion motion;
    std::vector<FlangeMotionRate> rates;
    differentiate_flange_twice(campaign_, parameters_, q, motion, rates);
    RowMatrixXd P(sensor.row_count(), parameter_count());
    sensor.differentiate(motion.world_from_flange, motion.twists, parameters_.sensor, P);
    P *= scale_.asDiagonal();
    MatrixXd S = mean_covariance(campaign_, motion, parameters_.sensor, repeats_);
    keep_rows(rows, P);
    keep_rows_and_columns(rows, S);
    const Eigen::LLT<MatrixXd> cholesky(S);
    cholesky.matrixL().solveInPlace(P);  // the block
    RowMatrixXd PZ = weigh(P);
    cholesky.matrixU().solveInPlace(PZ);
    cholesky.matrixU().solveInPlace(P);
    const MatrixXd X = PZ * P.transpose();
    PZ *= scale_.asDiagonal();

    const bool is_constant = has_constant_noise(campaign_);
    RowMatrixXd J_rate;
    MatrixXd S_rate;
    VectorXd gradient(q.size());
    for (Index j = 0; j < q.size(); ++j) {
        const FlangeMotionRate& rate = rates[static_cast<std::size_t>(j)];
        J_rate.resize(sensor.row_count(), parameter_count());
        sensor.differentiate_along(motion.world_from_flange, motion.twists,
                                   motion.joint_twists.col(j), rate.twists, parameters_.sensor,
                                   J_rate);
        keep_rows(rows, J_rate);
        gradient[j] = 2 * PZ.cwiseProduct(J_rate).sum();
        if (is_constant) continue;
        S_rate = mean_covariance_rate(campaign_, motion, j, rate, parameters_.sensor, repeats_);
        keep_rows_and_columns(rows, S_rate);
        gradient[j] -= X.cwiseProduct(S_rate).sum();
    }
    return gradient;
}

}  // namespace posewise::detail
