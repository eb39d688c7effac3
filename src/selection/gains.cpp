#include "gains.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/products.hpp"

namespace posewise::detail {
namespace {

/// Digits that updates may lose: with this many of them in a row, each by a removal that leaves at
/// least such a part of the information, what is cached is right to nine digits.
constexpr int most_updates = 32;
constexpr double least_left_by_updates = 1e-6;
constexpr double singular = 1e-13;  // of the information in some direction, left by a removal
// Relative, above what is lost, so that nothing better is ruled out.
constexpr double gain_margin = 1e-8;
constexpr double variance_margin = 1e-7;
// Four times what single precision may be off by, where it is compared.
constexpr double rough_margin = 1e-3;
constexpr double rounding = 1e-13;  // of a sum of eigenvalues

/// What rounding left indefinite, made positive definite.
MatrixXd raised(MatrixXd M) {
    M.diagonal().array() += rounding * M.trace();
    return M;
}

/// The sum of X_k Y_k^T.
RowMatrixXd product_of_columns(const std::vector<MatrixXd>& X, const std::vector<MatrixXd>& Y) {
    const auto stack = [](const std::vector<MatrixXd>& parts) {
        Index count = 0;
        for (const MatrixXd& part : parts) count += part.cols();
        RowMatrixXd rows(count, parts.front().rows());
        count = 0;
        for (const MatrixXd& part : parts) {
            rows.middleRows(count, part.cols()) = part.transpose();
            count += part.cols();
        }
        return rows;
    };
    return transposed_product(stack(X), stack(Y));
}

}  // namespace

Shortlist make_shortlist(const Blocks& candidates, std::vector<Index> members) {
    Shortlist shortlist{std::move(members), {}, {}};
    shortlist.lanes = make_lane_blocks(candidates, shortlist.members);
    shortlist.rough = make_rough(shortlist.lanes);
    return shortlist;
}

Gains::Gains(const Blocks& candidates, const Shortlist& shortlist)
    : candidates_(candidates),
      shortlist_(shortlist),
      asked_(static_cast<std::size_t>(shortlist.lanes.groups)),
      gains_(asked_.size()),
      rough_gains_(static_cast<std::size_t>(shortlist.rough.groups)) {}

void Gains::follow_grams() {
    const auto count = static_cast<Index>(shortlist_.members.size());
    if (shortlist_.lanes.rows > 0) {
        const Index size = shortlist_.lanes.rows * (shortlist_.lanes.rows + 1) / 2;
        rough_G_ = make_rough(G_, size);
        if (!is_determinant()) rough_H_ = make_rough(H_, size);
        sensitivity_ = gram_traces(shortlist_.lanes, is_determinant() ? G_ : H_).head(count);
        return;
    }
    const RowMatrixXd& slope = is_determinant() ? inverse_ : slope_;
    sensitivity_.resize(count);
    for (Index k = 0; k < count; ++k) {
        const auto block = candidates_[shortlist_.members[static_cast<std::size_t>(k)]];
        sensitivity_[k] = transposed_product(block.transpose(), slope).cwiseProduct(block).sum();
    }
}

void Gains::move_to(const MatrixXd& M, const MatrixXd& C_root) {
    C_root_ = C_root;
    updates_ = 0;
    MatrixXd L = cholesky(M);
    if (L.size() == 0) L = cholesky(raised(M));
    const RowMatrixXd L_inverse = invert_lower(L);
    inverse_ = symmetric_gram(L_inverse);
    RowMatrixXd root;  // its transpose, slope = root^T root
    if (!is_determinant()) {
        root = transposed_product(solve_lower(L, C_root_), L_inverse);
        slope_ = symmetric_gram(root);
    }
    if (shortlist_.lanes.rows > 0) {
        G_ = make_grams(shortlist_.lanes, L_inverse.transpose());
        if (!is_determinant()) H_ = make_grams(shortlist_.lanes, root.transpose());
    }
    follow_grams();
}

void Gains::exchange(const Eigen::Ref<const RowMatrixXd>& added, const MatrixXd& M) {
    if (shortlist_.lanes.rows == 0 || !is_removal_accurate_ || ++updates_ > most_updates) {
        return move_to(M, C_root_);
    }
    // M'^-1 = W - T T^T and M'^-1 C M'^-1 = W C W - T S^T - S T^T.
    const MatrixXd A = added.transpose();
    const MatrixXd WA = apply_W(A);
    const Eigen::LLT<MatrixXd> growth(MatrixXd::Identity(A.cols(), A.cols()) + added * WA);
    const MatrixXd T = growth.matrixL().solve(WA.transpose()).transpose();
    MatrixXd S;
    if (!is_determinant()) {
        const MatrixXd WCWA =
            transposed_product(slope_, A) + P_ * (Q_.transpose() * A) + Q_ * (P_.transpose() * A);
        const MatrixXd WCT = growth.matrixL().solve(WCWA.transpose()).transpose();
        S = WCT - 0.5 * T * growth.matrixL().solve(added * WCT);
        slope_ += product_of_columns({P_, Q_, T, S}, {Q_, P_, -S, -T});
    }
    inverse_ += product_of_columns({P_, T}, {P_, -T});
    update_grams(shortlist_.lanes, std::array<GramUpdate, 2>{{{P_, Q_, 1}, {T, S, -1}}}, G_, H_);
    follow_grams();
}

bool Gains::remove(const Eigen::Ref<const RowMatrixXd>& block) {
    const RowMatrixXd B = block.transpose();
    const MatrixXd Z = transposed_product(inverse_, B);
    const MatrixXd slope_B = is_determinant() ? Z : MatrixXd(transposed_product(slope_, B));
    removed_sensitivity_ = slope_B.cwiseProduct(B).sum();
    const Eigen::LLT<MatrixXd> left(MatrixXd::Identity(block.rows(), block.rows()) - block * Z);
    if (left.info() != Eigen::Success) return false;
    const double least_left = left.matrixLLT().diagonal().array().square().minCoeff();
    if (least_left < singular) return false;
    P_ = left.matrixL().solve(Z.transpose()).transpose();
    is_removal_accurate_ = least_left > least_left_by_updates;
    const auto set_gains = [&](double lost) {
        least_gain_ = is_removal_accurate_ ? (1 - gain_margin) * lost : 0;
        certain_gain_ = is_removal_accurate_ ? (1 + gain_margin) * lost
                                             : std::numeric_limits<double>::infinity();
    };
    if (is_determinant()) {
        set_gains(1 / left.matrixLLT().diagonal().array().square().prod());
        return true;
    }
    // W C W - M^-1 C M^-1 = P Q^T + Q P^T with Q = M^-1 C P + P (P^T C P) / 2.
    const MatrixXd slope_P = left.matrixL().solve(slope_B.transpose()).transpose();
    const MatrixXd PCP = left.matrixL().solve(block * slope_P);
    set_gains(PCP.trace());
    Q_ = slope_P + 0.5 * P_ * PCP;
    return true;
}

MatrixXd Gains::apply_W(const MatrixXd& X) const {
    return transposed_product(inverse_, X) + P_ * (P_.transpose() * X);
}

double Gains::compute_plainly(Index position, const RowMatrixXd& WK) const {
    const auto block = candidates_[shortlist_.members[static_cast<std::size_t>(position)]];
    const RowMatrixXd BWK = transposed_product(block.transpose(), WK);
    const MatrixXd growth = MatrixXd::Identity(block.rows(), block.rows()) +
                            BWK.leftCols(block.cols()) * block.transpose();
    const Eigen::LLT<MatrixXd> cholesky(growth);
    if (is_determinant()) return cholesky.matrixLLT().diagonal().array().square().prod();
    const auto BK = BWK.middleCols(whole_columns(block.cols()), block.cols());
    return cholesky.solve(BK * block.transpose()).trace();
}

VectorXd Gains::compute(const std::vector<Index>& positions) {
    VectorXd result(static_cast<Index>(positions.size()));
    if (shortlist_.lanes.rows == 0) {
        const Index L = inverse_.rows();
        const Index whole = whole_columns(L);
        RowMatrixXd WK = RowMatrixXd::Zero(L, is_determinant() ? whole : 2 * whole);
        WK.leftCols(L) = inverse_ + P_ * P_.transpose();
        if (!is_determinant()) {
            WK.middleCols(whole, L) = slope_ + P_ * Q_.transpose() + Q_ * P_.transpose();
        }
        for (Index k = 0; k < result.size(); ++k) {
            result[k] = compute_plainly(positions[static_cast<std::size_t>(k)], WK);
        }
        return result;
    }
    std::fill(asked_.begin(), asked_.end(), char{0});
    for (const Index k : positions) asked_[static_cast<std::size_t>(k / lane_width)] = 1;
    if (is_determinant()) {
        lane_determinants(shortlist_.lanes, G_, P_, asked_, gains_);
    } else {
        lane_traces(shortlist_.lanes, G_, H_, P_, Q_, asked_, gains_);
    }
    for (Index k = 0; k < result.size(); ++k) {
        const Index at = positions[static_cast<std::size_t>(k)];
        result[k] = gains_[static_cast<std::size_t>(at / lane_width)]
                        .of[static_cast<std::size_t>(at % lane_width)];
    }
    return result;
}

VectorXd Gains::compute_roughly() {
    const auto count = static_cast<Index>(shortlist_.members.size());
    const RoughBlocks& blocks = shortlist_.rough;
    if (blocks.rows == 0) {
        std::vector<Index> all(static_cast<std::size_t>(count));
        std::iota(all.begin(), all.end(), Index{0});
        return compute(all);
    }
    const std::vector<char> asked(rough_gains_.size(), 1);
    if (is_determinant()) {
        lane_determinants(blocks, rough_G_, P_, asked, rough_gains_);
    } else {
        lane_traces(blocks, rough_G_, rough_H_, P_, Q_, asked, rough_gains_);
    }
    return Eigen::Map<const Eigen::VectorXf>(rough_gains_.data()->of.data(), count).cast<double>();
}

Gains::Largest Gains::largest_of(const std::vector<Index>& positions, const VectorXd& gains) const {
    Largest largest;
    for (Index k = 0; k < gains.size(); ++k) {
        if (!std::isfinite(gains[k]) || gains[k] < least_gain_) continue;
        if (largest.position >= 0 && gains[k] <= largest.gain) continue;
        largest = {positions[static_cast<std::size_t>(k)], gains[k]};
    }
    return largest;
}

Gains::Largest Gains::find_largest(const std::vector<Index>& positions) {
    if (shortlist_.rough.rows > 0 && is_removal_accurate_) {
        const VectorXd rough = compute_roughly();
        const double most = rough(positions).maxCoeff();
        std::vector<Index> near;
        for (const Index k : positions) {
            if (!(rough[k] < (1 - rough_margin) * most)) near.push_back(k);
        }
        const VectorXd gains = compute(near);
        const auto error = (rough(near) - gains).cwiseAbs().array();
        if ((error <= rough_margin / 4 * gains.array()).all()) return largest_of(near, gains);
    }
    return largest_of(positions, compute(positions));
}

std::vector<Index> Gains::keeping_below(double most, const std::vector<RowMatrixXd>& test_poses) {
    std::vector<Index> open(shortlist_.members.size());
    std::iota(open.begin(), open.end(), Index{0});
    if (shortlist_.lanes.rows == 0 || !is_removal_accurate_) return open;
    std::vector<Witness> witnesses;
    for (const RowMatrixXd& pose : test_poses) {
        const MatrixXd R = apply_W(pose.transpose());
        const double variance = R.cwiseProduct(pose.transpose()).sum();
        witnesses.push_back(make_witness(
            shortlist_.lanes, R, variance * (1 - variance_margin) - most * (1 + variance_margin)));
    }
    std::stable_sort(witnesses.begin(), witnesses.end(), [](const Witness& a, const Witness& b) {
        return a.least_fall > b.least_fall;
    });
    lane_spares(shortlist_.lanes, G_, P_, witnesses, gains_);
    std::erase_if(open, [&](Index k) {
        const auto at = static_cast<std::size_t>(k);
        return !(gains_[at / lane_width].of[at % lane_width] > 0);
    });
    return open;
}

}  // namespace posewise::detail
