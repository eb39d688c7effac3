#pragma once

#include <optional>

#include "local_search.hpp"
#include "relaxation.hpp"

namespace posewise::detail {

/// Fixes candidates by the bound: one whose presence (or absence) would push the bound of the
/// relaxation's certificate below the value of `best` is out (or in). If what stays open has at
/// most `limit` choices all are tried, and the best choice of all is returned: proven optimal.
/// Nothing if more stay open, or with repeats, which are not enumerated.
std::optional<ScoredPoses> enumerate_open_choices(const SearchProblem& problem,
                                                  const Relaxation& relaxation,
                                                  const ScoredPoses& best);

}  // namespace posewise::detail
