#include <fmt/format.h>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"

namespace posewise {

StopSignal StopSignal::with_half_the_time() const {
    if (deadline == std::chrono::steady_clock::time_point::max()) return *this;
    const auto now = std::chrono::steady_clock::now();
    return {interrupted, now + (deadline - now) / 2};
}

void StopSignal::check(const std::string& what) const {
    if (is_interrupted()) throw InputError("interrupted while " + what);
    if (is_late())
        throw InputError("the time was up while " + what + "; must be given more (`time`)");
}

Ending StopSignal::ending_or(Ending ending) const {
    if (is_interrupted()) return Ending::Interrupted;
    return is_late() ? Ending::TimeLimit : ending;
}

std::chrono::steady_clock::time_point deadline_after(double seconds) {
    using Clock = std::chrono::steady_clock;
    constexpr double years = 1e8;
    if (!(seconds >= 0)) {
        throw InputError(fmt::format("time limit is {:g} s, must not be negative", seconds));
    }
    if (seconds == 0 || seconds > years) return Clock::time_point::max();
    return Clock::now() +
           std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

}  // namespace posewise
