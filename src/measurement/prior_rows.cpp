#include "prior_rows.hpp"

#include <Eigen/Cholesky>

#include "posewise/core/errors.hpp"

namespace posewise {

namespace detail {

RowMatrixXd prior_rows(const Campaign& campaign) {
    const Index begin = prior_begin(campaign);
    const Index count = prior_count(campaign);
    RowMatrixXd rows = RowMatrixXd::Zero(count, parameter_count(campaign));
    auto known = rows.middleCols(begin, count);
    known.setIdentity();
    if (!campaign.prior) return rows;
    const Eigen::LLT<MatrixXd> root(campaign.prior->covariance);
    if (root.info() != Eigen::Success || root.cols() != count) {
        throw InputError(
            "the prior is of other parameters, or its covariance not positive definite");
    }
    const VectorXd scale = parameter_scale(campaign).segment(begin, count);
    known = root.matrixL().solve(MatrixXd(scale.asDiagonal()));
    return rows;
}

}  // namespace detail

MatrixXd prior_information(const Campaign& campaign) {
    const RowMatrixXd rows = detail::prior_rows(campaign);
    return rows.transpose() * rows;
}

}  // namespace posewise
