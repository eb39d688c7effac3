#include "decompositions.hpp"

#include <Eigen/QR>
#include <algorithm>

namespace posewise::detail {
namespace {

using HouseholderInPlace = Eigen::HouseholderQR<Eigen::Ref<MatrixXd>>;

}  // namespace

MatrixXd triangular_factor(MatrixXd A) {
    Eigen::Ref<MatrixXd> in_place(A);
    const HouseholderInPlace qr(in_place);
    return A.topRows(std::min(A.rows(), A.cols())).triangularView<Eigen::Upper>();
}

VectorXd solve_least_squares(MatrixXd A, const VectorXd& b) {
    Eigen::Ref<MatrixXd> in_place(A);
    return HouseholderInPlace(in_place).solve(b);
}

MatrixXd solve_least_squares(MatrixXd A, const MatrixXd& B) {
    Eigen::Ref<MatrixXd> in_place(A);
    return HouseholderInPlace(in_place).solve(B);
}

Eigen::SelfAdjointEigenSolver<MatrixXd> eigen_decomposition(const MatrixXd& M,
                                                            Eigen::DecompositionOptions options) {
    return Eigen::SelfAdjointEigenSolver<MatrixXd>(M, options);
}

MatrixXd root_of(const MatrixXd& C) {
    const auto eigen = eigen_decomposition(C);
    return eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

MatrixXd lower_root_of(const MatrixXd& C) {
    return triangular_factor(root_of(C).transpose()).transpose();
}

}  // namespace posewise::detail
