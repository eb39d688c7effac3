#pragma once

#include <atomic>
#include <chrono>
#include <string_view>

namespace posewise {

/// How a continuous search ended. In all cases its result is the best feasible point met, never
/// worse than its start.
enum class SearchEnding {
    NotRun,
    Converged,
    RoundoffLimited,  ///< no step improves beyond rounding: as good as converged
    EvaluationLimit,
    TimeLimit,
    Interrupted,
    Failed,  ///< the optimiser gave up
};
std::string_view search_ending_name(SearchEnding ending);

/// What makes a long search stop early, with the best found so far.
struct StopSignal {
    const std::atomic<bool>* interrupted = nullptr;  ///< set by a signal handler or another thread
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

    bool is_interrupted() const { return interrupted != nullptr && interrupted->load(); }
    bool is_late() const {
        return deadline != std::chrono::steady_clock::time_point::max() &&
               std::chrono::steady_clock::now() >= deadline;
    }
    bool is_set() const { return is_interrupted() || is_late(); }
};

/// The deadline `seconds` from now; 0: none.
std::chrono::steady_clock::time_point deadline_after(double seconds);

}  // namespace posewise
