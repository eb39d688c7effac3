#pragma once

#include <atomic>
#include <chrono>

#include "posewise/core/ending.hpp"

namespace posewise {

/// What makes a long computation stop early, with the best found so far. With a deadline, results
/// depend on the machine.
struct StopSignal {
    const std::atomic<bool>* interrupted = nullptr;  ///< set by a signal handler or another thread
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

    bool is_interrupted() const { return interrupted != nullptr && interrupted->load(); }
    bool is_late() const {
        return deadline != std::chrono::steady_clock::time_point::max() &&
               std::chrono::steady_clock::now() >= deadline;
    }
    bool is_set() const { return is_interrupted() || is_late(); }
    /// With half of the time that is left.
    StopSignal with_half_the_time() const;
    /// Interrupted or TimeLimit if it is set, else `ending`.
    Ending ending_or(Ending ending) const;
};

/// The deadline `seconds` from now; 0: none. Throws InputError for less than 0.
std::chrono::steady_clock::time_point deadline_after(double seconds);

}  // namespace posewise
