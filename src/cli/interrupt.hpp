#pragma once

#include <atomic>
#include <string_view>

namespace posewise::cli {

/// While it lives, the first Ctrl-C (SIGINT) or SIGTERM (kill, timeout, Slurm) only sets the flag;
/// another, half a second later or more, ends the program with the last words: by default that
/// nothing was written, and then it must not outlive that.
class InterruptFlag {
  public:
    /// The words must live for ever.
    explicit InterruptFlag(std::string_view last_words = "interrupted twice; nothing was written");
    ~InterruptFlag();
    InterruptFlag(const InterruptFlag&) = delete;
    InterruptFlag& operator=(const InterruptFlag&) = delete;

    const std::atomic<bool>* get() const;
};

}  // namespace posewise::cli
