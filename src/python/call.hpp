#pragma once

#include <pybind11/pybind11.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <future>
#include <optional>
#include <thread>
#include <utility>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"

/// Calls of the library from Python: they leave the interpreter to others, end early on Ctrl-C with
/// the best result so far, and tell of their progress.
namespace posewise::python {

/// What every long call takes.
struct CallOptions {
    std::optional<Index> threads = {};             ///< see set_thread_count()
    double time = 0;                               ///< s, after which it ends; 0: no limit
    pybind11::object progress = pybind11::none();  ///< progress(done, total), or None
    mutable bool is_interrupted = false;           ///< afterwards: by Ctrl-C
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

/// A call that runs without the interpreter's lock; made and destroyed with the lock. None may
/// outlive the interpreter: at its exit all are asked to stop, and waited for.
class RunningCall {
  public:
    /// Throws std::runtime_error at the interpreter's exit.
    RunningCall();
    ~RunningCall();
    RunningCall(const RunningCall&) = delete;
    RunningCall& operator=(const RunningCall&) = delete;

    static bool are_ended();
    /// To be called once: at the interpreter's exit it ends them, with the lock.
    static void register_exit();
};

/// Around Python code that a call runs in its threads. A process that is forked there has none of
/// them: coming back from that code, it ends with a sentence on standard error and exit code 1.
class UnforkedProcess {
  public:
    UnforkedProcess() = default;
    ~UnforkedProcess();
    UnforkedProcess(const UnforkedProcess&) = delete;
    UnforkedProcess& operator=(const UnforkedProcess&) = delete;

  private:
    pid_t id_ = getpid();
};

ProgressCallback progress_of(const pybind11::object& callable);

/// What `compute(const CallControl&)` returns. It runs in a thread of its own without the
/// interpreter's lock; meanwhile this one looks for signals. A thread of its own also takes its
/// OpenMP threads along when it ends, so that a process can be forked after any call. Ctrl-C stops
/// the computation; if there is no result then, it is raised as KeyboardInterrupt, else the options
/// say so.
template <typename Compute>
auto call(const CallOptions& options, const Compute& compute) {
    const RunningCall running;
    std::atomic<bool> is_stopped{false};
    std::optional<pybind11::error_already_set> raised;
    const CallControl control{{&is_stopped, deadline_after(options.time)},
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
            if (RunningCall::are_ended()) is_stopped = true;
            const pybind11::gil_scoped_acquire lock;
            if (PyErr_CheckSignals() == 0) continue;
            is_stopped = true;
            raised.emplace();
        }
        worker.join();
    }
    options.is_interrupted = raised && raised->matches(PyExc_KeyboardInterrupt);
    if (raised && !options.is_interrupted)
        throw std::move(*raised);  // a handler of other signals raised it
    try {
        return result.get();
    } catch (const InputError&) {
        if (options.is_interrupted) throw std::move(*raised);
        throw;
    }
}

/// As above for what takes none of these options and has no result before it ends: Ctrl-C is
/// raised as KeyboardInterrupt.
template <typename Compute>
auto call(const Compute& compute) {
    const CallOptions options;
    auto result = call(options, compute);
    if (!options.is_interrupted) return result;
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw pybind11::error_already_set();
}

/// What `compute()` returns, for what takes less time than to start a thread: without the
/// interpreter's lock, and on this thread alone.
template <typename Compute>
auto call_here(const Compute& compute) {
    const RunningCall running;
    const pybind11::gil_scoped_release unlocked;
    struct Alone {
        Index asked = asked_thread_count();
        Alone() { set_thread_count(1); }
        ~Alone() { set_thread_count(asked); }
    } const alone;
    return compute();
}

}  // namespace posewise::python
