#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

/// What each pose tells about the parameters: the rows of the identification Jacobian, divided by
/// the noise and multiplied by the expected size of each parameter's error, hence without units.
/// Criteria, selection and certificates see only this; they never hear of a robot.
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

/// Throws InputError, with row and column from 1, for a value that is not finite or beyond 1e50,
/// whose squares would overflow, and for a column of values so small that its squares would vanish,
/// other than 0.
void check_values(const RowMatrixXd& matrix);

/// Blocks of equal height from a plain matrix: each `rows_per_block` consecutive rows are one pose.
/// Throws InputError if the row count is not a multiple, or as check_values() does.
Blocks make_equal_blocks(const RowMatrixXd& matrix, Index rows_per_block);

/// The blocks of some poses, in the order asked for; an index may occur more than once.
Blocks take(const Blocks& blocks, const std::vector<Index>& poses);

/// The information matrix sum_i B_i^T B_i over the given poses, parameter_count() square. A pose
/// listed twice counts twice.
MatrixXd information(const Blocks& blocks, const std::vector<Index>& poses);

/// The information matrix over all poses.
MatrixXd information(const Blocks& blocks);

}  // namespace posewise
