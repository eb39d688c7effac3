#include "screening.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <numeric>

#include "posewise/criteria/information_function.hpp"

namespace posewise {
namespace {

double sensitivity(const Blocks& candidates, Index candidate, const MatrixXd& Z) {
    const auto block = candidates[candidate];
    return (block * Z).cwiseProduct(block).sum();
}

}  // namespace

Screening::Screening(const Objective& objective, const Blocks& candidates,
                     const Shortlist& shortlist)
    : objective_(objective),
      candidates_(candidates),
      shortlist_(shortlist),
      screens_(objective.criterion != Criterion::O4),
      sensitivity_(static_cast<Index>(shortlist.members.size())),
      order_(shortlist.members.size()) {}

void Screening::move_to(const MatrixXd& M) {
    M_ = M;
    slope_ = gradient(objective_, M);
    for (std::size_t k = 0; k < order_.size(); ++k) {
        sensitivity_[static_cast<Index>(k)] =
            sensitivity(candidates_, shortlist_.members[k], slope_);
    }
    std::iota(order_.begin(), order_.end(), Index{0});
    std::sort(order_.begin(), order_.end(), [&](Index a, Index b) {
        return sensitivity_[a] != sensitivity_[b] ? sensitivity_[a] > sensitivity_[b] : a < b;
    });
}

bool Screening::may_exceed(const MatrixXd& M, double value) const {
    const bool is_least_eigenvalue =
        objective_.criterion == Criterion::E || objective_.criterion == Criterion::O3;
    if (!is_least_eigenvalue || !objective_.nuisance.empty()) return true;
    const double least = information_of_value(objective_, value, M.rows());
    const Eigen::LLT<MatrixXd> shifted(M - least * MatrixXd::Identity(M.rows(), M.cols()));
    return shifted.info() == Eigen::Success;
}

Index Screening::best_replacement(Index removed, double value, const Occupancy& occupancy) {
    const auto B = candidates_[removed];
    const MatrixXd remaining = M_ - B.transpose() * B;
    const double least = (B * slope_).cwiseProduct(B).sum();
    Index best = -1;
    double best_value = value;
    for (const Index k : order_) {
        // For a concave objective the change is at most the difference of the sensitivities.
        if (screens_ && sensitivity_[k] <= least) break;
        const Index candidate = shortlist_.members[static_cast<std::size_t>(k)];
        if (candidate == removed || !occupancy.allows(candidate)) continue;
        const auto added = candidates_[candidate];
        const MatrixXd M = remaining + added.transpose() * added;
        if (!may_exceed(M, best_value)) continue;
        const double exchanged = evaluate(objective_, M);
        if (exchanged > best_value) {
            best = k;
            best_value = exchanged;
        }
    }
    return best;
}

}  // namespace posewise
