#include "projected_gradient.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <numeric>

#include "core/elementary.hpp"
#include "criteria/information_function.hpp"

namespace posewise::detail {
namespace {

/// How much better the linear model of slope g can do than w, and the slope at which its best
/// choice ends.
struct LinearGain {
    double gain = 0;
    double threshold = 0;
};

LinearGain linear_gain(const VectorXd& g, const VectorXd& w, const WeightProblem& problem) {
    std::vector<Index> order(static_cast<std::size_t>(g.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return g[a] > g[b]; });
    double left = problem.total;
    LinearGain result{-g.dot(w), 0};
    for (const Index i : order) {
        const double taken = std::min(left, problem.upper[i]);
        result.gain += taken * g[i];
        result.threshold = g[i];
        left -= taken;
        if (!(left > 0)) break;
    }
    return result;
}

/// Of the criterion's value at M.
double logarithm_of(const Objective& objective, double value, const MatrixXd& M) {
    if (!is_logarithm(objective.criterion)) return value > 0 ? logarithm(value) : value;
    return value / static_cast<double>(interest_count(objective, M.rows()));
}

}  // namespace

VectorXd project_on_capped_simplex(const VectorXd& point, const VectorXd& upper, double total) {
    const auto shifted = [&](double shift) {
        return (point.array() - shift).max(0.0).min(upper.array());
    };
    double low = (point - upper).minCoeff();  // everything at its upper bound
    double high = point.maxCoeff();           // everything at zero
    for (int i = 0; i < 100 && high - low > 1e-15 * (1 + std::abs(high)); ++i) {
        const double middle = 0.5 * (low + high);
        (shifted(middle).sum() > total ? low : high) = middle;
    }
    // The sum is piecewise linear in the shift: finish on the piece that bisection found.
    VectorXd result = shifted(high).matrix();
    const double missing = total - result.sum();
    const auto is_free =
        (result.array() > 0 && result.array() < upper.array()).cast<double>().eval();
    if (is_free.sum() > 0) result.array() += is_free * (missing / is_free.sum());
    return result.cwiseMax(0.0).cwiseMin(upper);
}

double log_value(const Objective& objective, const MatrixXd& M) {
    return logarithm_of(objective, evaluate(objective, M), M);
}

MatrixXd log_gradient(const Objective& objective, const MatrixXd& M, double* log_value) {
    double value = 0;
    const MatrixXd slope = gradient(objective, M, &value);
    if (log_value != nullptr) *log_value = logarithm_of(objective, value, M);
    return slope / (is_logarithm(objective.criterion)
                        ? static_cast<double>(interest_count(objective, M.rows()))
                        : value);
}

WeightSearch ascend(const WeightProblem& problem, const VectorXd& start, double tolerance,
                    Index iteration_limit, const StopSignal& stop) {
    constexpr std::size_t memory = 10;
    const auto M_of = [&](const VectorXd& w) -> MatrixXd {
        return problem.held + problem.set.weighted_information(w);
    };
    WeightSearch search{start, M_of(start), 0, 0};
    double value = 0;
    MatrixXd slope_M = log_gradient(problem.objective, search.M, &value);
    if (!std::isfinite(value)) return search;
    VectorXd g = problem.set.sensitivities(slope_M);
    std::deque<double> recent{value};
    double step = problem.total / (static_cast<double>(g.size()) * g.cwiseAbs().maxCoeff());
    while (true) {
        const LinearGain linear = linear_gain(g, search.weights, problem);
        search.threshold = linear.threshold;
        if (linear.gain <= tolerance || search.iterations == iteration_limit || stop.is_set())
            break;
        const VectorXd direction =
            project_on_capped_simplex(search.weights + step * g, problem.upper, problem.total) -
            search.weights;
        const MatrixXd M_direction = problem.set.weighted_information(direction);
        const double slope = g.dot(direction);
        const double floor = *std::min_element(recent.begin(), recent.end());
        double length = 1;
        double next = 0;  // nearly always accepted, so that the slope is wanted, too
        slope_M = log_gradient(problem.objective, search.M + M_direction, &next);
        while (!(next >= floor + 1e-4 * length * slope) && length > 1e-10) {
            const double fitted = 0.5 * length * length * slope / (value + length * slope - next);
            length =
                std::isfinite(next) ? std::clamp(fitted, 0.1 * length, 0.5 * length) : 0.1 * length;
            next = log_value(problem.objective, search.M + length * M_direction);
        }
        if (!(length > 1e-10)) break;
        search.weights += length * direction;
        search.M += length * M_direction;
        if (length < 1) slope_M = log_gradient(problem.objective, search.M);
        const VectorXd g_next = problem.set.sensitivities(slope_M);
        const double curvature = -length * direction.dot(g_next - g);
        const double moved = length * length * direction.squaredNorm();
        step = curvature > 0 ? std::clamp(moved / curvature, 1e-10, 1e10) : 1e10;
        g = g_next;
        value = next;
        recent.push_back(value);
        if (recent.size() > memory) recent.pop_front();
        ++search.iterations;
    }
    search.M = M_of(search.weights);  // without the rounding of the steps
    return search;
}

}  // namespace posewise::detail
