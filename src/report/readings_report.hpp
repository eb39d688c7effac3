#pragma once

#include <string>

#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// Says whether the measurements fit best as they are stated, and if not, how else; a search that
/// tried some.
std::string describe_readings(const ReadingSearch& search);

}  // namespace posewise::detail
