#include "prediction.hpp"

#include <cmath>

namespace posewise {

Sloped worst_variance(const Objective& objective, const Eigen::LLT<MatrixXd>& cholesky) {
    const Blocks& test_poses = *objective.test_poses;
    const MatrixXd whitened = cholesky.matrixL().solve(test_poses.matrix.transpose());
    VectorXd variances(test_poses.count());
    for (Index i = 0; i < test_poses.count(); ++i) {
        const Index first = test_poses.first_row[static_cast<std::size_t>(i)];
        variances[i] = whitened.middleCols(first, test_poses[i].rows()).squaredNorm();
    }
    return soft_largest(variances, objective.sharpness);
}

MatrixXd weighted_information(const Blocks& blocks, const VectorXd& weights) {
    RowMatrixXd scaled = blocks.matrix;
    for (Index i = 0; i < blocks.count(); ++i) {
        scaled.middleRows(blocks.first_row[static_cast<std::size_t>(i)], blocks[i].rows()) *=
            std::sqrt(weights[i]);
    }
    return scaled.transpose() * scaled;
}

}  // namespace posewise
