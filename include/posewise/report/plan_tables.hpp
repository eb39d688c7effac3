#pragma once

#include <string>
#include <vector>

#include "posewise/task/planning.hpp"
#include "posewise/task/verification.hpp"

namespace posewise {

/// What was chosen, its value, and what is proven about it, a line each.
std::string format_choice(const Plan& plan);

/// What was planned, how good it is, and the poses in visiting order.
std::string format_planning(const Planning& planning);

/// Predicted accuracy for other numbers of poses.
std::string format_other_counts(const std::vector<CountAccuracy>& counts);

/// Expected standard deviation of each parameter.
std::string format_deviations(const Plan& plan);

/// A line for each finding: "value:      as stated, -12.345678".
std::string format_findings(const std::vector<Finding>& findings);

}  // namespace posewise
