#include "call.hpp"

#include <pthread.h>

#include <cstdio>
#include <stdexcept>

namespace posewise::python {
namespace {

namespace py = pybind11;

std::atomic<Index> running_count{0};
std::atomic<bool> is_at_exit{false};

/// Other Python threads end their calls meanwhile.
void end_running_calls() {
    is_at_exit = true;
    while (running_count > 0) {
        const py::gil_scoped_release unlocked;
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

}  // namespace

RunningCall::RunningCall() {
    if (is_at_exit)
        throw std::runtime_error("the interpreter is exiting; no call is made any more");
    ++running_count;
}

RunningCall::~RunningCall() { --running_count; }

bool RunningCall::are_ended() { return is_at_exit; }

void RunningCall::register_exit() {
    py::module_::import("atexit").attr("register")(py::cpp_function(&end_running_calls));
    // A forked process has one thread only.
    pthread_atfork(nullptr, nullptr, [] { running_count = 0; });
}

UnforkedProcess::~UnforkedProcess() {
    if (getpid() == id_) return;
    std::fputs(
        "posewise: a process that was forked within a call of posewise came back to it, where the "
        "call's threads are missing; it ends here, and must end by os._exit() before\n",
        stderr);
    _exit(1);
}

ProgressCallback progress_of(const py::object& callable) {
    if (callable.is_none()) return {};
    return [&callable](const Progress& state) {
        const py::gil_scoped_acquire lock;
        const UnforkedProcess here;
        callable(state.done, state.total);
    };
}

}  // namespace posewise::python
