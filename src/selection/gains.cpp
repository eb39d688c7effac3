#include "gains.hpp"

#include <algorithm>

namespace posewise::detail {

Shortlist make_shortlist(const Blocks& candidates, std::vector<Index> members) {
    Shortlist shortlist{std::move(members), {}};
    shortlist.lanes = make_lane_blocks(candidates, shortlist.members);
    return shortlist;
}

Gains::Gains(const Blocks& candidates, const Shortlist& shortlist)
    : candidates_(candidates),
      shortlist_(shortlist),
      asked_(static_cast<std::size_t>(shortlist.lanes.groups)),
      gains_(asked_.size()) {}

double Gains::sensitivity_of(const Eigen::Ref<const RowMatrixXd>& block) const {
    return (block * slope_).cwiseProduct(block).sum();
}

void Gains::move_to(const MatrixXd& M, const MatrixXd& C_root) {
    M_ = M;
    cholesky_.compute(M);
    const MatrixXd identity = MatrixXd::Identity(M.rows(), M.cols());
    const MatrixXd root = C_root.size() == 0 ? MatrixXd() : cholesky_.solve(C_root);
    C_ = C_root * C_root.transpose();
    slope_ = is_determinant() ? MatrixXd(cholesky_.solve(identity)) : root * root.transpose();
    trace_ = is_determinant() ? 0 : root.cwiseProduct(C_root).sum();
    const auto count = static_cast<Index>(shortlist_.members.size());
    if (shortlist_.lanes.rows > 0) {
        G_ = make_grams(shortlist_.lanes, cholesky_.matrixU().solve(identity));
        if (!is_determinant()) H_ = make_grams(shortlist_.lanes, root);
        sensitivity_ = gram_traces(shortlist_.lanes, is_determinant() ? G_ : H_).head(count);
        return;
    }
    sensitivity_.resize(count);
    for (Index k = 0; k < count; ++k) {
        sensitivity_[k] =
            sensitivity_of(candidates_[shortlist_.members[static_cast<std::size_t>(k)]]);
    }
}

bool Gains::remove(const Eigen::Ref<const RowMatrixXd>& block) {
    const Eigen::LLT<MatrixXd> remaining(M_ - block.transpose() * block);
    if (remaining.info() != Eigen::Success) return false;
    const MatrixXd WB = remaining.solve(block.transpose());
    const MatrixXd growth = MatrixXd::Identity(block.rows(), block.rows()) + block * WB;
    P_ = growth.llt().matrixL().solve(WB.transpose()).transpose();
    if (!is_determinant()) remaining_trace_ = trace_ + (C_ * P_).cwiseProduct(P_).sum();
    return true;
}

double Gains::compute_plainly(Index position, const MatrixXd& W, const MatrixXd& WCW) const {
    const auto block = candidates_[shortlist_.members[static_cast<std::size_t>(position)]];
    const MatrixXd growth =
        MatrixXd::Identity(block.rows(), block.rows()) + block * W * block.transpose();
    const Eigen::LLT<MatrixXd> cholesky(growth);
    return is_determinant() ? cholesky.matrixLLT().diagonal().array().square().prod()
                            : cholesky.solve(block * WCW * block.transpose()).trace();
}

VectorXd Gains::compute(const std::vector<Index>& positions) {
    VectorXd result(static_cast<Index>(positions.size()));
    if (shortlist_.lanes.rows == 0) {
        const MatrixXd W =
            cholesky_.solve(MatrixXd::Identity(M_.rows(), M_.cols())) + P_ * P_.transpose();
        const MatrixXd WCW = is_determinant() ? MatrixXd() : W * C_ * W;
        for (Index k = 0; k < result.size(); ++k) {
            result[k] = compute_plainly(positions[static_cast<std::size_t>(k)], W, WCW);
        }
        return result;
    }
    std::fill(asked_.begin(), asked_.end(), char{0});
    for (const Index k : positions) asked_[static_cast<std::size_t>(k / lane_width)] = 1;
    if (is_determinant()) {
        lane_determinants(shortlist_.lanes, G_, P_, asked_, gains_);
    } else {
        // W C W - M^-1 C M^-1 = P Q^T + Q P^T with Q = M^-1 C P + P (P^T C P) / 2.
        const MatrixXd CP = C_ * P_;
        const MatrixXd Q = cholesky_.solve(CP) + 0.5 * P_ * (P_.transpose() * CP);
        lane_traces(shortlist_.lanes, G_, H_, P_, Q, asked_, gains_);
    }
    for (Index k = 0; k < result.size(); ++k) {
        const Index at = positions[static_cast<std::size_t>(k)];
        result[k] = gains_[static_cast<std::size_t>(at / lane_width)]
                        .of[static_cast<std::size_t>(at % lane_width)];
    }
    return result;
}

}  // namespace posewise::detail
