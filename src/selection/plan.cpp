#include "posewise/selection/plan.hpp"

namespace posewise {

std::string_view stop_reason_name(StopReason reason) {
    switch (reason) {
        case StopReason::Converged:
            return "converged";
        case StopReason::SweepLimit:
            return "sweep limit";
        default:
            return "not run";
    }
}

}  // namespace posewise
