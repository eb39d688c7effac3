#pragma once

#include <string>
#include <vector>

#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// The measurements without what is named in `excluded`: "7" is the configuration of that id, "7:2"
/// its sample 2, by the file's column `sample`; where there is none the second one, and "7-12" the
/// configurations from 7 to 12 in the file's order. A configuration without samples is left out. Throws InputError for what is not there, or is named twice, and if
/// nothing would be left.
Measurements leave_out(const Measurements& measurements, const std::vector<std::string>& excluded);

}  // namespace posewise
