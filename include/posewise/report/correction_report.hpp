#pragma once

#include <string>

#include "posewise/task/correction.hpp"

namespace posewise {

/// The pose error with and without correction (mm, mrad), by how much joints change, and the first
/// twenty poses whose correction is not complete, with the reason, as text.
std::string format(const CorrectedPoses& poses);

}  // namespace posewise
