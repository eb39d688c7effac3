#pragma once

#include <optional>

#include "criteria/objective.hpp"

namespace posewise::detail {

/// The criterion of a plan as a function of one pose's block, the other poses at rest: without a
/// factorisation for each block.
///
/// R is the information of all other poses and of what is held, W = R^-1, B the block (r rows), C
/// the matrix with the criterion 1 / trace(C M^-1): the identity for A, the mean of B0^T B0 over
/// the test poses for V. With U = B W, K = W C W, H = (I + U B^T)^-1 and Q = B K B^T [Woodbury]:
///
///     log det M  = log det R + log det(I + U B^T)      B Z = H U
///     trace C M^-1 = trace C W - trace H Q             B Z = H (B K - Q H U) / trace C M^-1
///
/// where Z is the derivative of log det M, and of -log trace C M^-1, by M.
class PoseMerit {
  public:
    /// Nothing where R is singular or evaluate() says nothing of this block, for other criteria
    /// than D, O1, A and V, and with nuisance.
    static std::optional<PoseMerit> make(const Objective& objective, const MatrixXd& R,
                                         const RowMatrixXd& block);

    /// D as it is, the logarithm of the others. `BZ`, unless null, becomes B Z. value_if_singular
    /// where trace C M^-1 is so much smaller than trace C W that its digits are lost.
    double evaluate(const RowMatrixXd& B, RowMatrixXd* BZ = nullptr) const;

  private:
    PoseMerit() = default;

    bool is_trace_ = false;
    double base_ = 0;    ///< log det R, or trace C W
    double factor_ = 1;  ///< D and O1: the merit is factor_ log det M + shift_
    double shift_ = 0;
    RowMatrixXd WK_;  ///< [W K], or W, each with zero columns up to whole_columns()
};

}  // namespace posewise::detail
