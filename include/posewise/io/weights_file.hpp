#pragma once

#include <string>
#include <vector>

#include "posewise/task/choice.hpp"

namespace posewise::io {

/// Writes the weights as CSV (config, weight; digits enough to read them back exactly), or as JSON,
/// which is to_json() of the design with what was warned of, by the file's ending. Throws
/// InputError unless it is .csv or .json.
void write_weights(const std::string& path, const ApproximateDesign& design,
                   const std::vector<std::string>& warnings = {});

}  // namespace posewise::io
