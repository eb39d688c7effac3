#pragma once

#include <cstdint>

#include "posewise/selection/plan.hpp"

namespace posewise {

struct SelectOptions {
    Criterion criterion = Criterion::D;
    Index pose_count = 0;     ///< K, must be stated
    Index starts = 20;        ///< the first from the greedy choice, the others random
    Index sweep_limit = 100;  ///< passes over all exchanges, for each start
    std::uint64_t seed = 1;
};

/// The best K of the candidates found by greedy start and block exchange with restarts (OpenMP
/// over starts; the result does not depend on the number of threads), and a proven bound.
/// For G and V the candidates themselves are the test poses.
/// Throws InputError if K is not in [1, candidates], if all candidates together do not identify
/// the parameters (naming how many directions are missing) or if no start found K poses that do.
Plan select_poses(const Blocks& candidates, const SelectOptions& options);

}  // namespace posewise
