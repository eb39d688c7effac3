#pragma once

#include <string>

#include "posewise/task/correction_map.hpp"

namespace posewise::io {

/// Writes a map for a cell's own software, with what it is, how it is used and how far it is off:
/// a C99 source with the table and two functions (`.c`), or the table alone (`.csv`). Throws
/// InputError for another ending.
void write_correction_map(const std::string& path, const std::string& title,
                          const CorrectionMap& map);

/// Throws InputError unless the path ends in .c or .csv.
void check_map_path(const std::string& path);

}  // namespace posewise::io
