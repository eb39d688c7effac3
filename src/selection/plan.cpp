#include "posewise/selection/plan.hpp"

namespace posewise {

std::string_view stop_reason_name(StopReason reason) {
    switch (reason) {
        case StopReason::Converged:
            return "converged";
        case StopReason::Optimal:
            return "optimal";
        case StopReason::TimeLimit:
            return "time limit";
        case StopReason::Interrupted:
            return "interrupted";
        default:
            return "not run";
    }
}

}  // namespace posewise
