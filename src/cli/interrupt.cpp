#include "interrupt.hpp"

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

}  // namespace posewise::cli
