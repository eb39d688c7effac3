#include "pose_merit.hpp"

#include <cmath>

#include "core/elementary.hpp"
#include "core/products.hpp"
#include "criteria/regular.hpp"

namespace posewise::detail {

std::optional<PoseMerit> PoseMerit::make(const Objective& objective, const MatrixXd& R,
                                         const RowMatrixXd& block) {
    const Criterion criterion = objective.criterion;
    PoseMerit merit;
    merit.is_trace_ = criterion == Criterion::A || criterion == Criterion::V;
    const bool is_determinant = criterion == Criterion::D || criterion == Criterion::O1;
    if (!objective.nuisance.empty() || !(merit.is_trace_ || is_determinant)) return std::nullopt;
    const Eigen::LLT<MatrixXd> cholesky(R);
    if (!is_regular(cholesky, R)) return std::nullopt;
    const MatrixXd W = inverse(cholesky);
    const Index L = R.rows();
    const Index whole = whole_columns(L);
    merit.WK_.setZero(L, merit.is_trace_ ? 2 * whole : whole);
    merit.WK_.leftCols(L) = W;
    if (is_determinant) {
        merit.base_ = log_determinant(cholesky);
        if (criterion == Criterion::O1) {
            merit.factor_ = 1 / (2.0 * static_cast<double>(R.rows()));
            merit.shift_ = -logarithm(static_cast<double>(objective.pose_count)) / 2;
        }
        return merit;
    }
    auto K = merit.WK_.middleCols(whole, L);
    if (criterion == Criterion::A) {
        K = symmetric_gram(W);
        merit.base_ = W.trace();
    } else {
        const MatrixXd& T = objective.mean_test_root;
        const RowMatrixXd TW = transposed_product(T, W);
        K = symmetric_gram(TW);
        merit.base_ = TW.cwiseProduct(T.transpose()).sum();
    }
    if (!std::isfinite(merit.evaluate(block))) return std::nullopt;
    return merit;
}

double PoseMerit::evaluate(const RowMatrixXd& B, RowMatrixXd* BZ) const {
    const Index L = WK_.rows();
    if (B.rows() == 0) {
        if (BZ != nullptr) BZ->setZero(0, L);
        return is_trace_ ? -logarithm(base_) : factor_ * base_ + shift_;
    }
    const RowMatrixXd BWK = transposed_product(B.transpose(), WK_);
    const auto U = BWK.leftCols(L);
    MatrixXd G = U * B.transpose();
    G.diagonal().array() += 1;
    const Eigen::LLT<MatrixXd> cholesky(G);
    if (!is_trace_) {
        if (BZ != nullptr) *BZ = factor_ * cholesky.solve(U);
        return factor_ * (base_ + log_determinant(cholesky)) + shift_;
    }
    const auto BK = BWK.middleCols(whole_columns(L), L);
    const MatrixXd Q = BK * B.transpose();
    const MatrixXd HQ = cholesky.solve(Q);
    const double trace = base_ - HQ.trace();
    // The difference of two traces loses as many digits as it is smaller than they are.
    constexpr double much_larger = 1e5;
    if (!(base_ <= much_larger * trace)) {
        if (BZ != nullptr) BZ->setZero(B.rows(), L);
        return value_if_singular;
    }
    if (BZ != nullptr) {
        const RowMatrixXd HU = cholesky.solve(U);
        *BZ = (cholesky.solve(BK) - HQ * HU) / trace;
    }
    return -logarithm(trace);
}

}  // namespace posewise::detail
