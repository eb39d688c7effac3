#pragma once

#include <string>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// A plain matrix of finite numbers by the file's ending. `.mat`: the variable of that name, the
/// first one if none is named. Else CSV, separated by commas, semicolons or tabs; a first row
/// without any number is a header. Throws InputError with path:line:column for text or non-finite
/// numbers, ragged rows, and a file without rows.
RowMatrixXd read_matrix(const std::string& path, const std::string& variable = "");

}  // namespace posewise::detail
