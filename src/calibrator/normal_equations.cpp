#include "normal_equations.hpp"

#include "core/products.hpp"

namespace posewise::detail {

NormalEquations normal_equations(const IdentificationProblem& problem,
                                 const LinearisedSystem& system) {
    const Index size = system.J().cols();
    const Index count = problem.prior_count();
    const MatrixXd all = gram(system.augmented.topRows(system.augmented.rows() - count));
    NormalEquations equations{all.topLeftCorner(size, size), all.row(size).head(size).transpose(),
                              system.r().squaredNorm()};
    const Index begin = problem.prior_begin();
    if (problem.campaign.prior) {
        const MatrixXd P = system.J().bottomRows(count).middleCols(begin, count);
        equations.M.block(begin, begin, count, count) += gram(P);
        equations.g.segment(begin, count) += P.transpose() * system.r().tail(count);
    } else {
        equations.M.block(begin, begin, count, count).diagonal().array() += 1;
        equations.g.segment(begin, count) += system.r().tail(count);
    }
    return equations;
}

Metric::Metric(const MatrixXd& M)
    : inverse_norms_(M.diagonal().cwiseSqrt().cwiseInverse()),
      L_(cholesky(inverse_norms_.asDiagonal() * M * inverse_norms_.asDiagonal())) {}

bool Metric::is_regular() const {
    constexpr double least_singular_value = 1e-6;
    return L_.rows() == inverse_norms_.size() && invert_lower(L_).norm() * least_singular_value < 1;
}

VectorXd Metric::solve(const VectorXd& g) const {
    VectorXd d = inverse_norms_.cwiseProduct(g);
    L_.triangularView<Eigen::Lower>().solveInPlace(d);
    L_.transpose().triangularView<Eigen::Upper>().solveInPlace(d);
    return inverse_norms_.cwiseProduct(d);
}

}  // namespace posewise::detail
