#include "bound.hpp"

#include <algorithm>
#include <cmath>

#include "../core/decompositions.hpp"
#include "../core/elementary.hpp"
#include "../core/sensitivities.hpp"
#include "../criteria/information_function.hpp"
#include "../criteria/spectral.hpp"
#include "limits.hpp"
#include "objective_bound.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

double sum_of(const VectorXd& values, const std::vector<Taken>& taken) {
    double sum = 0;
    for (const auto& [candidate, count] : taken) {
        sum += static_cast<double>(count) * values[candidate];
    }
    return sum;
}

/// The largest (a0 + sum a) / (b0 + sum b) over all choices, exactly, for a, b >= 0 [Dinkelbach
/// 1967].
double largest_ratio(const VectorXd& a, const VectorXd& b, double a0, double b0,
                     const SelectOptions& options) {
    double ratio = 0;
    for (int iteration = 0; iteration < 100; ++iteration) {
        const auto taken = most_valuable(a - ratio * b, options);
        const double denominator = b0 + sum_of(b, taken);
        if (!(denominator > 0)) return infinity;
        const double next = (a0 + sum_of(a, taken)) / denominator;
        if (next <= ratio * (1 + 1e-15)) break;
        ratio = next;
    }
    return ratio * (1 + 1e-12);
}

/// lambda_min / lambda_max <= trace(Z M*) / trace(Y M*) for any Z, Y >= 0 of trace 1; here those of
/// the softened extreme eigenvalues of M.
double condition_bound(const Blocks& candidates, const SelectOptions& options, const MatrixXd& M,
                       double p) {
    const auto eigen = eigen_decomposition(M);
    const VectorXd& lambda = eigen.eigenvalues();
    const auto weighted = [&](const Eigen::ArrayXd& weights) -> MatrixXd {
        return eigen.eigenvectors() * (weights / weights.sum()).matrix().asDiagonal() *
               eigen.eigenvectors().transpose();
    };
    const Index last = lambda.size() - 1;
    Eigen::ArrayXd weak = VectorXd::Unit(lambda.size(), 0);
    Eigen::ArrayXd strong = VectorXd::Unit(lambda.size(), last);
    if (std::isfinite(p)) {
        weak = powers(lambda[0] / lambda.array(), p + 1);
        strong = powers(lambda.array() / lambda[last], p - 1);
    }
    const MatrixXd Z = weighted(weak);
    const MatrixXd Y = weighted(strong);
    const MatrixXd H = held_information(candidates, options);
    const double ratio = largest_ratio(sensitivities(candidates, Z), sensitivities(candidates, Y),
                                       Z.cwiseProduct(H).sum(), Y.cwiseProduct(H).sum(), options);
    return std::min(1.0, std::sqrt(ratio));
}

}  // namespace

MatrixXd held_information(const Blocks& candidates, const SelectOptions& options) {
    if (options.held.size() > 0) return options.held;
    const Index L = candidates.parameter_count();
    return MatrixXd::Zero(L, L);
}

Objective make_objective(const Blocks& candidates, const SelectOptions& options) {
    const Blocks* test_poses = options.test_poses != nullptr ? options.test_poses : &candidates;
    Objective objective =
        make_objective(options.criterion, options.pose_count + options.held_pose_count, test_poses);
    if (options.nuisance.empty()) return objective;
    const Index L = candidates.parameter_count();
    for (std::size_t k = 0; k < options.nuisance.size(); ++k) {
        const Index column = options.nuisance[k];
        if (column < 0 || column >= L || (k > 0 && column <= options.nuisance[k - 1])) {
            throw InputError("nuisance column is " + std::to_string(column) +
                             ", must be from 0 to " + std::to_string(L - 1) + " and ascending");
        }
    }
    if (static_cast<Index>(options.nuisance.size()) == L) {
        throw InputError("all " + std::to_string(L) +
                         " columns are nuisance, at least one must be of interest");
    }
    if (objective.test_poses != nullptr || !has_information_function(options.criterion)) {
        throw InputError("criterion " + std::string(criterion_name(options.criterion)) +
                         " cannot leave columns out of account (--focus robot, nuisance columns); "
                         "must be d, a, e, o1, o3 or o5");
    }
    objective.nuisance = options.nuisance;
    return objective;
}

double choice_value(const Blocks& candidates, const SelectOptions& options,
                    const std::vector<Index>& poses) {
    return evaluate(make_objective(candidates, options),
                    held_information(candidates, options) + information(candidates, poses));
}

double upper_bound(const Objective& objective, const Blocks& candidates,
                   const SelectOptions& options, const MatrixXd& M) {
    if (!std::isfinite(evaluate(objective, M))) return infinity;
    if (!has_information_function(objective.criterion)) {
        const double condition = condition_bound(candidates, options, M, objective.sharpness);
        if (objective.criterion == Criterion::O2) return condition;
        Objective worst_direction = objective;
        worst_direction.criterion = Criterion::O3;
        return condition * upper_bound(worst_direction, candidates, options, M);
    }
    const MatrixXd Z = supporting_matrix(objective, M);
    const VectorXd d = sensitivities(candidates, Z);
    const double phi = Z.cwiseProduct(held_information(candidates, options)).sum() +
                       sum_of(d, most_valuable(d, options));
    return value_of_information(objective, phi, M.rows());
}

double upper_bound(const Blocks& candidates, const SelectOptions& options,
                   const Certificate& certificate) {
    Objective objective = make_objective(candidates, options);
    objective.sharpness = certificate.sharpness;
    return upper_bound(objective, candidates, options, certificate.M);
}

double efficiency(Criterion criterion, double value, double bound, Index parameter_count) {
    if (!std::isfinite(value) || !std::isfinite(bound)) return 0;
    const double ratio = is_logarithm(criterion)
                             ? exponential((value - bound) / static_cast<double>(parameter_count))
                             : value / bound;
    return std::clamp(ratio, 0.0, 1.0);
}

}  // namespace posewise::detail
