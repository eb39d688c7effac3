#pragma once

#include "posewise/core/blocks.hpp"

namespace posewise::detail {

/// Blocks B_i of which every one tells C^T C, whichever it is: B_i^T B_i = A_i^T A_i + C^T C. Each
/// choice of K then has sum A_i^T A_i + K C^T C, so C can be held and lower blocks searched. Three
/// targets measured with equal noise in all directions are such: three of nine rows are their
/// distances, which no pose changes.
struct CommonRows {
    Blocks others;     ///< A_i; empty if there is no C
    RowMatrixXd rows;  ///< C
};

/// C has a row for each direction that is in the row spaces of all blocks, B_i^T W_i = V with the
/// same W_i^T W_i for all i: C^T C = V (W_i^T W_i)^-1 V^T. Nothing where blocks have dependent
/// rows.
CommonRows split_common_rows(const Blocks& blocks);

}  // namespace posewise::detail
