#include "enumeration.hpp"

#include <algorithm>
#include <cmath>

#include "../core/sensitivities.hpp"
#include "../criteria/information_function.hpp"
#include "limits.hpp"

namespace posewise::detail {
namespace {

struct Fixing {
    std::vector<Index> in;
    std::vector<Index> open;
};

Fixing fix_nothing(const SearchProblem& problem) {
    Fixing fixing;
    const std::vector<Index> capacity = capacities(problem.candidates.count(), problem.options);
    for (Index i = 0; i < problem.candidates.count(); ++i) {
        if (capacity[static_cast<std::size_t>(i)] > 0) fixing.open.push_back(i);
    }
    return fixing;
}

Fixing fix_by_bound(const SearchProblem& problem, const Relaxation& relaxation, double value) {
    Fixing fixing = fix_nothing(problem);
    Objective objective = problem.objective;
    objective.sharpness = relaxation.certificate.sharpness;
    if (!has_information_function(objective.criterion)) return fixing;
    const Index L = problem.candidates.parameter_count();
    const MatrixXd Z = supporting_matrix(objective, relaxation.certificate.M);
    const VectorXd d = sensitivities(problem.candidates, Z);
    std::vector<Index> order;
    order.swap(fixing.open);
    std::sort(order.begin(), order.end(), [&](Index a, Index b) { return d[a] > d[b]; });
    const auto K = static_cast<std::size_t>(problem.options.pose_count);
    double sum = Z.cwiseProduct(problem.held).sum();
    for (std::size_t k = 0; k < K; ++k) sum += d[order[k]];
    const double needed = information_of_value(objective, value, L) * (1 - 1e-9);
    for (std::size_t k = 0; k < order.size(); ++k) {
        const Index i = order[k];
        if (k < K) {
            // Without it, the best that is left takes its place.
            const double replaced = order.size() > K ? d[order[K]] : 0;
            (sum - d[i] + replaced < needed ? fixing.in : fixing.open).push_back(i);
        } else if (sum - d[order[K - 1]] + d[i] >= needed) {
            fixing.open.push_back(i);
        }
    }
    return fixing;
}

double choice_count(Index n, Index k) {
    double count = 1;
    for (Index i = 0; i < k; ++i) count *= static_cast<double>(n - i) / static_cast<double>(i + 1);
    return count;
}

/// Visits every completion of a choice by open candidates, in index order.
class Enumerator {
  public:
    Enumerator(const SearchProblem& problem, const ScoredPoses& best, const Fixing& fixing)
        : problem_(problem),
          open_(fixing.open),
          occupancy_(problem.candidates.count(), problem.options),
          best_(best) {
        for (const Index pose : fixing.in) push(pose);
    }

    ScoredPoses run() {
        complete(0, problem_.regularised_information(poses_));
        return best_;
    }

  private:
    void push(Index pose) {
        poses_.push_back(pose);
        occupancy_.add(pose);
    }
    void pop() {
        occupancy_.remove(poses_.back());
        poses_.pop_back();
    }

    void complete(std::size_t from, const MatrixXd& M) {
        const auto missing = static_cast<std::size_t>(problem_.options.pose_count) - poses_.size();
        if (missing == 0) {
            const Score score = problem_.score(M);
            if (is_better(score, best_.score)) best_ = {poses_, score};
            return;
        }
        for (std::size_t k = from; k + missing <= open_.size(); ++k) {
            if (!occupancy_.allows(open_[k])) continue;
            const auto B = problem_.candidates[open_[k]];
            push(open_[k]);
            complete(k + 1, M + B.transpose() * B);
            pop();
        }
    }

    const SearchProblem& problem_;
    const std::vector<Index>& open_;
    Occupancy occupancy_;
    std::vector<Index> poses_;
    ScoredPoses best_;
};

}  // namespace

std::optional<ScoredPoses> enumerate_open_choices(const SearchProblem& problem,
                                                  const Relaxation& relaxation,
                                                  const ScoredPoses& best) {
    if (problem.options.repeat_limit > 1 || !best.score.identifies) return std::nullopt;
    Fixing fixing = fix_by_bound(problem, relaxation, best.score.value);
    std::sort(fixing.open.begin(), fixing.open.end());
    const auto open = static_cast<Index>(fixing.open.size());
    const auto missing = problem.options.pose_count - static_cast<Index>(fixing.in.size());
    if (choice_count(open, missing) > static_cast<double>(problem.options.enumeration))
        return std::nullopt;
    return Enumerator(problem, best, fixing).run();
}

}  // namespace posewise::detail
