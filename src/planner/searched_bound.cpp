#include "searched_bound.hpp"

#include <algorithm>
#include <cmath>

#include "core/nlopt_adapter.hpp"
#include "core/parallel.hpp"
#include "core/sensitivities.hpp"
#include "core/statistics.hpp"
#include "criteria/information_function.hpp"
#include "selection/bound.hpp"
#include "selection/objective_bound.hpp"
#include "selection/relaxation.hpp"

namespace posewise::detail {
namespace {

constexpr Index search_count = 24;   // followed uphill, of the pool and of the poses met
constexpr double apart = 0.5;        // rad or m in some joint, at least
constexpr double most_gap = 1e-2;    // of the relaxations over the poses met, at first
constexpr double least_gap = 1e-5;   // and when it ends
constexpr double open_part = 0.05;   // of the gap to the plan, that it may leave of itself
constexpr Index part_size = 2000;    // of the pool, which searches start from
constexpr Index relaxed_size = 300;  // poses of the pool that its relaxation may give weight

/// The most sensitive poses that are apart, after those in `chosen`.
void choose_starts(const RowMatrixXd& poses, const VectorXd& sensitivity, RowMatrixXd& chosen) {
    const Index enough = chosen.rows() + search_count;
    for (const Index i : by_decreasing(sensitivity)) {
        if (chosen.rows() == enough) return;
        if (!is_apart(chosen, poses.row(i), apart)) continue;
        chosen.conservativeResize(chosen.rows() + 1, poses.cols());
        chosen.bottomRows(1) = poses.row(i);
    }
}

/// The poses of the pool that are most sensitive at its relaxed optimum.
RowMatrixXd relaxed_poses(const Objective& objective, const Certificate& certificate,
                          const RowMatrixXd& pool, const Blocks& blocks) {
    Objective softened = objective;
    softened.sharpness = certificate.sharpness;
    std::vector<Index> poses =
        by_decreasing(sensitivities(blocks, supporting_matrix(softened, certificate.M)));
    poses.resize(std::min(poses.size(), static_cast<std::size_t>(relaxed_size)));
    return pool(poses, Eigen::all);
}

/// Uphill from one start; where that leaves the feasible, along the constraint.
Maximum climb(const DesignSpace& space, const MatrixXd& Z, const VectorXd& start,
              const StopSignal& stop) {
    BoxProblem problem;
    problem.lower = space.lower;
    problem.upper = space.upper;
    problem.margin = space.margin;
    double value = 0;  // trace(B Z B^T)
    const auto weigh = [&](const RowMatrixXd& B) {
        RowMatrixXd BZ = B * Z;
        value = BZ.cwiseProduct(B).sum();
        return BZ;
    };
    problem.value = [&](const VectorXd& q, VectorXd* slope) {
        if (slope != nullptr && space.weighed_gradient) {
            *slope = space.weighed_gradient(q, weigh);
            return value;
        }
        if (slope != nullptr) *slope = space.information_gradient(q, Z);
        weigh(space.rows(q));
        return value;
    };
    MaximiseOptions options;
    options.stop = stop;
    options.value_tolerance = 1e-9;
    if (space.margin) {
        options.value_tolerance = 1e-6;
        options.evaluation_limit = 100;
        options.patience = 12;  // beyond the constraint nothing is to be found
    }
    Maximum best = maximise(problem, start, options);  // the best feasible point met
    if (!space.margin) return best;
    options.method = Method::Cobyla;
    options.first_step = 0.05;
    options.evaluation_limit = 300;
    return maximise(problem, best.x, options);
}

/// The maxima met by searches from the most sensitive poses.
std::vector<Maximum> search_maxima(const DesignSpace& space, const MatrixXd& Z,
                                   const RowMatrixXd& pool, const Blocks& blocks,
                                   const Support& support, const StopSignal& stop) {
    RowMatrixXd starts(0, pool.cols());
    choose_starts(support.poses, sensitivities(support.blocks, Z), starts);
    choose_starts(pool, sensitivities(blocks, Z), starts);
    std::vector<Maximum> maxima(static_cast<std::size_t>(starts.rows()));
    for_each_index(starts.rows(), [&](Index i) {
        maxima[static_cast<std::size_t>(i)] = climb(space, Z, starts.row(i).transpose(), stop);
    });
    return maxima;
}

}  // namespace

double search_bound(const DesignSpace& space, const Objective& objective,
                    const SelectOptions& options, const PlannedPoses& plan, const RowMatrixXd& pool,
                    const Blocks& blocks, Index iterations, const StopSignal& stop) {
    double bound = std::numeric_limits<double>::infinity();
    if (!has_information_function(objective.criterion)) return bound;
    SelectOptions anywhere = options;  // a pose as often as may be: others are arbitrarily near
    anywhere.repeat_limit = options.pose_count;
    anywhere.excluded.clear();
    anywhere.positions.resize(0, 0);
    anywhere.least_distance = 0;
    anywhere.gap = most_gap;
    anywhere.stop = stop;
    const auto K = static_cast<double>(options.pose_count);
    if (space.margin) iterations = (iterations + 3) / 4;  // ten times as long along constraints
    VectorXd weights;
    Support support;
    for (Index i = 0; i < plan.configurations.rows() && !stop.is_set(); ++i) {
        support.add(space, plan.configurations.row(i));
    }
    const Certificate& certificate = plan.pool_choice.certificate;
    if (certificate.M.size() > 0 && !stop.is_set()) {
        support.add(space, relaxed_poses(objective, certificate, pool, blocks));
    }
    const Blocks part_blocks = take_first(blocks, part_size);
    const RowMatrixXd part = pool.topRows(part_blocks.count());
    for (Index t = 0; t < iterations && !stop.is_set(); ++t) {
        if (weights.size() > 0)
            weights.conservativeResizeLike(VectorXd::Zero(support.blocks.count()));
        const Relaxation relaxation = relax(objective, support.blocks, anywhere, weights);
        const Certificate& relaxed = relaxation.certificate;
        weights = relaxation.weights;
        Objective softened = objective;
        softened.sharpness = relaxed.sharpness;
        if (!std::isfinite(evaluate(softened, relaxed.M))) break;
        const MatrixXd Z = supporting_matrix(softened, relaxed.M);
        const double inside = sensitivities(support.blocks, Z).maxCoeff();
        const std::vector<Maximum> maxima =
            search_maxima(space, Z, part, part_blocks, support, stop);
        if (stop.is_set()) break;
        const double held = Z.cwiseProduct(held_information(blocks, options)).sum();
        double largest = inside;
        for (const Maximum& maximum : maxima) {
            largest = std::max(largest, maximum.value);
            const bool is_new = maximum.value > (1 + 1e-6) * inside &&
                                is_apart(support.poses, maximum.x.transpose(), 1e-4);
            if (is_new) support.add(space, maximum.x.transpose());
        }
        const double phi =
            (1 + bound_rounding(objective.criterion, relaxed.M)) * (held + K * largest);
        bound = std::min(bound, value_of_information(objective, phi, Z.rows()));
        const double excess = largest / inside - 1;
        const double reached =
            efficiency(objective.criterion, plan.value, bound, interest_count(objective, Z.rows()));
        if (excess + anywhere.gap <= open_part * (1 / reached - 1)) break;
        if (excess <= 1e-4 && anywhere.gap <= least_gap) break;
        anywhere.gap = std::clamp(0.1 * excess, least_gap, anywhere.gap);
    }
    return bound;
}

}  // namespace posewise::detail
