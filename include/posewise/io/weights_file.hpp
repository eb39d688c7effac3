#pragma once

#include <string>

#include "posewise/task/choice.hpp"

namespace posewise::io {

/// Writes the weights as CSV (config, weight; digits enough to read them back exactly), or as JSON,
/// which is to_json() of the design, by the file's ending. Throws InputError unless it is .csv
/// or .json.
void write_weights(const std::string& path, const ApproximateDesign& design);

}  // namespace posewise::io
