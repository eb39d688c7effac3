#include "explorer.hpp"

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "criteria/information_function.hpp"
#include "projected_gradient.hpp"

namespace posewise::detail {
namespace {

constexpr double operations_a_second = 2e10;
constexpr double operations_a_part = 1e6;  // beside its relaxation: sorting, counting
constexpr double seconds_a_go = 0.01;
constexpr double few_choices = 500;  // take about as long to try as one relaxation
constexpr double many_choices =
    20'000;                         // of a part whose halves wait, the one of less bound longer
constexpr Index steps_at_once = 5;  // of a relaxation, before its bound is looked at
constexpr Index most_steps = 60;

/// The logarithm of a ratio of criterion values; of D that of a parameter.
double log_ratio(const Objective& objective, double a, double b, Index parameter_count) {
    if (!is_logarithm(objective.criterion)) return logarithm(a / b);
    return (a - b) / static_cast<double>(interest_count(objective, parameter_count));
}

// Operations, about, by what takes longest; the constants are what small matrices take.

/// Of one evaluation of the criterion with its gradient.
double evaluation_operations(const Objective& objective, Index L) {
    const auto size = static_cast<double>(L);
    const bool is_spectral =
        !is_smooth(objective.criterion) || objective.criterion == Criterion::O5;
    const double rows = objective.criterion == Criterion::G
                            ? static_cast<double>(objective.test_poses->matrix.rows())
                            : 0;
    const double cubes = is_spectral ? 40 : objective.criterion == Criterion::V ? 15 : 6;
    return 5e4 + cubes * size * size * size + 4 * rows * size * size;
}

/// Of trying a choice, where the filter rules it out.
double trial_operations(Criterion criterion, Index L) {
    const auto size = static_cast<double>(L);
    const bool is_trace = criterion == Criterion::A || needs_test_poses(criterion);
    return 5e3 + (criterion == Criterion::O5 ? 2 : is_trace ? 1 : 0.4) * size * size * size;
}

}  // namespace

Explorer::Explorer(const PartSetting& setting, const ScoredPoses& best)
    : setting_(setting), enumerator_(setting.enumeration, best) {}

double Explorer::seconds() const {
    const Objective& objective = setting_.objective;
    const Index L = setting_.problem.candidates.parameter_count();
    return (operations_ +
            static_cast<double>(enumerator_.tried()) * trial_operations(objective.criterion, L) +
            0.2 * static_cast<double>(enumerator_.scored()) * evaluation_operations(objective, L)) /
           operations_a_second;
}

void Explorer::explore(Part part, bool is_whole) {
    if (setting_.problem.options.stop.is_set() || (!is_whole && seconds() > seconds_a_go)) {
        left_.push_back(std::move(part));
        return;
    }
    operations_ += operations_a_part;
    if (close(part) || try_few(part)) return;
    relax(part);
    if (close(part) || try_few(part)) return;
    const bool is_large = is_whole && part.choices(setting_).count(many_choices) > many_choices;
    for (Part& half : split(setting_, part)) {
        if (is_large) {
            left_.push_back(std::move(half));
        } else {
            explore(std::move(half), false);
        }
    }
}

/// Whether nothing is left of the part.
bool Explorer::close(Part& part) {
    const Left left = reduce(setting_, value(), part);
    if (left == Left::One) enumerator_.try_choice(setting_.candidates(part.taken));
    return left != Left::Many;
}

/// Whether there are few choices; all have been tried then, but for a stop.
bool Explorer::try_few(const Part& part) {
    const PricedChoices choices = part.choices(setting_);
    if (choices.count(few_choices) > few_choices) return false;
    if (!enumerator_.run(setting_.candidates(part.taken), choices)) left_.push_back(part);
    return true;
}

/// Bounds the part anew.
void Explorer::relax(Part& part) {
    const Objective& objective = setting_.objective;
    const SearchProblem& problem = setting_.problem;
    const Index L = problem.candidates.parameter_count();
    const WorkingSet set(setting_.set, part.open);
    const MatrixXd held =
        problem.held + information(problem.candidates, setting_.candidates(part.taken));
    const std::vector<Index> capacity = part.capacity(setting_);
    const Index missing = part.missing(setting_);
    const OpenChoices open{
        held, [&](const MatrixXd& Z) { return set.sensitivities(Z); },
        [&](const VectorXd& values) { return most_valuable(values, capacity, missing); }};
    const VectorXd upper =
        Eigen::Map<const Eigen::Matrix<Index, Eigen::Dynamic, 1>>(capacity.data(), set.size())
            .cast<double>();
    const auto total = static_cast<double>(missing);
    const WeightProblem weighing{objective, set, held, upper, total};
    part.weights = project_on_capped_simplex(part.weights, upper, total);
    if (!std::isfinite(evaluate(objective, held + set.weighted_information(part.weights)))) {
        part.weights = upper * (total / upper.sum());
    }
    const double bound = part.pricing.bound;
    const double slack = std::max(1e-4, log_ratio(objective, bound, value(), L));
    Pricing best;
    for (Index steps = 0; steps < most_steps; steps += steps_at_once) {
        const WeightSearch search =
            ascend(weighing, part.weights, 0.05 * slack, steps_at_once, problem.options.stop);
        operations_ += static_cast<double>(search.iterations + 1) *
                       (evaluation_operations(objective, L) +
                        static_cast<double>(set.size() * (4 * L * L + 1000)));
        part.weights = search.weights;
        const Pricing pricing = price(objective, search.M, open, value());
        if (pricing.prices.size() == 0) break;
        if (steps == 0 || pricing.bound < best.bound) best = pricing;
        const double reached = evaluate(objective, search.M);
        const bool is_tight = log_ratio(objective, best.bound, reached, L) <
                              0.1 * log_ratio(objective, reached, value(), L);
        if (is_tight || search.iterations < steps_at_once ||
            spare_price(best, open.most_valuable(best.prices)) < 0) {
            break;
        }
    }
    if (best.prices.size() == 0) {
        if (!may_identify(part)) part.pricing.held = -std::numeric_limits<double>::infinity();
        return;
    }
    part.pricing = std::move(best);
    part.pricing.bound = std::min(part.pricing.bound, bound);
}

/// Whether all that is open identifies the parameters; else no choice of it does.
bool Explorer::may_identify(const Part& part) {
    const SearchProblem& problem = setting_.problem;
    std::vector<Index> all = setting_.candidates(part.taken);
    for (const Index candidate : setting_.candidates(part.open)) all.push_back(candidate);
    const RowMatrixXd rows = stack(problem.options.held_rows, take(problem.candidates, all).matrix);
    operations_ += 2 * static_cast<double>(rows.rows() * rows.cols() * rows.cols());
    return count_independent_columns(triangular_factor_of_many(rows)) == rows.cols();
}

}  // namespace posewise::detail
