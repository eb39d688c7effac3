#include "posewise/core/progress.hpp"

namespace posewise {

std::string_view ending_name(Ending ending) {
    switch (ending) {
        case Ending::NotRun:
            return "not run";
        case Ending::Converged:
            return "converged";
        case Ending::Optimal:
            return "optimal";
        case Ending::RoundoffLimited:
            return "converged to rounding";
        case Ending::IterationLimit:
            return "iteration limit";
        case Ending::Stalled:
            return "stalled";
        case Ending::TimeLimit:
            return "time limit";
        case Ending::Interrupted:
            return "interrupted";
        case Ending::NotIdentifiable:
            return "not identifiable";
        case Ending::Failed:
            return "optimiser failed";
    }
    return "not run";
}

}  // namespace posewise
