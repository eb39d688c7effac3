#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

/// The rows that each pose contributes to the identification Jacobian, divided by the noise and
/// multiplied by each parameter's expected error, so they have no units. Criteria, selection and
/// certificates see only these rows; they know nothing about a robot.
struct Blocks {
    /// All poses stacked: row_count() x parameter_count().
    RowMatrixXd matrix;
    /// Rows of pose i are first_row[i] to first_row[i + 1] - 1; size is poses + 1.
    std::vector<Index> first_row{0};

    Index count() const { return static_cast<Index>(first_row.size()) - 1; }
    Index parameter_count() const { return matrix.cols(); }

    /// The rows of one pose, as a view.
    auto operator[](Index pose) const {
        const auto i = static_cast<std::size_t>(pose);
        return matrix.middleRows(first_row[i], first_row[i + 1] - first_row[i]);
    }
};

/// Throws InputError for a value that is not finite or exceeds 1e50 in magnitude, because its
/// square would overflow; the message names row and column, from 1. Also throws for a column, other
/// than 0, whose values are so small that their squares underflow.
void check_values(const RowMatrixXd& matrix);

/// Splits a plain matrix into blocks of equal height: every `rows_per_block` consecutive rows are
/// one pose. Throws InputError if the row count is not a multiple of it, or as check_values() does.
Blocks make_equal_blocks(const RowMatrixXd& matrix, Index rows_per_block);

/// The blocks of the listed poses, in that order; an index may occur more than once.
Blocks take(const Blocks& blocks, const std::vector<Index>& poses);

/// Information matrix sum_i B_i^T B_i over the listed poses, parameter_count() square. A pose
/// listed twice counts twice.
MatrixXd information(const Blocks& blocks, const std::vector<Index>& poses);

/// Information matrix over all poses.
MatrixXd information(const Blocks& blocks);

}  // namespace posewise
