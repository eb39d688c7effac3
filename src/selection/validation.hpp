#pragma once

#include "posewise/selection/choice.hpp"

namespace posewise::detail {

/// Throws InputError for options that contradict the candidates or each other.
void validate(const Blocks& candidates, const SelectOptions& options);

/// Why no choice of K candidates (with the rows held) can identify the parameters, as far as that
/// is known before any is tried, as a sentence: directions of parameter space that all candidates
/// together leave unseen, or fewer rows than parameters. Empty: one may.
std::string describe_unidentified(const Blocks& candidates, const SelectOptions& options);

}  // namespace posewise::detail
