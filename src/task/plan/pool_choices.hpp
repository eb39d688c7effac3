#pragma once

#include <optional>
#include <vector>

#include "posewise/planner/planning.hpp"

namespace posewise::detail {

/// The first of a pool's candidates, as many as are searched where it has to be quick.
inline constexpr Index quick_pool_part = 1500;

/// Quick choices of any number of poses from a part of a pool: estimates of what a plan reaches.
class PoolChoices {
  public:
    /// `search` says the criterion, what is held and the seed; `prediction` where positions matter.
    /// That and the campaign must outlive it.
    PoolChoices(const Campaign& campaign, const Pool& pool, double repeats,
                const PlanOptions& search, const Blocks& prediction);

    Index candidate_count() const { return blocks_.count(); }
    /// Candidates by index; nothing: they do not identify the parameters, or there are too few.
    /// From one start; after a stop any that were found by then.
    std::optional<std::vector<Index>> choose(Index pose_count, const StopSignal& stop = {}) const;
    /// The blocks of chosen poses, and the information with what is held.
    Blocks blocks(const std::vector<Index>& chosen) const { return take(blocks_, chosen); }
    MatrixXd information(const std::vector<Index>& chosen) const;
    InformationByNoise by_noise(const std::vector<Index>& chosen) const;

  private:
    const Campaign& campaign_;
    RowMatrixXd configurations_;
    RowMatrixXd repeats_;
    Blocks blocks_;
    SelectOptions select_;
};

}  // namespace posewise::detail
