#include "missing_errors.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise::detail {
namespace {

constexpr double chance = 1e-3;  // of an answer that is not 0 without a reason

bool has_torques(const Chain& robot) {
    return std::any_of(robot.elements().begin(), robot.elements().end(), [](const Element& e) {
        return std::any_of(e.terms.begin(), e.terms.end(),
                           [](const ErrorTerm& term) { return term.function.torque != nullptr; });
    });
}

Chain with_missing(const Chain& robot) {
    return with_harmonics(has_torques(robot) ? robot : with_torque_shapes(robot), {1, 2});
}

/// Numbers of the rich model's parameters: first those of the poor one, in their order.
std::pair<std::vector<Index>, Index> common_first(const Campaign& poor, const Campaign& rich) {
    const auto names = parameter_names(poor);
    const auto all = parameter_names(rich);
    std::vector<Index> order(all.size());
    std::iota(order.begin(), order.end(), Index{0});
    const auto middle = std::stable_partition(order.begin(), order.end(), [&](Index k) {
        return std::find(names.begin(), names.end(), all[static_cast<std::size_t>(k)]) !=
               names.end();
    });
    return {order, middle - order.begin()};
}

}  // namespace

double missing_errors(const IdentificationProblem& problem, const Parameters& parameters) {
    const Campaign& poor = problem.campaign;
    const Campaign rich = with_robot(poor, with_missing(poor.robot));
    const auto [order, common] = common_first(poor, rich);
    const Index missing = std::ssize(order) - common;
    if (missing == 0) return 0;
    IdentificationProblem with_all = make_problem(rich, problem.measurements);
    with_all.loss = problem.loss;
    with_all.deviation = problem.deviation;
    Parameters at = parameters;
    at.robot.setZero(rich.robot.parameter_count());
    const Index base = base_parameter_count(rich);
    for (Index k = 0, own = 0; k < common; ++k) {
        const Index to = order[static_cast<std::size_t>(k)] - base;
        if (to >= 0 && to < at.robot.size()) at.robot[to] = parameters.robot[own++];
    }
    const LinearisedSystem system = linearise(with_all, at, Equations::All);
    // The prior's rows of what is missing are not the poor model's.
    std::vector<Index> rows(static_cast<std::size_t>(with_all.observation_count()));
    std::iota(rows.begin(), rows.end(), Index{0});
    for (Index k = 0; k < common; ++k) {
        const Index of_prior = order[static_cast<std::size_t>(k)] - with_all.prior_begin();
        if (of_prior >= 0 && of_prior < with_all.prior_count()) {
            rows.push_back(with_all.observation_count() + of_prior);
        }
    }
    const Index freedom = std::ssize(rows) - common;
    if (freedom <= 0) return 0;
    MatrixXd augmented(std::ssize(rows), std::ssize(order) + 1);
    augmented << system.J()(rows, order), system.r()(rows);
    const MatrixXd R = triangular_factor(std::move(augmented));
    const auto C = R.block(common, common, std::min(missing, R.rows() - common), missing);
    const VectorXd r = R.col(common + missing).tail(R.rows() - common);
    const double variance = r.squaredNorm() / static_cast<double>(freedom);
    const double mean = C.squaredNorm();
    const double squares = (C * C.transpose()).squaredNorm();
    if (!(variance > 0) || !(squares > 0)) return 0;
    const double score = (C.transpose() * r.head(C.rows())).squaredNorm() / variance;
    const double by_chance =
        squares / mean * chi_squared_quantile(1 - chance, mean * mean / squares);
    if (score <= by_chance) return 0;
    return std::min(1.0, (score - mean) / squares * mean / static_cast<double>(freedom));
}

}  // namespace posewise::detail
