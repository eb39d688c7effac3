#include "posewise/criteria/criterion.hpp"

#include <algorithm>
#include <cctype>
#include <utility>

#include "core/decompositions.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "row_value.hpp"
#include "spectral.hpp"

namespace posewise {
namespace {

/// In the order of the enumeration.
constexpr std::array<std::string_view, all_criteria.size()> names{"o1", "o2", "o3", "o4", "o5",
                                                                  "a",  "d",  "e",  "g",  "v"};

}  // namespace

std::string_view criterion_name(Criterion criterion) {
    return names[static_cast<std::size_t>(criterion)];
}

Criterion parse_criterion(std::string_view name) {
    std::string lower(name);
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (lower == "i") return Criterion::V;
    std::string all;
    for (const Criterion criterion : all_criteria) {
        if (criterion_name(criterion) == lower) return criterion;
        all += (all.empty() ? "" : ", ") + std::string(criterion_name(criterion));
    }
    throw InputError(detail::quote(name) + " is no criterion; must be one of " + all +
                     " (or i, the same as v)");
}

VectorXd singular_values(const RowMatrixXd& stacked) {
    if (!stacked.allFinite()) {
        throw InputError("stacked blocks have a value that is not a finite number");
    }
    VectorXd values = VectorXd::Zero(stacked.cols());
    const Index count = std::min(stacked.rows(), stacked.cols());
    if (count == 0) return values;
    MatrixXd R = stacked;
    if (stacked.rows() > stacked.cols()) R = detail::triangular_factor(std::move(R));
    values.head(count) = detail::singular_values_of(R);
    return values;
}

double evaluate(Criterion criterion, const VectorXd& singular_values, Index pose_count) {
    if (needs_test_poses(criterion)) {
        throw InputError("criterion " + std::string(criterion_name(criterion)) +
                         " needs test poses, singular values are not enough");
    }
    const detail::Objective objective = detail::make_objective(criterion, pose_count);
    const auto s = singular_values.array();
    if (s.size() == 0) return detail::value_if_singular;
    const double largest = s[0];
    const double least = s[s.size() - 1];
    if (!s.isFinite().all() || !(least > 1e-12 * largest)) {
        return detail::value_if_singular;
    }
    return spectral_criterion(objective, s.square().reverse().matrix()).value;
}

double evaluate_rows(Criterion criterion, const RowMatrixXd& stacked, Index pose_count,
                     const Blocks* test_poses) {
    return evaluate_rows(detail::make_objective(criterion, pose_count, test_poses), stacked);
}

double evaluate(Criterion criterion, const MatrixXd& M, Index pose_count,
                const Blocks* test_poses) {
    return evaluate(detail::make_objective(criterion, pose_count, test_poses), M);
}

}  // namespace posewise
