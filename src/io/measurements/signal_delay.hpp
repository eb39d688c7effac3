#pragma once

namespace posewise::detail {

/// While one lives, the signals that end a program (SIGINT, SIGTERM, SIGHUP) wait, so that no
/// temporary file is left behind; at the end of the last one they are raised. Not by a mask, which
/// holds for one thread only: another one would take the signal. One thread may have several;
/// another one waits until they are gone.
class SignalDelay {
  public:
    SignalDelay();
    ~SignalDelay();
    SignalDelay(const SignalDelay&) = delete;
    SignalDelay& operator=(const SignalDelay&) = delete;

    /// Whether one waits.
    static bool has_come();
};

}  // namespace posewise::detail
