#pragma once

#include <string>

#include "posewise/io/measurements_file.hpp"

namespace posewise::detail {

/// A list of points, joined with the plan that they were measured at: by name, or in order where no
/// name is one of the plan's and there are as many. Throws InputError with path:line:column.
io::MeasurementsFile read_planned_points(const std::string& path, std::string content,
                                         const Campaign& campaign, const io::PointsSource& source);

/// io::read_measurements_csv() of what was read from that file already.
io::MeasurementsFile read_measurements_table(const std::string& path, std::string content,
                                             const Campaign& campaign);

}  // namespace posewise::detail
