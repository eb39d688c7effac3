#include "decompositions.hpp"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <vector>

#include "parallel.hpp"
#include "products.hpp"

namespace posewise::detail {
namespace {

using HouseholderInPlace = Eigen::HouseholderQR<Eigen::Ref<MatrixXd>>;

}  // namespace

MatrixXd triangular_factor(MatrixXd A) {
    Eigen::Ref<MatrixXd> in_place(A);
    const HouseholderInPlace qr(in_place);
    return A.topRows(std::min(A.rows(), A.cols())).triangularView<Eigen::Upper>();
}

OrthogonalFactors orthogonal_factors(const MatrixXd& A) {
    const Reflections factors(A);
    return {factors.Q_times(MatrixXd::Identity(A.rows(), factors.R().rows())), factors.R()};
}

Reflections::Reflections(const MatrixXd& A) : qr_(A) {
    R_ = qr_.matrixQR().topRows(std::min(A.rows(), A.cols())).triangularView<Eigen::Upper>();
}

MatrixXd Reflections::Q_times(const MatrixXd& X) const { return qr_.householderQ() * X; }

MatrixXd Reflections::Q_transposed_times(const MatrixXd& X) const {
    return qr_.householderQ().adjoint() * X;
}

PivotedReflections::PivotedReflections(const MatrixXd& A, std::optional<double> threshold)
    : qr_(A.rows(), A.cols()) {
    if (threshold) qr_.setThreshold(*threshold);
    qr_.compute(A);
}

Index PivotedReflections::rank() const { return qr_.rank(); }

MatrixXd PivotedReflections::solve(const MatrixXd& B) const { return qr_.solve(B); }

MatrixXd PivotedReflections::outside(const MatrixXd& B) const {
    MatrixXd turned = B;
    turned.applyOnTheLeft(qr_.householderQ().adjoint());
    return turned.bottomRows(B.rows() - rank());
}

MatrixXd PivotedReflections::basis() const {
    return qr_.householderQ() * MatrixXd::Identity(qr_.rows(), rank());
}

MatrixXd triangular_factor_of_many(const RowMatrixXd& A) {
    const Index at_once = std::max<Index>(1024, 4 * A.cols());
    if (A.rows() <= 2 * at_once) return triangular_factor(A);
    const Index parts = (A.rows() + at_once - 1) / at_once;
    std::vector<MatrixXd> factors(static_cast<std::size_t>(parts));
    for_each_index(parts, [&](Index i) {
        const Index first = i * at_once;
        factors[static_cast<std::size_t>(i)] =
            triangular_factor(A.middleRows(first, std::min(at_once, A.rows() - first)));
    });
    Index rows = 0;
    for (const MatrixXd& factor : factors) rows += factor.rows();
    RowMatrixXd stacked(rows, A.cols());
    Index row = 0;
    for (const MatrixXd& factor : factors) {
        stacked.middleRows(row, factor.rows()) = factor;
        row += factor.rows();
    }
    return triangular_factor_of_many(stacked);
}

RowMatrixXd stack(const RowMatrixXd& above, const RowMatrixXd& below) {
    if (above.rows() == 0) return below;
    if (below.rows() == 0) return above;
    RowMatrixXd stacked(above.rows() + below.rows(), above.cols());
    stacked << above, below;
    return stacked;
}

MatrixXd information_of(const RowMatrixXd& rows, Index parameter_count) {
    if (rows.rows() == 0) return MatrixXd::Zero(parameter_count, parameter_count);
    return symmetric_gram(rows);
}

MatrixXd with_columns_of_norm_one(const MatrixXd& A) {
    MatrixXd scaled = A;
    for (auto column : scaled.colwise()) {
        const double norm = column.stableNorm();
        if (norm > 0) column /= norm;
    }
    return scaled;
}

SingularDirections singular_directions(const MatrixXd& A) {
    MatrixXd square = MatrixXd::Zero(A.cols(), A.cols());
    const MatrixXd R = triangular_factor_of_many(A);
    square.topRows(R.rows()) = R;
    const Eigen::JacobiSVD<MatrixXd> svd(square, Eigen::ComputeFullV);
    return {svd.singularValues(), svd.matrixV()};
}

VectorXd singular_values_of(const MatrixXd& A) {
    return Eigen::JacobiSVD<MatrixXd>(A).singularValues();
}

MatrixXd inverse_of(const MatrixXd& A) { return A.inverse(); }

Index count_independent_columns(const MatrixXd& A) {
    constexpr double least_left = 1e-10;
    const Index most = std::min(A.rows(), A.cols());
    if (most == 0 || !A.allFinite()) return 0;
    const Eigen::ColPivHouseholderQR<MatrixXd> qr(with_columns_of_norm_one(A));
    return (qr.matrixQR().diagonal().head(most).cwiseAbs().array() > least_left).count();
}

VectorXd solve_least_squares(MatrixXd A, const VectorXd& b) {
    Eigen::Ref<MatrixXd> in_place(A);
    return HouseholderInPlace(in_place).solve(b);
}

MatrixXd solve_least_squares(MatrixXd A, const MatrixXd& B) {
    Eigen::Ref<MatrixXd> in_place(A);
    return HouseholderInPlace(in_place).solve(B);
}

VectorXd solve_with_least_norm(const MatrixXd& A, const VectorXd& b, double threshold) {
    Eigen::CompleteOrthogonalDecomposition<MatrixXd> decomposition(A.rows(), A.cols());
    decomposition.setThreshold(threshold);
    decomposition.compute(A);
    return decomposition.solve(b);
}

Eigen::SelfAdjointEigenSolver<MatrixXd> eigen_decomposition(const MatrixXd& M,
                                                            Eigen::DecompositionOptions options) {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(M, options);
}

MatrixXd root_of(const MatrixXd& C) {
    const auto eigen = eigen_decomposition(C);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

MatrixXd lower_root_of_gram(const RowMatrixXd& A) {
    const MatrixXd R = triangular_factor_of_many(A);
    MatrixXd T = MatrixXd::Zero(R.cols(), R.cols());
    T.leftCols(R.rows()) = R.transpose();
    return T;
}

}  // namespace posewise::detail
