#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include "posewise/core/types.hpp"

/// How a long computation is watched, stopped early, and how it ended.
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
    /// Throws InputError if it is set: for `what`, of which nothing is of use before its end.
    void check(const std::string& what) const;
    /// Interrupted or TimeLimit if it is set, else `ending`.
    Ending ending_or(Ending ending) const;
};

/// The deadline `seconds` from now; 0: none. Throws InputError for less than 0.
std::chrono::steady_clock::time_point deadline_after(double seconds);

/// How far a long computation has come, in parts of it (starts, folds, cases). Computations fill
/// in what they know.
struct Progress {
    Index done = 0;
    Index total = 0;
    double value = -std::numeric_limits<double>::infinity();  ///< of the best plan so far
    double bound = std::numeric_limits<double>::infinity();   ///< no plan has a larger value
    double efficiency = 0;  ///< of the value against the bound, from 0 to 1
};

/// Called from one thread at a time. What it throws ends the computation and reaches its caller.
using ProgressCallback = std::function<void(const Progress&)>;

}  // namespace posewise
