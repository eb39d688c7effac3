#include "posewise/selection/bound.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "sensitivity.hpp"

namespace posewise {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double sum_at(const VectorXd& values, const std::vector<Index>& indices) {
    return std::accumulate(indices.begin(), indices.end(), 0.0,
                           [&](double sum, Index i) { return sum + values[i]; });
}

double sum_of_largest(const VectorXd& values, Index count) {
    return sum_at(values, largest_indices(values, count));
}

/// The largest sum(a) / sum(b) over all K-subsets, exactly, for a, b >= 0 [Dinkelbach 1967].
double largest_ratio(const VectorXd& a, const VectorXd& b, Index count) {
    double ratio = 0;
    for (int iteration = 0; iteration < 100; ++iteration) {
        const auto subset = largest_indices(a - ratio * b, count);
        const double denominator = sum_at(b, subset);
        if (!(denominator > 0)) return infinity;
        const double next = sum_at(a, subset) / denominator;
        if (next <= ratio * (1 + 1e-15)) break;
        ratio = next;
    }
    return ratio * (1 + 1e-12);
}

/// lambda_min / lambda_max <= v^T M v / u^T M u for any unit v, u.
double condition_bound(const Blocks& candidates, Index pose_count, const MatrixXd& M) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
    const VectorXd weak = eigen.eigenvectors().col(0);
    const VectorXd strong = eigen.eigenvectors().col(M.rows() - 1);
    return std::min(1.0, std::sqrt(largest_ratio(
                             sensitivities(candidates, weak * weak.transpose()),
                             sensitivities(candidates, strong * strong.transpose()), pose_count)));
}

/// The information function phi as an increasing function of the criterion's value, its slope,
/// and the way back.
struct InformationScale {
    Criterion criterion;
    double parameter_count;
    double pose_count;

    double phi(double value) const {
        switch (criterion) {
            case Criterion::D:
                return std::exp(value / parameter_count);
            case Criterion::O1:
                return pose_count * value * value;
            case Criterion::O3:
            case Criterion::O5:
                return value * value;
            default:
                return value;
        }
    }
    double slope(double value) const {
        switch (criterion) {
            case Criterion::D:
                return phi(value) / parameter_count;
            case Criterion::O1:
            case Criterion::O3:
            case Criterion::O5:
                return 2 * phi(value) / value;
            default:
                return 1;
        }
    }
    double value(double phi) const {
        switch (criterion) {
            case Criterion::D:
                return parameter_count * std::log(phi);
            case Criterion::O1:
                return std::sqrt(phi / pose_count);
            case Criterion::O3:
            case Criterion::O5:
                return std::sqrt(phi);
            default:
                return phi;
        }
    }
};

}  // namespace

double upper_bound(const Objective& objective, const Blocks& candidates, Index pose_count,
                   const MatrixXd& M) {
    const double value = evaluate(objective, M);
    if (!std::isfinite(value)) return infinity;
    if (objective.criterion == Criterion::O2) return condition_bound(candidates, pose_count, M);
    if (objective.criterion == Criterion::O4) {
        const Objective worst_direction = make_objective(Criterion::O3, objective.pose_count);
        return condition_bound(candidates, pose_count, M) *
               upper_bound(worst_direction, candidates, pose_count, M);
    }
    const InformationScale scale{objective.criterion, static_cast<double>(M.rows()),
                                 static_cast<double>(objective.pose_count)};
    const VectorXd d = sensitivities(candidates, scale.slope(value) * gradient(objective, M));
    return scale.value(sum_of_largest(d, pose_count));
}

double tightened_bound(const Objective& objective, const Blocks& candidates, Index pose_count,
                       const MatrixXd& M, Index iterations) {
    double bound = upper_bound(objective, candidates, pose_count, M);
    MatrixXd relaxed = M;
    for (Index t = 0; t < iterations; ++t) {
        const VectorXd d = sensitivities(candidates, gradient(objective, relaxed));
        const double step = 2.0 / static_cast<double>(t + 4);
        relaxed += step * (information(candidates, largest_indices(d, pose_count)) - relaxed);
        bound = std::min(bound, upper_bound(objective, candidates, pose_count, relaxed));
    }
    return bound;
}

double efficiency(Criterion criterion, double value, double bound, Index parameter_count) {
    if (!std::isfinite(value) || !std::isfinite(bound)) return 0;
    const double ratio = criterion == Criterion::D
                             ? std::exp((value - bound) / static_cast<double>(parameter_count))
                             : value / bound;
    return std::clamp(ratio, 0.0, 1.0);
}

}  // namespace posewise
