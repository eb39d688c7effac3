#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "posewise/criteria/criterion.hpp"

namespace posewise {

enum class StopReason {
    NotRun,
    Converged,   ///< no exchange improves any start's best plan
    SweepLimit,  ///< a start was still improving when its sweeps were used up
};

std::string_view stop_reason_name(StopReason reason);

/// A choice of poses out of candidates.
struct Plan {
    std::vector<Index> poses;  ///< candidate indices, ascending
    Criterion criterion = Criterion::D;
    double value = -std::numeric_limits<double>::infinity();
    /// No K-subset of the candidates has a larger value. Infinity: nothing proven.
    double bound = std::numeric_limits<double>::infinity();
    /// In (0, 1]: the part of the best possible information per measurement that is proven
    /// reached. D: exp((value - bound) / L), others: value / bound, O3..O5 likewise.
    double efficiency = 0;
    std::uint64_t seed = 0;
    Index starts = 0;
    Index starts_at_best = 0;  ///< how many independent starts ended at this value
    StopReason stop_reason = StopReason::NotRun;
};

}  // namespace posewise
