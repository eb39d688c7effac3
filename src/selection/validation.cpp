#include "validation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/decompositions.hpp"
#include "core/products.hpp"
#include "core/text.hpp"
#include "limits.hpp"
#include "objective_bound.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

void require_at_least(const char* name, Index value, Index least) {
    if (value < least) {
        throw InputError(std::string(name) + " is " + std::to_string(value) +
                         ", must be at least " + std::to_string(least));
    }
}

void validate_limits(const Blocks& candidates, const SelectOptions& options) {
    const Index N = candidates.count();
    require_at_least("repeat limit", options.repeat_limit, 1);
    require_at_least("group limit", options.group_limit, 0);
    for (const Index i : options.excluded) {
        if (i < 0 || i >= N) {
            throw InputError("excluded candidate is " + std::to_string(i) + ", must be from 0 to " +
                             std::to_string(N - 1));
        }
    }
    if (!options.groups.empty() && static_cast<Index>(options.groups.size()) != N) {
        throw InputError("groups has " + std::to_string(options.groups.size()) +
                         " labels, must have one for each of " + std::to_string(N) + " candidates");
    }
    if (!(options.least_distance >= 0) || !std::isfinite(options.least_distance)) {
        throw InputError(fmt::format("least distance is {:g}, must be finite and not negative",
                                     options.least_distance));
    }
    if (options.least_distance > 0 &&
        (options.positions.rows() != N || !options.positions.allFinite())) {
        throw InputError("positions has " + std::to_string(options.positions.rows()) +
                         " rows, must have a finite one for each of " + std::to_string(N) +
                         " candidates");
    }
}

void validate_held(const SelectOptions& options, Index L) {
    if (options.held_rows.rows() == 0) return;
    if (options.held_rows.cols() != L) {
        throw InputError(fmt::format("held rows have {} columns, must have {} as the candidates",
                                     options.held_rows.cols(), L));
    }
    if (!options.held_rows.allFinite()) {
        throw InputError("held rows have a value that is not a finite number");
    }
}

/// Another basis of the space that the columns of V span: each has a row to itself, so that no two
/// read alike.
MatrixXd separate(MatrixXd V) {
    for (Index k = 0; k < V.cols(); ++k) {
        Index row = 0;
        V.col(k).cwiseAbs().maxCoeff(&row);
        V.col(k) /= V(row, k);
        for (Index other = 0; other < V.cols(); ++other) {
            if (other != k) V.col(other) -= V(row, other) * V.col(k);
        }
    }
    return V;
}

/// What makes the diagonal 1.
VectorXd scale_of(const MatrixXd& M) {
    return M.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
}

/// Whether the information matrix tells without doubt that all directions are seen.
bool sees_all(const MatrixXd& M) {
    constexpr double doubt = 1e-8;
    const VectorXd scale = scale_of(M);
    const MatrixXd normalised = scale.asDiagonal() * M * scale.asDiagonal();
    return eigen_decomposition(normalised, Eigen::EigenvaluesOnly).eigenvalues()[0] > doubt;
}

/// Which directions all candidates together leave unseen; empty: none. Their information matrix,
/// that of the first ones if they do, only tells where there is no doubt; else the rows themselves.
std::string describe_unseen(const Blocks& candidates, const SelectOptions& options) {
    constexpr Index first_count = 1000;
    const MatrixXd held = held_information(candidates, options);
    const Index L = held.rows();
    if (candidates.count() > first_count) {
        const Index rows = candidates.first_row[static_cast<std::size_t>(first_count)];
        if (sees_all(held + symmetric_gram(candidates.matrix.topRows(rows)))) return "";
    }
    const MatrixXd M = held + information(candidates);
    if (sees_all(M)) return "";
    const VectorXd scale = scale_of(M);
    const MatrixXd R = triangular_factor_of_many(stack(options.held_rows, candidates.matrix));
    const Index missing = L - count_independent_columns(R);
    if (missing == 0) return "";
    const MatrixXd V = singular_directions(with_columns_of_norm_one(R)).V;
    const MatrixXd unseen = scale.asDiagonal() * separate(V.rightCols(missing));
    std::string directions;
    for (Index k = 0; k < std::min<Index>(missing, 3); ++k) {
        directions += (k > 0 ? "; " : "") +
                      describe_combination(unseen.col(k).stableNormalized(), options.column_names);
    }
    return "all " + std::to_string(candidates.count()) + " candidates together leave " +
           std::to_string(missing) + " of " + std::to_string(L) + " parameter directions unseen (" +
           directions + (missing > 3 ? "; ..." : "") + "); drop redundant parameters" +
           (options.held_rows.rows() == 0 ? ", add poses or state a prior" : " or add poses");
}

/// That K candidates have fewer rows than there are parameters that held rows do not tell; empty:
/// enough. A candidate that is taken again tells nothing new.
std::string describe_too_few(const Blocks& candidates, const SelectOptions& options) {
    const Index L = candidates.parameter_count();
    const RowMatrixXd& beside = options.held_rows;
    const Index held =
        beside.rows() == 0 ? 0 : count_independent_columns(triangular_factor_of_many(beside));
    const std::vector<Index> capacity = capacities(candidates.count(), options);
    std::vector<Index> heights;
    for (Index i = 0; i < candidates.count(); ++i) {
        if (capacity[static_cast<std::size_t>(i)] > 0) heights.push_back(candidates[i].rows());
    }
    std::sort(heights.begin(), heights.end(), std::greater<>());
    Index rows = 0;
    Index counted = 0;
    Index least = 0;
    for (; least < std::ssize(heights) && held + rows < L; ++least) {
        rows += heights[static_cast<std::size_t>(least)];
        if (least < options.pose_count) counted = rows;
    }
    if (least <= options.pose_count) return "";
    return fmt::format(
        "pose count is {}, must be at least {}: {} {} {} rows{}, fewer than the {} parameters{}",
        options.pose_count, least, count_of(options.pose_count, "pose"),
        options.pose_count == 1 ? "has" : "have", counted,
        held > 0 ? fmt::format(" beside {} held", held) : "", L,
        held == 0 ? "; or state a prior" : "");
}

}  // namespace

void validate(const Blocks& candidates, const SelectOptions& options) {
    if (candidates.parameter_count() == 0) throw InputError("candidates have no columns");
    check_values(candidates.matrix);
    if (!options.column_names.empty() &&
        static_cast<Index>(options.column_names.size()) != candidates.parameter_count()) {
        throw InputError("column names are " + std::to_string(options.column_names.size()) +
                         ", must be one for each of " +
                         std::to_string(candidates.parameter_count()) + " columns");
    }
    if (options.test_poses != nullptr &&
        options.test_poses->parameter_count() != candidates.parameter_count()) {
        throw InputError("test poses have " +
                         std::to_string(options.test_poses->parameter_count()) +
                         " columns, must have " + std::to_string(candidates.parameter_count()) +
                         " as the candidates");
    }
    require_at_least("starts", options.starts, 0);
    require_at_least("kicks", options.kicks, 0);
    require_at_least("shortlist", options.shortlist, 0);
    require_at_least("held pose count", options.held_pose_count, 0);
    if (!(options.gap > 0)) {
        throw InputError(fmt::format("gap is {:g}, must be positive", options.gap));
    }
    validate_limits(candidates, options);
    validate_held(options, candidates.parameter_count());
    Index open = 0;
    for (const Index capacity : capacities(candidates.count(), options)) open += capacity;
    if (open == 0 && candidates.count() > 0) {
        throw InputError(
            fmt::format("all {} candidates are excluded or measured already; must "
                        "leave at least one to choose",
                        candidates.count()));
    }
    if (options.pose_count < 1 || options.pose_count > open) {
        throw InputError("pose count is " + std::to_string(options.pose_count) +
                         ", must be from 1 to " + std::to_string(open) +
                         ", the number of candidates allowed (repeats counted)");
    }
}

std::string describe_unidentified(const Blocks& candidates, const SelectOptions& options) {
    const std::string unseen = describe_unseen(candidates, options);
    return unseen.empty() ? describe_too_few(candidates, options) : unseen;
}

}  // namespace posewise::detail
