#pragma once

#include "names.hpp"
#include "posewise/core/progress.hpp"

namespace posewise::detail {

inline constexpr Names<Ending, 10> ending_names{{{Ending::NotRun, "not run"},
                                                 {Ending::Converged, "converged"},
                                                 {Ending::Optimal, "optimal"},
                                                 {Ending::RoundoffLimited, "converged to rounding"},
                                                 {Ending::IterationLimit, "iteration limit"},
                                                 {Ending::Stalled, "stalled"},
                                                 {Ending::TimeLimit, "time limit"},
                                                 {Ending::Interrupted, "interrupted"},
                                                 {Ending::NotIdentifiable, "not identifiable"},
                                                 {Ending::Failed, "optimiser failed"}}};

}  // namespace posewise::detail
