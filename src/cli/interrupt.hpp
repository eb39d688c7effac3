#pragma once

#include <atomic>
#include <chrono>

namespace posewise::cli {

/// While it lives, the first Ctrl-C (SIGINT) only sets the flag; the second ends the program.
class InterruptFlag {
  public:
    InterruptFlag();
    ~InterruptFlag();
    InterruptFlag(const InterruptFlag&) = delete;
    InterruptFlag& operator=(const InterruptFlag&) = delete;

    const std::atomic<bool>* get() const;
};

/// What is left of a time limit.
class Stopwatch {
  public:
    /// 0: there is none.
    explicit Stopwatch(double limit_s) : limit_(limit_s) {}
    /// In s, above 0 though it may be over; 0: there is no limit.
    double left() const;

  private:
    double limit_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace posewise::cli
