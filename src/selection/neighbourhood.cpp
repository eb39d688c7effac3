#include "neighbourhood.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/decompositions.hpp"
#include "core/products.hpp"
#include "core/sensitivities.hpp"

namespace posewise::detail {
namespace {

constexpr Index witness_count = 16;  // of each M

/// The test poses predicted worst, the worst first.
std::vector<RowMatrixXd> worst_predicted(const Blocks& test_poses, const MatrixXd& M) {
    const VectorXd variances = sensitivities(test_poses, inverse_of(M));
    std::vector<Index> order(static_cast<std::size_t>(variances.size()));
    std::iota(order.begin(), order.end(), Index{0});
    const Index count = std::min(witness_count, variances.size());
    std::partial_sort(order.begin(), order.begin() + count, order.end(), [&](Index a, Index b) {
        return variances[a] != variances[b] ? variances[a] > variances[b] : a < b;
    });
    std::vector<RowMatrixXd> worst;
    for (Index k = 0; k < count; ++k) {
        worst.emplace_back(test_poses[order[static_cast<std::size_t>(k)]]);
    }
    return worst;
}

}  // namespace

bool has_exact_gains(const Objective& objective) {
    const Criterion criterion = objective.criterion;
    return objective.nuisance.empty() && is_smooth(criterion) && criterion != Criterion::O5;
}

Neighbourhood::Neighbourhood(const Objective& objective, const Blocks& candidates,
                             const Shortlist& shortlist, Index most_evaluated,
                             const StopSignal& stop)
    : objective_(objective),
      candidates_(candidates),
      shortlist_(shortlist),
      most_evaluated_(most_evaluated),
      stop_(stop),
      ranking_(Ranking::Estimate),
      gains_(candidates, shortlist) {
    if (!objective.nuisance.empty()) return;
    const Index L = candidates.parameter_count();
    switch (objective.criterion) {
        case Criterion::D:
        case Criterion::O1:
            ranking_ = Ranking::Exact;
            break;
        case Criterion::A:
            ranking_ = Ranking::Exact;
            C_root_ = MatrixXd::Identity(L, L);
            break;
        case Criterion::V:
            ranking_ = Ranking::Exact;
            C_root_ = objective.mean_test_root;
            break;
        case Criterion::G:
            ranking_ = Ranking::Witnesses;
            break;
        case Criterion::O5:
            for (const Index member : shortlist.members) {
                largest_block_ = std::max(largest_block_, candidates[member].squaredNorm());
            }
            break;
        default:
            ritz_.emplace(objective, candidates, shortlist);
    }
}

MatrixXd Neighbourhood::make_C_root(const MatrixXd& M) const {
    if (ranking_ != Ranking::Estimate) return C_root_;
    const MatrixXd slope = gradient(objective_, M);
    const Eigen::LLT<MatrixXd> cholesky(slope);  // fails where there is nuisance
    if (cholesky.info() == Eigen::Success) return M * MatrixXd(cholesky.matrixL());
    return M * root_of(slope);
}

void Neighbourhood::move_to(const MatrixXd& M) {
    M_ = M;
    root_from_ = 0;
    if (ritz_) return ritz_->move_to(M);
    if (ranking_ == Ranking::Witnesses) {
        witnesses_ = worst_predicted(*objective_.test_poses, M);
    }
    gains_.move_to(M, make_C_root(M));
}

MatrixXd Neighbourhood::exchanged(Index removed, Index added) const {
    return M_ - symmetric_gram(candidates_[removed]) + symmetric_gram(candidates_[added]);
}

void Neighbourhood::exchange(Index added, const MatrixXd& M) {
    if (ritz_ || ranking_ == Ranking::Estimate) return move_to(M);
    M_ = M;
    if (ranking_ == Ranking::Witnesses) {
        witnesses_ = worst_predicted(*objective_.test_poses, M);
    }
    gains_.exchange(candidates_[added], M);
}

bool Neighbourhood::is_allowed(Index position, Index removed, const Occupancy& occupancy) const {
    const Index candidate = shortlist_.members[static_cast<std::size_t>(position)];
    return candidate != removed && occupancy.allows(candidate);
}

std::vector<Index> Neighbourhood::promising(Index removed, const Occupancy& occupancy) const {
    // The objective is concave: it grows only towards what is
    // more sensitive than what is removed.
    const double least = gains_.removed_sensitivity();
    std::vector<Index> positions;
    const auto size = static_cast<Index>(shortlist_.members.size());
    for (Index position = 0; position < size; ++position) {
        if (gains_.sensitivity(position) > least && is_allowed(position, removed, occupancy)) {
            positions.push_back(position);
        }
    }
    return positions;
}

std::vector<Neighbourhood::Ranked> Neighbourhood::rank(const std::vector<Index>& positions) {
    const VectorXd gains = gains_.compute(positions);
    std::vector<Ranked> ranked;
    for (Index k = 0; k < gains.size(); ++k) {
        if (std::isfinite(gains[k])) {
            ranked.push_back({positions[static_cast<std::size_t>(k)], gains[k]});
        }
    }
    std::make_heap(ranked.begin(), ranked.end());
    return ranked;
}

bool Neighbourhood::passes_witnesses(const MatrixXd& M, double value) {
    const Eigen::LLT<MatrixXd> cholesky(M);
    for (auto witness = witnesses_.begin(); witness != witnesses_.end(); ++witness) {
        const double variance = cholesky.matrixL().solve(witness->transpose()).squaredNorm();
        if (variance * value < 1) continue;
        std::rotate(witnesses_.begin(), witness, witness + 1);  // likely to rule out the next, too
        return false;
    }
    return true;
}

double Neighbourhood::worst_prediction(const MatrixXd& M, double value) {
    if (!passes_witnesses(M, value)) return 0;
    const VectorXd variances = sensitivities(*objective_.test_poses, inverse_of(M));
    Index worst = 0;
    const double largest = variances.maxCoeff(&worst);
    witnesses_.insert(witnesses_.begin(), (*objective_.test_poses)[worst]);
    return 1 / largest;
}

Neighbourhood::Replacement Neighbourhood::best_by_gains(Index removed, double value,
                                                        const Occupancy& occupancy) {
    const auto B = candidates_[removed];
    if (!gains_.remove(B)) return {};
    const std::vector<Index> positions = promising(removed, occupancy);
    if (positions.empty()) return {};
    if (ranking_ == Ranking::Exact) {
        const auto [position, gain] = gains_.find_largest(positions);
        return {position, gain > gains_.certain_gain()};
    }
    std::vector<Ranked> ranked = rank(positions);
    const MatrixXd remaining = M_ - B.transpose() * B;
    Index best = -1;
    std::vector<Index> batch;
    for (Index left = most_evaluated_; left > 0 && !ranked.empty() && !stop_.is_set();
         left -= lane_width) {
        batch.clear();
        for (Index k = 0; k < std::min(left, lane_width) && !ranked.empty(); ++k) {
            std::pop_heap(ranked.begin(), ranked.end());
            batch.push_back(ranked.back().position);
            ranked.pop_back();
        }
        const std::vector<double> exchanged = evaluate_exchanges(remaining, value, batch);
        const auto largest = std::max_element(exchanged.begin(), exchanged.end());
        if (!(*largest > value)) continue;
        best = batch[static_cast<std::size_t>(largest - exchanged.begin())];
        value = *largest;
    }
    return {best, false};
}

std::vector<double> Neighbourhood::evaluate_exchanges(const MatrixXd& remaining, double value,
                                                      std::span<const Index> positions) {
    if (objective_.criterion == Criterion::O5 && objective_.nuisance.empty() && value > 0) {
        return evaluate_in_lanes(remaining, value, positions);
    }
    std::vector<double> values;
    for (const Index position : positions) {
        const auto added = candidates_[shortlist_.members[static_cast<std::size_t>(position)]];
        values.push_back(evaluate(objective_, remaining + added.transpose() * added));
    }
    return values;
}

std::vector<double> Neighbourhood::evaluate_in_lanes(const MatrixXd& remaining, double value,
                                                     std::span<const Index> positions) {
    std::vector<Index> candidates;
    Index rows = 0;
    for (const Index position : positions) {
        const Index candidate = shortlist_.members[static_cast<std::size_t>(position)];
        candidates.push_back(candidate);
        rows = std::max(rows, candidates_[candidate].rows());
    }
    if (!(root_from_ <= value && value <= 1.1 * root_from_)) {
        // A sum of lambda^(-1/2) below 1 / value has every lambda above value^2.
        root_from_ = value;
        root_ = make_inverse_root(value * value, M_.trace() + largest_block_);
    }
    const auto traces =
        RootTraces(remaining, root_).compute(make_lane_blocks(candidates_, candidates, rows));
    std::vector<double> values;
    for (std::size_t k = 0; k < candidates.size(); ++k) {
        values.push_back(1 / traces[k / lane_width].of[k % lane_width]);
    }
    return values;
}

Index Neighbourhood::best_by_eigenvalues(Index removed, double value, const Occupancy& occupancy) {
    const auto B = candidates_[removed];
    const MatrixXd remaining = M_ - B.transpose() * B;
    ritz_->remove(removed);
    ritz_->ask(value);
    Index best = -1;
    const auto size = static_cast<Index>(shortlist_.members.size());
    std::vector<Index> batch;
    for (Index position = 0; position < size && !stop_.is_set();) {
        batch.clear();
        for (; position < size && std::ssize(batch) < lane_width; ++position) {
            if (ritz_->may_exceed(position) && is_allowed(position, removed, occupancy)) {
                batch.push_back(position);
            }
        }
        for (const Index at : ritz_->exceeding(remaining, batch)) {
            if (!ritz_->may_exceed(at)) continue;  // what was found before may be better
            const auto added = candidates_[shortlist_.members[static_cast<std::size_t>(at)]];
            const double exchanged = evaluate(objective_, remaining + added.transpose() * added);
            if (!(exchanged > value)) continue;
            best = at;
            value = exchanged;
            ritz_->ask(value);
        }
    }
    return best;
}

Index Neighbourhood::best_by_witnesses(Index removed, double value, const Occupancy& occupancy) {
    const auto B = candidates_[removed];
    if (!gains_.remove(B)) return -1;
    const MatrixXd remaining = M_ - B.transpose() * B;
    Index best = -1;
    for (const Index position : gains_.keeping_below(1 / value, witnesses_)) {
        if (stop_.is_set()) break;
        if (!is_allowed(position, removed, occupancy)) continue;
        const auto added = candidates_[shortlist_.members[static_cast<std::size_t>(position)]];
        const double exchanged = worst_prediction(remaining + added.transpose() * added, value);
        if (!(exchanged > value)) continue;
        best = position;
        value = exchanged;
    }
    return best;
}

std::vector<Index> Neighbourhood::nearest(const std::vector<Index>& poses, Index count) {
    std::vector<Index> positions(shortlist_.members.size());
    std::iota(positions.begin(), positions.end(), Index{0});
    VectorXd nearness = VectorXd::Constant(static_cast<Index>(positions.size()),
                                           -std::numeric_limits<double>::infinity());
    for (const Index pose : poses) {
        if (!gains_.remove(candidates_[pose])) continue;
        VectorXd gains = gains_.compute_roughly();
        if (C_root_.size() == 0) {
            gains /= gains_.least_gain();  // factors of the determinant
        } else {
            gains.array() -= gains_.least_gain();
        }
        nearness = gains.array().isNaN().select(nearness, nearness.cwiseMax(gains));
    }
    std::stable_sort(positions.begin(), positions.end(),
                     [&](Index a, Index b) { return nearness[a] > nearness[b]; });
    positions.resize(std::min(positions.size(), static_cast<std::size_t>(count)));
    std::sort(positions.begin(), positions.end());
    return positions;
}

Neighbourhood::Replacement Neighbourhood::best_replacement(Index removed, double value,
                                                           const Occupancy& occupancy) {
    if (ritz_) return {best_by_eigenvalues(removed, value, occupancy)};
    if (ranking_ == Ranking::Witnesses) return {best_by_witnesses(removed, value, occupancy)};
    return best_by_gains(removed, value, occupancy);
}

}  // namespace posewise::detail
