#include "posewise/planner/prediction.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "../core/elementary.hpp"
#include "../core/statistics.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "unknowns.hpp"

namespace posewise {

Blocks make_prediction_blocks(const Campaign& campaign, const Parameters& parameters,
                              const RowMatrixXd& workspace, Index target) {
    const Index targets = campaign.sensor->target_count();
    if (target < -1 || target >= targets) {
        throw InputError("target " + std::to_string(target + 1) + " to predict: the sensor has " +
                         std::to_string(targets));
    }
    Blocks blocks = make_position_blocks(campaign, parameters, workspace);
    blocks.matrix *= parameter_scale(campaign).asDiagonal();
    if (target < 0) return blocks;
    Blocks one;
    one.matrix.resize(3 * workspace.rows(), blocks.parameter_count());
    for (Index i = 0; i < workspace.rows(); ++i) {
        one.matrix.middleRows(3 * i, 3) = blocks[i].middleRows(3 * target, 3);
        one.first_row.push_back(3 * (i + 1));
    }
    return one;
}

namespace detail {

Unknowns draw_unknowns(Index k, Index count, const PredictedAccuracy& accuracy,
                       double model_error) {
    constexpr double root = 1.3247179572447460;
    const auto part = [&](double x) { return std::clamp(x - std::floor(x), 1e-12, 1 - 1e-12); };
    const double number = static_cast<double>(k) + 0.5;
    const KnownWithin& known = accuracy.known_within;
    Unknowns drawn;
    drawn.uniform = part(number / root);
    drawn.model = power(known.model_error, normal_quantile(number / static_cast<double>(count)));
    const double share = accuracy.prior_share.value_or(0);
    const double sizes = power(known.error_size, normal_quantile(part(number / (root * root))));
    drawn.growth = power(sizes, share) * power(model_error > 0 ? drawn.model : 1, 1 - share);
    return drawn;
}

}  // namespace detail

VectorXd total_cases(const PredictedAccuracy& accuracy, double model_error, double repeatability) {
    constexpr Index cases = 4096;
    constexpr double coordinates = 3;
    VectorXd totals(cases);
    for (Index k = 0; k < cases; ++k) {
        const detail::Unknowns drawn = detail::draw_unknowns(k, cases, accuracy, model_error);
        const double freedom = accuracy.degrees_of_freedom;
        const double chi_squared = detail::chi_squared_quantile(drawn.uniform, freedom) / freedom;
        const double parameters = drawn.growth * accuracy.rms;
        const double model = drawn.model * model_error;
        totals[k] = std::sqrt(chi_squared * parameters * parameters + coordinates * model * model +
                              repeatability * repeatability);
    }
    return totals;
}

PredictedTotal predict_total(const PredictedAccuracy& accuracy, double model_error) {
    const VectorXd totals = total_cases(accuracy, model_error);
    return {std::sqrt(accuracy.rms * accuracy.rms + 3 * model_error * model_error),
            quantile(totals, 0.05, detail::QuantileRule::Linear),
            quantile(totals, 0.95, detail::QuantileRule::Linear)};
}

PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const MatrixXd& prior, std::uint64_t seed) {
    constexpr Index draws = 200;
    const Eigen::LLT<MatrixXd> cholesky(M);
    const Index positions = prediction.matrix.rows() / 3;
    if (positions == 0) throw InputError("no workspace configurations to predict for");
    if (cholesky.info() != Eigen::Success) {
        throw InputError("the plan does not identify all parameters, so it predicts nothing");
    }
    // Error of a position = J0 dx with dx = L^-T z, M = L L^T.
    const MatrixXd spread = cholesky.matrixL().solve(prediction.matrix.transpose());
    PredictedAccuracy accuracy;
    VectorXd errors(draws * positions);
    double sum = 0;
    for (Index i = 0; i < positions; ++i) {
        const auto W = spread.middleCols(3 * i, 3);
        const double square = W.squaredNorm();
        sum += square;
        accuracy.worst_rms = std::max(accuracy.worst_rms, std::sqrt(square));
        const Matrix3d covariance = W.transpose() * W;
        const Matrix3d L = covariance.llt().matrixL();
        RandomStream random(seed, static_cast<std::uint64_t>(i));
        for (Index k = 0; k < draws; ++k) {
            const Vector3d z(random.normal(), random.normal(), random.normal());
            errors[draws * i + k] = (L * z).norm();
        }
    }
    accuracy.rms = std::sqrt(sum / static_cast<double>(positions));
    // The square's mean over positions is z^T S S^T z / positions: trace and squared norm of that.
    MatrixXd square = MatrixXd::Zero(M.rows(), M.rows());
    square.selfadjointView<Eigen::Lower>().rankUpdate(spread);
    square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
    const double trace = square.trace();
    if (trace > 0) accuracy.degrees_of_freedom = trace * trace / square.squaredNorm();
    if (prior.size() > 0 && !prior.isZero(0) && sum > 0) {
        // d trace(B M^-1 B^T) for M = J^T J + prior / f, by log f: trace(B M^-1 prior M^-1 B^T).
        const MatrixXd by_parameter = cholesky.matrixU().solve(spread);
        accuracy.prior_share = by_parameter.cwiseProduct(prior * by_parameter).sum() / sum;
    }
    accuracy.percentile95 = quantile(std::move(errors), 0.95, detail::QuantileRule::Upper);
    return accuracy;
}

PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const Campaign& campaign) {
    PredictedAccuracy accuracy = predict_accuracy(prediction, M, prior_information(campaign));
    accuracy.known_within = campaign.known_within;
    return accuracy;
}

}  // namespace posewise
