#include "signal_delay.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <mutex>

namespace posewise::detail {
namespace {

constexpr std::array signals{SIGINT, SIGTERM, SIGHUP};

// What is done with a signal is of the whole program.
std::recursive_mutex mutex;
int depth = 0;
std::array<struct sigaction, signals.size()> actions_before{};
std::array<std::atomic<bool>, signals.size()> come{};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

void note(int signal) {
    for (std::size_t k = 0; k < signals.size(); ++k) {
        if (signals[k] == signal) come[k] = true;
    }
}

}  // namespace

SignalDelay::SignalDelay() {
    mutex.lock();
    if (depth++ > 0) return;
    struct sigaction delay {};
    delay.sa_handler = note;
    delay.sa_flags = SA_RESTART;
    for (std::size_t k = 0; k < signals.size(); ++k) {
        come[k] = false;
        ::sigaction(signals[k], nullptr, &actions_before[k]);
        if (actions_before[k].sa_handler != SIG_IGN) ::sigaction(signals[k], &delay, nullptr);
    }
}

SignalDelay::~SignalDelay() {
    if (--depth == 0) {
        for (std::size_t k = 0; k < signals.size(); ++k) {
            ::sigaction(signals[k], &actions_before[k], nullptr);
        }
        for (std::size_t k = 0; k < signals.size(); ++k) {
            if (come[k]) ::raise(signals[k]);
        }
    }
    mutex.unlock();
}

bool SignalDelay::has_come() {
    return std::ranges::any_of(come, [](const auto& one) { return one.load(); });
}

}  // namespace posewise::detail
