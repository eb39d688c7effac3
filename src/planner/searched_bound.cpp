#include "searched_bound.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "../core/nlopt_adapter.hpp"
#include "../core/parallel.hpp"
#include "../criteria/information_function.hpp"

namespace posewise::detail {
namespace {

constexpr Index start_limit = 4000;  // looked at
constexpr Index search_count = 12;   // followed uphill

double sensitivity(const DesignSpace& space, const VectorXd& q, const MatrixXd& Z) {
    return Z.cwiseProduct(space.information(q)).sum();
}

/// The starts of largest sensitivity, largest first.
std::vector<Index> most_sensitive(const DesignSpace& space, const MatrixXd& Z,
                                  const RowMatrixXd& starts) {
    const Index count = std::min(starts.rows(), start_limit);
    VectorXd values(count);
    for_each_range(count, 64, [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            values[i] = sensitivity(space, starts.row(i).transpose(), Z);
        }
    });
    std::vector<Index> order(static_cast<std::size_t>(count));
    std::iota(order.begin(), order.end(), Index{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return values[a] > values[b]; });
    order.resize(static_cast<std::size_t>(std::min(count, search_count)));
    return order;
}

/// Uphill from one start; where that leaves the feasible, along the constraint.
Maximum climb(const DesignSpace& space, const MatrixXd& Z, const VectorXd& start,
              const StopSignal& stop) {
    BoxProblem problem;
    problem.lower = space.lower;
    problem.upper = space.upper;
    problem.margin = space.margin;
    problem.value = [&](const VectorXd& q, VectorXd* slope) {
        if (slope != nullptr) *slope = space.information_gradient(q, Z);
        return sensitivity(space, q, Z);
    };
    MaximiseOptions options;
    options.stop = stop;
    options.value_tolerance = 1e-9;
    Maximum best = maximise(problem, start, options);  // the best feasible point met
    if (!space.margin) return best;
    options.method = Method::Cobyla;
    options.first_step = 0.05;
    options.evaluation_limit = 300;
    return maximise(problem, best.x, options);
}

}  // namespace

double search_bound(const DesignSpace& space, const Objective& objective, const HeldPoses& held,
                    Index pose_count, const MatrixXd& M, const RowMatrixXd& starts,
                    Index iterations, const StopSignal& stop) {
    double bound = std::numeric_limits<double>::infinity();
    if (!has_information_function(objective.criterion)) return bound;
    const auto K = static_cast<double>(pose_count);
    MatrixXd H = held.information;
    if (H.size() == 0) H.setZero(M.rows(), M.cols());
    MatrixXd relaxed = M;
    for (Index t = 0; t < iterations && !stop.is_set(); ++t) {
        if (!std::isfinite(evaluate(objective, relaxed))) break;
        const MatrixXd Z = supporting_matrix(objective, relaxed);
        const auto order = most_sensitive(space, Z, starts);
        std::vector<Maximum> maxima(order.size());
        for_each_index(static_cast<Index>(order.size()), [&](Index i) {
            const auto s = static_cast<std::size_t>(i);
            maxima[s] = climb(space, Z, starts.row(order[s]).transpose(), stop);
        });
        if (maxima.empty() || stop.is_set()) break;
        const auto best =
            std::max_element(maxima.begin(), maxima.end(),
                             [](const Maximum& a, const Maximum& b) { return a.value < b.value; });
        const double phi = Z.cwiseProduct(H).sum() + K * best->value;
        bound = std::min(bound, value_of_information(objective, phi, M.rows()));
        const double step = 1 / (K + static_cast<double>(t) + 1);
        relaxed += step * (H + K * space.information(best->x) - relaxed);
    }
    return bound;
}

}  // namespace posewise::detail
