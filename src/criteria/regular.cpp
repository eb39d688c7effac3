#include "regular.hpp"

#include <algorithm>

namespace posewise::detail {

Reduction eliminate(const MatrixXd& M, const std::vector<Index>& nuisance) {
    std::vector<Index> interest;
    for (Index i = 0; i < M.rows(); ++i) {
        if (!std::binary_search(nuisance.begin(), nuisance.end(), i)) interest.push_back(i);
    }
    const MatrixXd M22 = M(nuisance, nuisance);
    const Eigen::LLT<MatrixXd> cholesky(M22);
    if (!is_regular(cholesky, M22)) return {};
    const auto count = static_cast<Index>(interest.size());
    Reduction reduction{MatrixXd::Zero(M.rows(), count), {}};
    reduction.N(interest, Eigen::all) = MatrixXd::Identity(count, count);
    reduction.N(nuisance, Eigen::all) = -cholesky.solve(M(nuisance, interest));
    reduction.M = reduction.N.transpose() * M * reduction.N;
    // Of a column that the nuisance explains, rounding is left: compare with the whole column.
    if (!is_regular(Eigen::LLT<MatrixXd>(reduction.M), M(interest, interest))) return {};
    return reduction;
}

}  // namespace posewise::detail
