#include "screening.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "posewise/criteria/information_function.hpp"
#include "sensitivity.hpp"

namespace posewise {
namespace {

double sensitivity(const Blocks& candidates, Index candidate, const MatrixXd& Z) {
    const auto block = candidates[candidate];
    return (block * Z).cwiseProduct(block).sum();
}

bool least_eigenvalue_exceeds(const MatrixXd& M, double least) {
    const Eigen::LLT<MatrixXd> shifted(M - least * MatrixXd::Identity(M.rows(), M.cols()));
    return shifted.info() == Eigen::Success;
}

/// The test poses predicted worst.
Blocks worst_predicted(const Blocks& test_poses, const MatrixXd& M) {
    const VectorXd variances = sensitivities(test_poses, M.inverse());
    std::vector<Index> order(static_cast<std::size_t>(variances.size()));
    std::iota(order.begin(), order.end(), Index{0});
    const Index count = std::min<Index>(32, variances.size());
    std::partial_sort(order.begin(), order.begin() + count, order.end(), [&](Index a, Index b) {
        return variances[a] != variances[b] ? variances[a] > variances[b] : a < b;
    });
    order.resize(static_cast<std::size_t>(count));
    return take(test_poses, order);
}

/// Whether tangents are worth their cost: smooth criteria, concave in M.
bool has_useful_tangent(Criterion criterion) {
    return criterion == Criterion::O5 || criterion == Criterion::D || criterion == Criterion::O1 ||
           criterion == Criterion::A || criterion == Criterion::V;
}

}  // namespace

Screening::Screening(const Objective& objective, const Blocks& candidates,
                     const Shortlist& shortlist, const std::function<bool()>& must_stop)
    : objective_(objective),
      candidates_(candidates),
      shortlist_(shortlist),
      must_stop_(must_stop),
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
    prepare_tests(M);
}

void Screening::prepare_tests(const MatrixXd& M) {
    if (objective_.criterion == Criterion::G) {
        witnesses_ = worst_predicted(*objective_.test_poses, M);
    }
    if (objective_.criterion == Criterion::O2 || objective_.criterion == Criterion::O4) {
        const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M);
        weakest_ = eigen.eigenvectors().col(0);
        strongest_ = eigen.eigenvectors().rightCols<1>();
    }
}

bool Screening::may_exceed_condition(const MatrixXd& M, double value) const {
    // Rayleigh quotients: the largest eigenvalue is not below one, the least not above one.
    const double largest = strongest_.dot(M * strongest_);
    const double least = objective_.criterion == Criterion::O2 ? value * value * largest
                                                               : value * std::sqrt(largest);
    return weakest_.dot(M * weakest_) > least && least_eigenvalue_exceeds(M, least);
}

bool Screening::may_exceed(const MatrixXd& M, double value) const {
    if (!(value > 0) || !objective_.nuisance.empty()) return true;
    switch (objective_.criterion) {
        case Criterion::G: {
            Objective at_witnesses = objective_;
            at_witnesses.test_poses = &witnesses_;
            return evaluate(at_witnesses, M) > value;
        }
        case Criterion::E:
        case Criterion::O3:
            return least_eigenvalue_exceeds(M, information_of_value(objective_, value, M.rows()));
        case Criterion::O2:
        case Criterion::O4:
            return may_exceed_condition(M, value);
        default:
            return true;
    }
}

Index Screening::best_replacement(Index removed, double value, const Occupancy& occupancy) {
    const auto B = candidates_[removed];
    const MatrixXd remaining = M_ - B.transpose() * B;
    const double least = (B * slope_).cwiseProduct(B).sum();
    Index best = -1;
    double best_value = value;
    MatrixXd tangent;  // at the best exchange, which rules out more than the one at M
    double tangent_level = 0;
    for (const Index k : order_) {
        // For a concave objective the change is at most the difference of the sensitivities.
        if ((screens_ && sensitivity_[k] <= least) || must_stop_()) break;
        const Index candidate = shortlist_.members[static_cast<std::size_t>(k)];
        if (candidate == removed || !occupancy.allows(candidate)) continue;
        const auto added = candidates_[candidate];
        const MatrixXd M = remaining + added.transpose() * added;
        if (tangent.size() > 0 && tangent.cwiseProduct(M).sum() <= tangent_level) continue;
        if (!may_exceed(M, best_value)) continue;
        const double exchanged = evaluate(objective_, M);
        if (!(exchanged > best_value)) continue;
        best = k;
        best_value = exchanged;
        if (!has_useful_tangent(objective_.criterion)) continue;
        tangent = gradient(objective_, M);
        tangent_level = tangent.cwiseProduct(M).sum();
    }
    return best;
}

}  // namespace posewise
