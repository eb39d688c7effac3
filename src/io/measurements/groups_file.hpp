#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

/// Groups of candidates (regions, payloads) from a CSV with the columns config and group: a label
/// for each of `ids`, in their order, numbered as the groups first occur in the file. Throws
/// InputError with path:line:column for an unknown or repeated id, and if one of `ids` is missing.
std::vector<Index> read_groups(const std::string& path, const std::vector<std::string>& ids);

}  // namespace posewise::detail
