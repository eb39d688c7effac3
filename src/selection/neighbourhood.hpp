#pragma once

#include <functional>
#include <memory>

#include "lanes.hpp"
#include "limits.hpp"
#include "posewise/criteria/objective.hpp"

namespace posewise {

/// Candidates to exchange with, prepared once and read by all starts.
struct Shortlist {
    std::vector<Index> members;
    LaneBlocks lanes;  ///< empty (rows 0) where no kernel serves the objective or the blocks
};
Shortlist make_shortlist(const Objective& objective, const Blocks& candidates,
                         std::vector<Index> members);

/// Finds the best candidate to take a removed pose's place. One for each start: it keeps what
/// depends on the current plan.
class Neighbourhood {
  public:
    virtual ~Neighbourhood() = default;
    /// The plan's information matrix is now M (positive definite).
    virtual void move_to(const MatrixXd& M) = 0;
    /// Position in the shortlist of the allowed candidate that makes the objective of (M -
    /// B^T B of `removed` + its own) largest, the first among equals; -1 if none can exceed
    /// `value`, the objective of M.
    virtual Index best_replacement(Index removed, double value, const Occupancy& occupancy) = 0;
};

/// BlockUpdates where there is a kernel for it, else Screening, which ends early if `must_stop`.
std::unique_ptr<Neighbourhood> make_neighbourhood(const Objective& objective,
                                                  const Blocks& candidates,
                                                  const Shortlist& shortlist,
                                                  const std::function<bool()>& must_stop);

}  // namespace posewise
