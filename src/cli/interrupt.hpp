#pragma once

#include <atomic>

namespace posewise::cli {

/// While it lives, the first Ctrl-C (SIGINT) only sets the flag; another, half a second later or
/// more, ends the program, and says that nothing was written: it must not outlive that.
class InterruptFlag {
  public:
    InterruptFlag();
    ~InterruptFlag();
    InterruptFlag(const InterruptFlag&) = delete;
    InterruptFlag& operator=(const InterruptFlag&) = delete;

    const std::atomic<bool>* get() const;
};

}  // namespace posewise::cli
