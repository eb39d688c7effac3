#include "bound.hpp"

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "core/sensitivities.hpp"
#include "criteria/information_function.hpp"
#include "criteria/regular.hpp"
#include "criteria/row_value.hpp"
#include "objective_bound.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
OpenChoices all_open(const Blocks& candidates, const SelectOptions& options, const MatrixXd& held) {
    return {held, [&](const MatrixXd& Z) { return sensitivities(candidates, Z); },
            [&](const VectorXd& values) { return most_valuable(values, options); }};
}

MatrixXd held_information(const Blocks& candidates, const SelectOptions& options) {
    return information_of(options.held_rows, candidates.parameter_count());
}

void check_takes_nuisance(Criterion criterion) {
    if (!needs_test_poses(criterion) && has_information_function(criterion)) return;
    throw InputError("criterion " + std::string(criterion_name(criterion)) +
                     " cannot leave columns out of account (`focus`, nuisance columns); "
                     "must be d, a, e, o1, o3 or o5");
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
    check_takes_nuisance(options.criterion);
    objective.nuisance = options.nuisance;
    return objective;
}

double choice_value(const Objective& objective, const Blocks& candidates,
                    const SelectOptions& options, const std::vector<Index>& poses) {
    return evaluate_rows(objective, stack(options.held_rows, take(candidates, poses).matrix));
}

double choice_value(const Blocks& candidates, const SelectOptions& options,
                    const std::vector<Index>& poses) {
    return choice_value(make_objective(candidates, options), candidates, options, poses);
}

double upper_bound(const Blocks& candidates, const SelectOptions& options,
                   const Certificate& certificate) {
    Objective objective = make_objective(candidates, options);
    objective.sharpness = certificate.sharpness;
    const MatrixXd held = held_information(candidates, options);
    return price(objective, certificate.M, all_open(candidates, options, held), 1).bound;
}

double bound_rounding(Criterion criterion, const MatrixXd& M) {
    constexpr double each = 4 * std::numeric_limits<double>::epsilon();
    const Eigen::LLT<MatrixXd> cholesky(M);
    if (!is_regular(cholesky, M)) return std::numeric_limits<double>::infinity();
    const VectorXd variances = inverse(cholesky).diagonal();
    const bool is_of_eigenvalues = !is_smooth(criterion) || criterion == Criterion::O5;
    if (is_of_eigenvalues && !needs_test_poses(criterion)) {
        return each * M.trace() * variances.sum();
    }
    return each * static_cast<double>(M.rows()) * M.diagonal().dot(variances);
}

double efficiency(Criterion criterion, double value, double bound, Index parameter_count) {
    if (!std::isfinite(value) || !std::isfinite(bound)) return 0;
    const double ratio = is_logarithm(criterion)
                             ? exponential((value - bound) / static_cast<double>(parameter_count))
                             : value / bound;
    return std::clamp(ratio, 0.0, 1.0);
}

}  // namespace posewise::detail
