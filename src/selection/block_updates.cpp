#include "block_updates.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace posewise {

BlockUpdates::BlockUpdates(const Objective& objective, const Blocks& candidates,
                           const Shortlist& shortlist)
    : candidates_(candidates),
      shortlist_(shortlist),
      sensitivity_(static_cast<Index>(shortlist.members.size())),
      asked_(static_cast<std::size_t>(shortlist.lanes.groups)),
      gains_(asked_.size()) {
    if (objective.criterion == Criterion::D || objective.criterion == Criterion::O1) return;
    const Index L = candidates.parameter_count();
    C_ = objective.criterion == Criterion::A ? MatrixXd::Identity(L, L)
                                             : objective.mean_test_information;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(C_);
    C_root_ = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

void BlockUpdates::move_to(const MatrixXd& M) {
    M_ = M;
    cholesky_.compute(M);
    const MatrixXd identity = MatrixXd::Identity(M.rows(), M.cols());
    G_ = make_grams(shortlist_.lanes, cholesky_.matrixU().solve(identity));
    if (is_determinant()) {
        slope_ = cholesky_.solve(identity);
    } else {
        const MatrixXd root = cholesky_.solve(C_root_);
        slope_ = root * root.transpose();
        H_ = make_grams(shortlist_.lanes, root);
    }
    sensitivity_ = gram_traces(shortlist_.lanes, is_determinant() ? G_ : H_)
                       .head(static_cast<Index>(shortlist_.members.size()));
}

void BlockUpdates::compute_gains(const MatrixXd& P) {
    if (is_determinant()) {
        lane_determinants(shortlist_.lanes, G_, P, asked_, gains_);
        return;
    }
    // W C W - M^-1 C M^-1 = P Q^T + Q P^T with Q = M^-1 C P + P (P^T C P) / 2.
    const MatrixXd CP = C_ * P;
    const MatrixXd Q = cholesky_.solve(CP) + 0.5 * P * (P.transpose() * CP);
    lane_traces(shortlist_.lanes, G_, H_, P, Q, asked_, gains_);
}

Index BlockUpdates::best_replacement(Index removed, double /*value*/, const Occupancy& occupancy) {
    const auto B = candidates_[removed];
    const Eigen::LLT<MatrixXd> remaining(M_ - B.transpose() * B);
    if (remaining.info() != Eigen::Success) return -1;
    // Concavity screens: only a candidate more sensitive than the removed pose can be better.
    const double least = (B * slope_).cwiseProduct(B).sum();
    const auto is_asked = [&](std::size_t k) {
        return sensitivity_[static_cast<Index>(k)] > least && shortlist_.members[k] != removed &&
               occupancy.allows(shortlist_.members[k]);
    };
    std::vector<std::size_t> asked;
    std::fill(asked_.begin(), asked_.end(), char{0});
    for (std::size_t k = 0; k < shortlist_.members.size(); ++k) {
        if (!is_asked(k)) continue;
        asked.push_back(k);
        asked_[k / lane_width] = 1;
    }
    if (asked.empty()) return -1;

    const MatrixXd WB = remaining.solve(B.transpose());
    const MatrixXd growth = MatrixXd::Identity(B.rows(), B.rows()) + B * WB;
    compute_gains(growth.llt().matrixL().solve(WB.transpose()).transpose());

    Index best = -1;
    double best_gain = 0;
    for (const std::size_t k : asked) {
        const double gain = gains_[k / lane_width].of[k % lane_width];
        if (!(gain > best_gain) || !std::isfinite(gain)) continue;
        best = static_cast<Index>(k);
        best_gain = gain;
    }
    return best;
}

}  // namespace posewise
