#pragma once

#include <fmt/format.h>

#include <chrono>
#include <string>

#include "core/format.hpp"
#include "posewise/core/progress.hpp"

namespace posewise::cli {

/// "best 12.3, efficiency 0.95, about 7 s left".
class ProgressNote {
  public:
    std::string operator()(const Progress& state) const {
        if (state.pose_count > 0) {
            return fmt::format("about {} poses, as choices from the pool have it",
                               state.pose_count);
        }
        using Seconds = std::chrono::duration<double>;
        const double elapsed = Seconds(std::chrono::steady_clock::now() - begin_).count();
        const double left = elapsed * static_cast<double>(state.total - state.done) /
                            static_cast<double>(state.done);
        // Unknown while the choice from the whole pool is still being made.
        const std::string efficiency = state.efficiency > 0
                                           ? fmt::format(", efficiency {} over the pool",
                                                         detail::format_fixed(state.efficiency, 3))
                                           : "";
        return fmt::format("best {}{}, about {:.0f} s left", detail::format_short(state.value),
                           efficiency, left);
    }

  private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace posewise::cli
