#pragma once

#include <pybind11/pybind11.h>

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/core/threads.hpp"

/// Calls of the library from Python: they leave the interpreter to others, end early on Ctrl-C with
/// the best result so far, and tell of their progress.
namespace posewise::python {

/// What every long call takes.
struct CallOptions {
    std::optional<Index> threads;  ///< see set_thread_count()
    double time = 0;               ///< s, after which it ends with the best so far; 0: no limit
    pybind11::object progress;     ///< progress(done, total), or None
};

/// What a computation gets of them.
struct CallControl {
    StopSignal stop;
    ProgressCallback progress;  ///< empty: nobody asked

    /// Hands both to the options of a task.
    template <typename Options>
    void steer(Options& options) const {
        options.stop = stop;
        options.progress = progress;
    }
};

inline ProgressCallback progress_of(const pybind11::object& callable) {
    if (callable.is_none()) return {};
    return [&callable](const Progress& state) {
        const pybind11::gil_scoped_acquire lock;
        callable(state.done, state.total);
    };
}

/// What `compute(const CallControl&)` returns. It runs in a thread of its own without the
/// interpreter's lock; meanwhile this one looks for signals. A thread of its own also takes its
/// OpenMP threads along when it ends, so that a process can be forked after any call. Ctrl-C stops
/// the computation. It is raised as KeyboardInterrupt only if there is no result by then.
template <typename Compute>
auto call(const CallOptions& options, const Compute& compute) {
    std::atomic<bool> is_interrupted{false};
    std::optional<pybind11::error_already_set> raised;
    const CallControl control{{&is_interrupted, deadline_after(options.time)},
                              progress_of(options.progress)};
    std::packaged_task task([&] {
        if (options.threads) set_thread_count(*options.threads);
        return compute(control);
    });
    auto result = task.get_future();
    {
        const pybind11::gil_scoped_release unlocked;
        std::thread worker([&task] { task(); });
        while (result.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
            const pybind11::gil_scoped_acquire lock;
            if (PyErr_CheckSignals() == 0) continue;
            is_interrupted = true;
            raised.emplace();
        }
        worker.join();
    }
    const bool is_by_keyboard = raised && raised->matches(PyExc_KeyboardInterrupt);
    if (raised && !is_by_keyboard)
        throw std::move(*raised);  // a handler of other signals raised it
    try {
        return result.get();
    } catch (const InputError&) {
        if (is_by_keyboard) throw std::move(*raised);
        throw;
    }
}

/// As above for what takes none of these options, `compute()`.
template <typename Compute>
auto call(const Compute& compute) {
    return call(CallOptions{std::nullopt, 0, pybind11::none()},
                [&](const CallControl&) { return compute(); });
}

/// What `compute()` returns, for what takes less time than to start a thread: without the
/// interpreter's lock, and on this thread alone.
template <typename Compute>
auto call_here(const Compute& compute) {
    const pybind11::gil_scoped_release unlocked;
    struct Alone {
        Index asked = asked_thread_count();
        Alone() { set_thread_count(1); }
        ~Alone() { set_thread_count(asked); }
    } const alone;
    return compute();
}

}  // namespace posewise::python
