#pragma once

#include <string_view>

namespace posewise {

/// How something that iterates or searches ended. Whatever stopped it, its result is the best met.
enum class Ending {
    NotRun,
    Converged,        ///< nothing near improves it any more
    Optimal,          ///< all choices that could be better were ruled out or tried: none is
    RoundoffLimited,  ///< no step improves beyond rounding: as good as converged
    IterationLimit,   ///< still improving: usable, not the optimum
    Stalled,          ///< no step improves although the gradient is not zero
    TimeLimit,        ///< the best so far when the time was up
    Interrupted,      ///< the best so far when the caller asked to stop
    NotIdentifiable,  ///< the data leave a direction of the parameters open
    Failed,           ///< the optimiser gave up
};

/// In words, "time limit".
std::string_view ending_name(Ending ending);

}  // namespace posewise
