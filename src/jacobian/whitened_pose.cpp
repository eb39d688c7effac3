#include "whitened_pose.hpp"

#include "posewise/measurement/sensor.hpp"

namespace posewise::detail {

void WhitenedPose::place(const FlangeMotion& motion, const VectorXd& unknowns,
                         const VectorXd& repeats) {
    const Sensor& sensor = *campaign_.sensor;
    A_.resize(sensor.row_count(), 6 + unknowns.size());
    sensor.differentiate(motion.world_from_flange, TwistMatrix::Identity(6, 6), unknowns, A_);
    const MatrixXd& N = noise_.own_covariance(motion, unknowns, repeats);
    const std::vector<Index>& seen = noise_.rows();
    if (std::ssize(seen) < A_.rows()) A_ = A_(seen, Eigen::all).eval();
    is_diagonal_ = N.isDiagonal(0);
    if (is_diagonal_) inverse_deviations_ = N.diagonal().cwiseSqrt().cwiseInverse();
    whiten(N, A_, L_);
    if (A_.rows() > A_.cols()) {
        factors_ = Reflections(A_);
        R_ = factors_.R();
    } else {
        R_ = A_;
    }
    C_ = flange_covariance(campaign_, motion, unknowns);
    // K itself, which slopes() needs, of one row as well: whiten() keeps none of a diagonal.
    cholesky_factor(with_flange_motion(R_.leftCols<6>(), C_), K_);
    narrow_ = R_;
    K_.triangularView<Eigen::Lower>().solveInPlace(narrow_);
}

MatrixXd WhitenedPose::to_readings(const MatrixXd& X) const {
    MatrixXd all = X;
    if (A_.rows() > A_.cols()) {
        all.setZero(A_.rows(), X.cols());
        all.topRows(X.rows()) = X;
        all = factors_.Q_times(all);
    }
    if (is_diagonal_) return inverse_deviations_.asDiagonal() * all;
    L_.transpose().triangularView<Eigen::Upper>().solveInPlace(all);
    return all;
}

WhitenedPose::Slopes WhitenedPose::slopes(const MatrixXd& BZE, const MatrixXd& BZB) const {
    const auto K_transposed = K_.transpose().triangularView<Eigen::Upper>();
    const MatrixXd half = K_transposed.solve(BZB);
    const MatrixXd Y = K_transposed.solve(half.transpose());
    MatrixXd by_R = K_transposed.solve(BZE);
    by_R.leftCols<6>() -= Y * R_.leftCols<6>() * C_;
    Slopes slopes;
    slopes.by_A = to_readings(by_R);
    slopes.by_C = R_.leftCols<6>().transpose() * Y * R_.leftCols<6>();
    if (!campaign_.sensor->has_constant_covariance()) {
        slopes.by_N = to_readings(to_readings(Y).transpose());
    }
    return slopes;
}

void spread(const Eigen::Ref<const RowMatrixXd>& A, const TwistMatrix& twists,
            Eigen::Ref<RowMatrixXd> rows) {
    const Index unknowns = A.cols() - 6;
    rows.leftCols(twists.cols()).noalias() = A.leftCols<6>() * twists;
    rows.rightCols(unknowns) = A.rightCols(unknowns);
}

}  // namespace posewise::detail
