#include "interrupt.hpp"

#include <algorithm>
#include <csignal>

namespace posewise::cli {
namespace {

std::atomic<bool> is_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

void note_interrupt(int /*signal*/) {
    is_interrupted = true;
    std::signal(SIGINT, SIG_DFL);
}

}  // namespace

InterruptFlag::InterruptFlag() {
    is_interrupted = false;
    std::signal(SIGINT, note_interrupt);
}

InterruptFlag::~InterruptFlag() { std::signal(SIGINT, SIG_DFL); }

const std::atomic<bool>* InterruptFlag::get() const { return &is_interrupted; }

double Stopwatch::left() const {
    if (limit_ == 0) return 0;
    const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begin_;
    return std::max(limit_ - gone.count(), 1e-3);
}

}  // namespace posewise::cli
