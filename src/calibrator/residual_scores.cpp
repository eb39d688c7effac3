#include "residual_scores.hpp"

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/products.hpp"
#include "core/statistics.hpp"
#include "normal_equations.hpp"

namespace posewise::detail {
namespace {

/// Less than this part of a column is outside what the model takes up: then nothing of it shows.
constexpr double least_part = 1e-6;

void describe_rows(const Sensor& sensor, const Seen& is_seen, LinearFit& fit) {
    for (Index i = 0; i < is_seen.rows(); ++i) {
        for (const Index row : seen_rows(sensor, is_seen.row(i))) {
            fit.is_length.push_back(!sensor.has_lengths() || !sensor.is_angle(row));
        }
    }
}

/// W_ii^-1 of a configuration.
MatrixXd left_out_factor(const LinearFit& fit, Index i) {
    constexpr double least = 1e-9;
    const auto U = fit.U.middleRows(fit.begin(i), fit.rows(i));
    MatrixXd W = -U * U.transpose();
    W.diagonal().array() += 1 + least;
    return W.llt().solve(MatrixXd::Identity(W.rows(), W.cols()));
}

/// X in combinations that are independent beside the model, T with V = T^T (X^T W X) T = I.
MatrixXd standardise(const MatrixXd& XX, const MatrixXd& V) {
    const VectorXd norms = XX.diagonal().cwiseSqrt();
    const VectorXd inverse = (norms.array() > 0).select(norms.cwiseInverse(), 0);
    const auto eigen = eigen_decomposition(inverse.asDiagonal() * V * inverse.asDiagonal());
    Index kept = 0;
    while (kept < V.rows() && eigen.eigenvalues()[V.rows() - 1 - kept] > least_part) ++kept;
    const VectorXd roots = eigen.eigenvalues().tail(kept).cwiseSqrt().cwiseInverse();
    return inverse.asDiagonal() * eigen.eigenvectors().rightCols(kept) * roots.asDiagonal();
}

/// Scale and its freedom from the parts of the score that single configurations have.
void find_scale(const LinearFit& fit, const RowMatrixXd& WX, const VectorXd& left, Score& score) {
    double squares = 0;
    double expected = 0;
    double squared_expected = 0;
    for (Index i = 0; i < fit.count(); ++i) {
        const auto x = WX.middleRows(fit.begin(i), fit.rows(i));
        const auto u = fit.U.middleRows(fit.begin(i), fit.rows(i));
        const double part = x.squaredNorm() - (u.transpose() * x).squaredNorm();
        squares += (x.transpose() * left.segment(fit.begin(i), fit.rows(i))).squaredNorm();
        expected += part;
        squared_expected += part * part;
    }
    if (!(expected > 0)) return;
    // Not more than what all rows leave free.
    const double free = static_cast<double>(left.size()) - score.with.U.squaredNorm();
    score.freedom =
        std::clamp(expected * expected / squared_expected - static_cast<double>(score.columns), 1.0,
                   std::max(1.0, free));
    score.scale =
        squares / expected * (score.freedom + static_cast<double>(score.columns)) / score.freedom;
}

/// The same from all that is left: each configuration counts as one number.
void find_scale_of_all(const LinearFit& with, Score& score) {
    const auto rows = static_cast<double>(with.e.size());
    const double free = rows - with.U.squaredNorm();
    if (!(free > 0)) return;
    score.scale = with.e.squaredNorm() / free;
    score.freedom = std::max(1.0, static_cast<double>(with.count()) * free / rows);
}

}  // namespace

std::optional<LinearFit> linear_fit(const IdentificationProblem& problem,
                                    const Parameters& parameters, FitPrior prior) {
    const LinearisedSystem system = linearise(problem, parameters, Equations::All);
    NormalEquations equations = normal_equations(problem, system);
    const Campaign& campaign = problem.campaign;
    if (prior == FitPrior::ExpectedSizes && !campaign.spread.is_prior) {
        const Index begin = base_parameter_count(campaign);
        const Index count = campaign.robot.parameter_count();
        equations.M.diagonal().segment(begin, count).array() += 1;
        equations.g.segment(begin, count) -=
            parameters.robot.cwiseQuotient(parameter_scale(campaign).segment(begin, count));
    }
    if (equations.M.rows() == 0) return std::nullopt;
    const VectorXd inverse = equations.M.diagonal().cwiseSqrt().cwiseInverse();
    const MatrixXd L = cholesky(inverse.asDiagonal() * equations.M * inverse.asDiagonal());
    if (L.rows() == 0) return std::nullopt;
    const Index rows = problem.observation_count();
    RowMatrixXd scaled = system.J().topRows(rows) * inverse.asDiagonal();
    LinearFit fit{solve_lower(L, scaled.transpose()).transpose(), {}, system.first_row, {}};
    // One step to the optimum: residuals r - B M^-1 g.
    const VectorXd c =
        L.triangularView<Eigen::Lower>().solve(VectorXd(inverse.cwiseProduct(equations.g)));
    fit.e = system.r().head(rows) - fit.U * c;
    describe_rows(*campaign.sensor, problem.means.is_seen, fit);
    return fit;
}

LeftOut leave_out(const LinearFit& fit, Index configuration) {
    const auto e = fit.e.segment(fit.begin(configuration), fit.rows(configuration));
    LeftOut left{left_out_factor(fit, configuration) * e, 0};
    left.squares = e.dot(left.residuals);
    return left;
}

double held_out_squares(const LinearFit& fit, const std::vector<Index>& configurations) {
    double sum = 0;
    for (const Index i : configurations) {
        const VectorXd t = leave_out(fit, i).residuals;
        for (Index row = 0; row < t.size(); ++row) {
            if (fit.is_length[static_cast<std::size_t>(fit.begin(i) + row)]) sum += t[row] * t[row];
        }
    }
    return sum;
}

double held_out_ratio(const LinearFit& fit) {
    double squares = 0;
    for (Index row = 0; row < fit.e.size(); ++row) {
        if (fit.is_length[static_cast<std::size_t>(row)]) squares += fit.e[row] * fit.e[row];
    }
    return held_out_squares(fit, all_but(fit.count(), {})) / squares;
}

bool Score::is_beyond(double chance) const {
    if (columns == 0 || freedom <= 0) return false;
    const auto q = static_cast<double>(columns);
    return statistic > mixture_quantile(1 - chance, {{q, q}}, freedom);
}

Score score(const LinearFit& fit, const RowMatrixXd& X, double prior_scale, ScaleFrom scale_from) {
    Score score;
    const MatrixXd UX = fit.U.transpose() * X;
    const MatrixXd XX = X.transpose() * X;
    const MatrixXd T = standardise(XX, XX - UX.transpose() * UX);
    score.columns = T.cols();
    score.with = fit;
    if (score.columns == 0) return score;
    const RowMatrixXd WX = X * T - fit.U * (UX * T);
    const VectorXd z = (X * T).transpose() * fit.e;
    score.with.e -= WX * z;
    score.with.U.conservativeResize(Eigen::NoChange, fit.U.cols() + score.columns);
    score.with.U.rightCols(score.columns) = WX;
    if (scale_from == ScaleFrom::Score) {
        find_scale(fit, WX, score.with.e, score);
    } else {
        find_scale_of_all(score.with, score);
    }
    const MatrixXd by_noise = WX.transpose() * WX;
    const MatrixXd variance = prior_scale * MatrixXd::Identity(z.size(), z.size()) +
                              (score.scale - prior_scale) * by_noise;
    score.statistic = z.dot(variance.llt().solve(z));
    score.effect = T * z;
    score.deviations = (T * variance * T.transpose()).diagonal().cwiseSqrt();
    return score;
}

RowMatrixXd from_member(const LinearFit& fit, const RowMatrixXd& X,
                        const std::vector<Index>& members, Index first) {
    RowMatrixXd part = RowMatrixXd::Zero(X.rows(), X.cols());
    for (auto i = static_cast<std::size_t>(first); i < members.size(); ++i) {
        const Index begin = fit.begin(members[i]);
        part.middleRows(begin, fit.rows(members[i])) = X.middleRows(begin, fit.rows(members[i]));
    }
    return part;
}

ChangePoint find_change_point(const LinearFit& fit, const RowMatrixXd& X,
                              const std::vector<Index>& members, Index least) {
    MatrixXd XX = MatrixXd::Zero(X.cols(), X.cols());
    MatrixXd UX = MatrixXd::Zero(fit.U.cols(), X.cols());
    VectorXd Xe = VectorXd::Zero(X.cols());
    ChangePoint best;
    for (Index k = std::ssize(members) - 1; k >= least; --k) {
        const Index i = members[static_cast<std::size_t>(k)];
        const auto x = X.middleRows(fit.begin(i), fit.rows(i));
        XX += x.transpose() * x;
        UX += fit.U.middleRows(fit.begin(i), fit.rows(i)).transpose() * x;
        Xe += x.transpose() * fit.e.segment(fit.begin(i), fit.rows(i));
        if (std::ssize(members) - k < least) continue;
        const MatrixXd T = standardise(XX, XX - UX.transpose() * UX);
        const double statistic = (T.transpose() * Xe).squaredNorm();
        if (statistic > best.statistic) best = {k, statistic};
    }
    return best;
}

}  // namespace posewise::detail
