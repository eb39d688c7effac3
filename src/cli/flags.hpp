#pragma once

#include <string>

namespace posewise::cli {

/// What the library says of its options, `pose_count`, in words of the command line: --poses.
/// Other names in backquotes stay.
std::string with_flags(std::string message);

}  // namespace posewise::cli
