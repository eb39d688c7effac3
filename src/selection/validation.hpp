#pragma once

#include "posewise/selection/exchange.hpp"

namespace posewise {

/// Throws InputError for options that contradict the candidates or each other, and for candidates
/// that (with the held information) do not identify the parameters.
void validate(const Blocks& candidates, const SelectOptions& options);

}  // namespace posewise
