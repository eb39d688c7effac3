#pragma once

#include <string>

#include "io/format/json.hpp"
#include "posewise/task/plan.hpp"

namespace posewise::detail {

/// What the file of a plan at that path holds.
Json plan_to_json(const Plan& plan, const std::string& path);

}  // namespace posewise::detail
