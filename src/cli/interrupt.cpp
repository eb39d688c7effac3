#include "interrupt.hpp"

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <string_view>

namespace posewise::cli {
namespace {

std::atomic<bool> is_interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

/// timeout(1) sends its signal to the program and then to the program's group: one wish, two
/// signals.
constexpr std::chrono::milliseconds echo{500};
std::atomic<std::chrono::steady_clock::rep> first_at{0};
static_assert(decltype(first_at)::is_always_lock_free, "set in a signal handler");

/// Set while no signal is caught.
std::string_view words;

void say(std::string_view text) {
    // Nobody is there to tell of a failure.
    [[maybe_unused]] const auto said = ::write(STDERR_FILENO, text.data(), text.size());
}

void note_interrupt(int signal) {
    using std::chrono::steady_clock;
    const steady_clock::rep now = steady_clock::now().time_since_epoch().count();
    steady_clock::rep first = 0;
    if (first_at.compare_exchange_strong(first, now)) {
        is_interrupted = true;
    } else if (steady_clock::duration(now - first) > echo) {
        say("posewise: ");
        say(words);
        say("\n");
        std::signal(signal, SIG_DFL);
        std::raise(signal);
    }
}

/// SIGTERM stays ignored where it is: in the ranks that follow one that is told.
void handle_signals(void (*handler)(int)) {
    std::signal(SIGINT, handler);
    if (std::signal(SIGTERM, handler) == SIG_IGN) std::signal(SIGTERM, SIG_IGN);
}

}  // namespace

InterruptFlag::InterruptFlag(std::string_view last_words) {
    words = last_words;
    is_interrupted = false;
    first_at = 0;
    handle_signals(note_interrupt);
}

InterruptFlag::~InterruptFlag() { handle_signals(SIG_DFL); }

const std::atomic<bool>* InterruptFlag::get() const { return &is_interrupted; }

}  // namespace posewise::cli
