#include "variances.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/decompositions.hpp"
#include "core/products.hpp"

namespace posewise::detail {
namespace {

/// The observations' equations that are lengths, and those that are angles.
std::array<std::vector<Index>, 2> rows_by_kind(const IdentificationProblem& problem) {
    const Sensor& sensor = *problem.campaign.sensor;
    std::array<std::vector<Index>, 2> rows;
    Index row = 0;
    for (Index i = 0; i < problem.means.configuration_count(); ++i) {
        for (const Index of_all : seen_rows(sensor, problem.means.is_seen.row(i))) {
            rows[sensor.is_angle(of_all) ? 1 : 0].push_back(row++);
        }
    }
    return rows;
}

/// The lengths' and the angles' parts of a linearised system, in parameters in which all of the
/// information is the identity: Q^T Q and Q^T r, Q = J root of their rows.
struct Part {
    MatrixXd information;
    VectorXd gradient;
    double squares = 0;
    double count = 0;
};

Part take_part(const LinearisedSystem& system, const std::vector<Index>& rows,
               const MatrixXd& root) {
    const RowMatrixXd of_kind = system.augmented(rows, Eigen::all);
    const Index size = root.cols();
    RowMatrixXd whitened(of_kind.rows(), size + 1);
    whitened << of_kind.leftCols(size) * root, of_kind.col(size);
    const MatrixXd all = gram(whitened);
    return {all.topLeftCorner(size, size), all.row(size).head(size).transpose(), all(size, size),
            static_cast<double>(rows.size())};
}

/// Two kinds of observations without a prior, in the directions in which the information of both is
/// diagonal: of lengths `share`, of angles 1 - share.
struct Directions {
    VectorXd share;
    VectorXd gradient;  ///< of lengths, that of angles its negative: they are at the optimum
    std::array<double, 2> squares;
    std::array<double, 2> counts;

    /// Under these variances, by what each kind's residuals are once the others count as little as
    /// these say.
    std::array<ResidualVariance, 2> follow(const std::array<double, 2>& factors) const {
        const double w = 1 / factors[0];
        const double v = 1 / factors[1];
        const Eigen::ArrayXd m = w * share.array() + v * (1 - share.array());
        const Eigen::ArrayXd step = (w - v) * gradient.array() / m;
        const double cross = 2 * (step * gradient.array()).sum();
        const double of_lengths = squares[0] - cross + (step.square() * share.array()).sum();
        const double of_angles = squares[1] + cross + (step.square() * (1 - share.array())).sum();
        const double used = (w * share.array() / m).sum();
        const double free_lengths = counts[0] - used;
        const double free_angles = counts[1] - (static_cast<double>(share.size()) - used);
        return {ResidualVariance{of_lengths / free_lengths, free_lengths},
                ResidualVariance{of_angles / free_angles, free_angles}};
    }
};

/// The fixed point of follow(), from one variance of all; nothing where there is none in reach.
std::vector<ResidualVariance> find_fixed_point(const Directions& directions, double factor) {
    constexpr int limit = 200;
    constexpr double tolerance = 1e-6;
    constexpr double reach = 1e6;
    constexpr double least_freedom = 1;
    std::array<double, 2> factors{factor, factor};
    for (int i = 0; i < limit; ++i) {
        const auto next = directions.follow(factors);
        bool stays = true;
        for (std::size_t kind = 0; kind < 2; ++kind) {
            const auto& [found, freedom] = next[kind];
            const bool is_in_reach = found > factor / reach && found < factor * reach;
            if (!(freedom >= least_freedom && is_in_reach)) return {};
            stays = stays && std::abs(found - factors[kind]) <= tolerance * found;
            factors[kind] = found;
        }
        if (stays) return {next.begin(), next.end()};
    }
    return {};
}

/// As far as the parameters leave something over of both.
std::vector<ResidualVariance> quotients(const Part& lengths, const Part& angles) {
    const double free_lengths = lengths.count - lengths.information.trace();
    const double free_angles = angles.count - angles.information.trace();
    if (!(free_lengths >= 1 && free_angles >= 1)) return {};
    return {{lengths.squares / free_lengths, free_lengths},
            {angles.squares / free_angles, free_angles}};
}

}  // namespace

MatrixXd find_variances(const IdentificationProblem& problem, const LinearisedSystem& system,
                        const MatrixXd& root, Estimate& estimate) {
    const bool has_prior = problem.campaign.spread.is_prior;
    const double factor = has_prior ? 1 : estimate.variance_factor;
    MatrixXd covariance = factor * root * root.transpose();
    const auto rows = rows_by_kind(problem);
    if (rows[0].empty() || rows[1].empty() || estimate.degrees_of_freedom <= 0) return covariance;
    const Part lengths = take_part(system, rows[0], root);
    const Part angles = take_part(system, rows[1], root);
    if (has_prior || root.cols() == 0) {
        estimate.variance_by_kind = quotients(lengths, angles);
        return covariance;
    }
    const auto eigen = eigen_decomposition(lengths.information);
    const VectorXd share = eigen.eigenvalues().cwiseMax(0).cwiseMin(1);
    const Directions directions{share,
                                eigen.eigenvectors().transpose() * lengths.gradient,
                                {lengths.squares, angles.squares},
                                {lengths.count, angles.count}};
    estimate.variance_by_kind = find_fixed_point(directions, factor);
    if (estimate.variance_by_kind.empty()) return covariance;
    const auto& of = estimate.variance_by_kind;
    const VectorXd variances =
        (of[0].factor * share.array() + of[1].factor * (1 - share.array())).matrix();
    const MatrixXd turned = root * eigen.eigenvectors();
    covariance = turned * variances.asDiagonal() * turned.transpose();
    return covariance;
}

}  // namespace posewise::detail
