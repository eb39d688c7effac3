#pragma once

#include "posewise/selection/exchange.hpp"

namespace posewise::detail {

/// Throws InputError for options that contradict the candidates or each other.
void validate(const Blocks& candidates, const SelectOptions& options);

/// Which directions of parameter space all candidates together (with the held information) leave
/// unseen, as a sentence; empty: none.
std::string describe_unseen(const Blocks& candidates, const SelectOptions& options);

}  // namespace posewise::detail
