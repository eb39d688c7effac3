#pragma once

#include "core/decompositions.hpp"
#include "measurement/noise.hpp"

namespace posewise::detail {

/// What the readings of one pose after another tell, whitened by the noise of their means.
///
/// Whatever moves the flange, it has six ways to move. So the identification Jacobian of a pose is
/// J = A E, with the derivative A of the readings by the flange's motion (6 columns, A_6) and by
/// the sensor's unknowns, and E = [twists 0; 0 I]. The noise is S = N + A_6 C A_6^T: the readings'
/// own, and what they share because the flange itself moves, flange_covariance(). With N = L L^T
/// and L^-1 A = Q R (Q = I where A has no more rows than columns),
///
///     J^T S^-1 J = B^T B,    B = K^-1 R E,    K K^T = I + R_6 C R_6^T,
///
/// in at most 6 + unknowns rows: of a camera that sees 40 corners 15 remain of 80.
class WhitenedPose {
  public:
    explicit WhitenedPose(const Campaign& campaign) : campaign_(campaign), noise_(campaign) {}

    /// Goes to a pose. `repeats`: of each target, 0 where it is not seen. Throws InputError if the
    /// noise is not positive definite.
    void place(const FlangeMotion& motion, const VectorXd& unknowns, const VectorXd& repeats);

    /// K^-1 R.
    const RowMatrixXd& narrow() const { return narrow_; }
    /// Which rows of a complete observation are seen.
    const std::vector<Index>& readings() const { return noise_.rows(); }

    /// Derivatives of trace(Z B^T B) for a symmetric Z: 2 <by_A, dA> - <by_N, dN> - <by_C, dC>, and
    /// 2 <narrow()^T B Z, dE>.
    struct Slopes {
        RowMatrixXd by_A;  ///< a row for each reading that is seen
        MatrixXd by_N;
        Matrix6d by_C;
    };
    /// By B Z E^T and B Z B^T.
    Slopes slopes(const MatrixXd& BZE, const MatrixXd& BZB) const;

  private:
    /// L^-T Q X.
    MatrixXd to_readings(const MatrixXd& X) const;

    const Campaign& campaign_;
    PoseNoise noise_;
    RowMatrixXd A_;  ///< L^-1 A
    bool is_diagonal_ = false;
    MatrixXd L_;                   ///< where N is not diagonal
    VectorXd inverse_deviations_;  ///< where it is
    Reflections factors_;          ///< A_ = Q R, where it has more rows than columns
    MatrixXd R_;
    Matrix6d C_;
    MatrixXd K_;
    RowMatrixXd narrow_;
};

/// `rows` = A E.
void spread(const Eigen::Ref<const RowMatrixXd>& A, const TwistMatrix& twists,
            Eigen::Ref<RowMatrixXd> rows);

}  // namespace posewise::detail
