#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// A plain matrix of finite numbers, and what its file says of it.
struct StoredMatrix {
    RowMatrixXd values;
    Index rows_per_block = 0;          ///< of a file in three dimensions; 0: it does not say
    std::vector<std::string> names{};  ///< of the columns; empty: they have none
};

/// Reads a matrix by the file's ending. `.mat`, `.npz`: the variable of that name, the first one if
/// none is named. `.npy`: the array. Else text, separated by commas, semicolons, tabs or blanks
/// (numpy.savetxt()), where lines that begin with `#` are comments; a first row without any number
/// is a header. Throws InputError with path:line:column for text or non-finite numbers, ragged
/// rows, and a file without rows.
StoredMatrix read_matrix(const std::string& path, const std::string& variable = "");

}  // namespace posewise::detail
