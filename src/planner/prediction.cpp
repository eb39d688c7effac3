#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/statistics.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/planning.hpp"
#include "unknowns.hpp"

namespace posewise {

Blocks make_prediction_blocks(const Campaign& campaign, const Parameters& parameters,
                              const RowMatrixXd& workspace, Index target) {
    const Index targets = campaign.sensor->position_count();
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

double PredictedAccuracy::growth(double model_square, double size_square) const {
    const double noise = 1 + model_share * (model_square - 1);
    if (by_direction.size() == 0) return noise;
    // Known by (1 - p) / noise of poses and p of the prior: C (M + size P) C in each direction.
    const auto poses = (1 - prior_part.array()) / noise;
    const auto prior = prior_part.array();
    return (by_direction.array() * (poses + size_square * prior) / (poses + prior).square()).sum();
}

namespace detail {

Unknowns draw_unknowns(Index k, Index count, const PredictedAccuracy& accuracy) {
    constexpr double root = 1.3247179572447460;
    const auto part = [&](double x) { return std::clamp(x - std::floor(x), 1e-12, 1 - 1e-12); };
    const double number = static_cast<double>(k) + 0.5;
    const KnownWithin& known = accuracy.known_within;
    Unknowns drawn;
    drawn.uniform = part(number / root);
    drawn.model = power(known.model_error, normal_quantile(number / static_cast<double>(count)));
    const double sizes = power(known.error_size, normal_quantile(part(number / (root * root))));
    const double model = accuracy.left_over > 0 ? drawn.model : 1;
    drawn.growth = accuracy.growth(model * model, sizes * sizes);
    return drawn;
}

}  // namespace detail

VectorXd total_cases(const PredictedAccuracy& accuracy, double repeatability) {
    constexpr Index cases = 4096;
    VectorXd totals(cases);
    for (Index k = 0; k < cases; ++k) {
        const detail::Unknowns drawn = detail::draw_unknowns(k, cases, accuracy);
        const double freedom = accuracy.degrees_of_freedom;
        const double chi_squared = detail::chi_squared_quantile(drawn.uniform, freedom) / freedom;
        const double parameters = drawn.growth * accuracy.rms * accuracy.rms;
        const double model = drawn.model * accuracy.left_over;
        totals[k] =
            std::sqrt(chi_squared * parameters + model * model + repeatability * repeatability);
    }
    return totals;
}

PredictedTotal predict_total(const PredictedAccuracy& accuracy) {
    const VectorXd totals = total_cases(accuracy);
    return {std::hypot(accuracy.rms, accuracy.left_over),
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
        // Poses and prior are both diagonal in the basis in which the prior is, M being 1.
        const MatrixXd half = cholesky.matrixL().solve(prior);
        const auto known = detail::eigen_decomposition(cholesky.matrixL().solve(half.transpose()));
        const MatrixXd by_direction = known.eigenvectors().transpose() * spread;
        accuracy.by_direction = by_direction.rowwise().squaredNorm() / sum;
        accuracy.prior_part = known.eigenvalues().cwiseMax(0).cwiseMin(1);
    }
    accuracy.percentile95 = quantile(std::move(errors), 0.95, detail::QuantileRule::Upper);
    return accuracy;
}

InformationByNoise information_by_noise(const Campaign& campaign, const Parameters& parameters,
                                        const RowMatrixXd& configurations,
                                        const RowMatrixXd& repeats) {
    constexpr double step = 1e-3;
    const auto with = [&](double model_square, double noise_square) {
        Campaign noisy = campaign;
        noisy.model_error *= std::sqrt(model_square);
        noisy.model_error_orientation *= std::sqrt(model_square);
        noisy.joint_repeatability *= std::sqrt(noise_square);
        return information(make_blocks(noisy, parameters, configurations, repeats / noise_square));
    };
    return {(with(1 - step, 1) - with(1 + step, 1)) / (2 * step),
            (with(1, 1 - step) - with(1, 1 + step)) / (2 * step)};
}

}  // namespace posewise
