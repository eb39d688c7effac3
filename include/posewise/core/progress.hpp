#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <string_view>

#include "posewise/core/types.hpp"

/// Progress, early stopping and endings of long computations.
namespace posewise {

/// How an iteration or search ended. Whatever stopped it, the result is the best one found.
enum class Ending {
    NotRun,
    Converged,        ///< no small change improves it any more
    Optimal,          ///< every choice that could be better was ruled out or tried: none is
    RoundoffLimited,  ///< no step improves beyond rounding: as good as converged
    IterationLimit,   ///< still improving: usable, not the optimum
    Stalled,          ///< no step improves although the gradient is not zero
    TimeLimit,        ///< the best result when time ran out
    Interrupted,      ///< the best result when the caller asked to stop
    NotIdentifiable,  ///< the data leave a direction of the parameters undetermined
    Failed,           ///< the optimiser gave up
};

/// The ending in words: "time limit".
std::string_view ending_name(Ending ending);

/// Stops a long computation early; its result is then the best one found so far. With a deadline,
/// results depend on the machine.
struct StopSignal {
    const std::atomic<bool>* interrupted = nullptr;  ///< set by a signal handler or another thread
    std::chrono::steady_clock::time_point deadline = std::chrono::steady_clock::time_point::max();

    bool is_interrupted() const { return interrupted != nullptr && interrupted->load(); }
    bool is_late() const {
        return deadline != std::chrono::steady_clock::time_point::max() &&
               std::chrono::steady_clock::now() >= deadline;
    }
    bool is_set() const { return is_interrupted() || is_late(); }
    /// This signal with half of the remaining time.
    StopSignal with_half_the_time() const;
    /// Throws InputError "interrupted while `what`" (or out of time) if the signal is set. For
    /// computations whose partial results are useless.
    void check(const std::string& what) const;
    /// Interrupted or TimeLimit if it is set, else `ending`.
    Ending ending_or(Ending ending) const;
};

/// The deadline `seconds` from now; 0: none. Throws InputError for less than 0.
std::chrono::steady_clock::time_point deadline_after(double seconds);

/// Progress of a long computation, counted in its parts (starts, folds, cases). Each computation
/// fills in what it knows.
struct Progress {
    Index done = 0;
    Index total = 0;
    double value = -std::numeric_limits<double>::infinity();  ///< value of the best plan so far
    double bound = std::numeric_limits<double>::infinity();   ///< no plan has a larger value
    double efficiency = 0;  ///< efficiency of the value against the bound, from 0 to 1
    Index pose_count = 0;   ///< what a search for a number of poses has come to; 0: nothing
};

/// Called from one thread at a time. An exception it throws ends the computation and reaches the
/// caller.
using ProgressCallback = std::function<void(const Progress&)>;

/// Sets the number of threads for work started by the calling thread. The default is one per core,
/// or OMP_NUM_THREADS. No result depends on it. Throws InputError for less than 1.
void set_thread_count(Index count);

/// The number of threads asked for, by set_thread_count() or OMP_NUM_THREADS.
Index asked_thread_count();

/// The number of threads used for work started by the calling thread: the number asked for, but at
/// most four per core.
Index thread_count();

/// Fixes, for the whole process, the cache sizes by which Eigen blocks its products. Otherwise
/// Eigen asks the CPU, and the order of its sums, hence the last digits of every result, depends on
/// the CPU type. The posewise program calls this first; a program that uses the library and
/// wants the same digits must do so, too. `level1` is in bytes; a value other than the default is
/// for testing that nothing depends on it.
void fix_cache_sizes(Index level1 = 32 * 1024);

}  // namespace posewise
