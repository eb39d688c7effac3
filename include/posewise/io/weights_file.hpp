#pragma once

#include <string>

#include "posewise/task/choice.hpp"

namespace posewise::io {

/// Throws InputError unless the path ends in .csv or .json.
void check_weights_path(const std::string& path);

/// Writes the weights as CSV (config, weight; digits enough to read them back exactly), or as JSON,
/// which is to_json() of the design, by the file's ending. Throws as check_weights_path().
void write_weights(const std::string& path, const ApproximateDesign& design);

}  // namespace posewise::io
