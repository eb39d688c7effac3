#include "posewise/core/blocks.hpp"

#include <fmt/format.h>

#include <cmath>

#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr double largest_value = 1e50;  // informations, their products and inverses stay finite
constexpr double least_of_column = 1 / largest_value;

}  // namespace

void check_values(const RowMatrixXd& matrix) {
    for (Index row = 0; row < matrix.rows(); ++row) {
        for (Index column = 0; column < matrix.cols(); ++column) {
            if (std::abs(matrix(row, column)) <= largest_value) continue;
            throw InputError(
                fmt::format("row {}, column {} of the matrix is {:g}; must be finite, at most {:g} "
                            "in magnitude, for its square is taken",
                            row + 1, column + 1, matrix(row, column), largest_value));
        }
    }
    for (Index column = 0; column < matrix.cols() && matrix.rows() > 0; ++column) {
        const double largest = matrix.col(column).cwiseAbs().maxCoeff();
        if (largest == 0 || largest >= least_of_column) continue;
        throw InputError(
            fmt::format("column {} of the matrix is at most {:g} in magnitude, whose square is "
                        "lost; must be 0, or its parameter in a larger unit",
                        column + 1, largest));
    }
}

Blocks make_equal_blocks(const RowMatrixXd& matrix, Index rows_per_block) {
    if (rows_per_block < 1) {
        throw InputError("rows per block is " + std::to_string(rows_per_block) +
                         ", must be at least 1");
    }
    if (matrix.rows() % rows_per_block != 0) {
        throw InputError("matrix has " + std::to_string(matrix.rows()) +
                         " rows, not a multiple of " + std::to_string(rows_per_block) +
                         " rows per block");
    }
    check_values(matrix);
    Blocks blocks{matrix, {0}};
    for (Index row = rows_per_block; row <= matrix.rows(); row += rows_per_block) {
        blocks.first_row.push_back(row);
    }
    return blocks;
}

Blocks take(const Blocks& blocks, const std::vector<Index>& poses) {
    Blocks taken;
    for (const Index pose : poses) {
        taken.first_row.push_back(taken.first_row.back() + blocks[pose].rows());
    }
    taken.matrix.resize(taken.first_row.back(), blocks.parameter_count());
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const auto block = blocks[poses[i]];
        taken.matrix.middleRows(taken.first_row[i], block.rows()) = block;
    }
    return taken;
}

MatrixXd information(const Blocks& blocks, const std::vector<Index>& poses) {
    MatrixXd M = MatrixXd::Zero(blocks.parameter_count(), blocks.parameter_count());
    for (const Index pose : poses) {
        M.selfadjointView<Eigen::Lower>().rankUpdate(blocks[pose].transpose());
    }
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

MatrixXd information(const Blocks& blocks) {
    MatrixXd M = MatrixXd::Zero(blocks.parameter_count(), blocks.parameter_count());
    M.selfadjointView<Eigen::Lower>().rankUpdate(blocks.matrix.transpose());
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

}  // namespace posewise
