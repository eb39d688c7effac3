#include "posewise/planner/search.hpp"

namespace posewise {

std::string_view search_ending_name(SearchEnding ending) {
    switch (ending) {
        case SearchEnding::Converged:
            return "converged";
        case SearchEnding::RoundoffLimited:
            return "converged to rounding";
        case SearchEnding::EvaluationLimit:
            return "evaluation limit";
        case SearchEnding::TimeLimit:
            return "time limit";
        case SearchEnding::Interrupted:
            return "interrupted";
        case SearchEnding::Failed:
            return "optimiser failed";
        default:
            return "not run";
    }
}

std::chrono::steady_clock::time_point deadline_after(double seconds) {
    using Clock = std::chrono::steady_clock;
    constexpr double years = 1e8;
    if (!(seconds > 0) || seconds > years) return Clock::time_point::max();
    return Clock::now() +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace posewise
