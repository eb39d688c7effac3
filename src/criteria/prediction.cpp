#include "prediction.hpp"

#include <cmath>

#include "core/sensitivities.hpp"
#include "regular.hpp"

namespace posewise::detail {

Sloped worst_variance(const Objective& objective, const Eigen::LLT<MatrixXd>& cholesky) {
    const VectorXd variances = sensitivities(*objective.test_poses, inverse(cholesky));
    return soft_largest(variances, objective.sharpness);
}

RowMatrixXd weighted_rows(const Blocks& blocks, const VectorXd& weights) {
    const double negligible = 1e-18 * weights.maxCoeff();  // most of them for a sharp objective
    RowMatrixXd scaled(blocks.matrix.rows(), blocks.parameter_count());
    Index rows = 0;
    for (Index i = 0; i < blocks.count(); ++i) {
        if (!(weights[i] > negligible)) continue;
        const auto block = blocks[i];
        scaled.middleRows(rows, block.rows()) = std::sqrt(weights[i]) * block;
        rows += block.rows();
    }
    return scaled.topRows(rows);
}

}  // namespace posewise::detail
