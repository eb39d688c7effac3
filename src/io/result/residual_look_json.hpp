#pragma once

#include "io/format/json.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// What the look at the residuals has found; an empty object: nothing.
Json look_to_json(const ResidualLook& look, const AmountUnits& units);

}  // namespace posewise::detail
