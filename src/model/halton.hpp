#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "posewise/model/cell.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {

struct HaltonOptions {
    /// One base a joint, no two with a common factor; empty: the first primes 2, 3, 5, 7, 11, 13...
    std::vector<Index> bases;
    /// Index of the first point. Point 0 of the plain sequence lies on every lower limit.
    Index first_index = 1;
    /// Digits are permuted at random, by this seed [Owen 2017, "A randomized Halton algorithm"];
    /// nothing: the plain sequence.
    std::optional<std::uint64_t> scramble_seed;
};

/// Low-discrepancy configurations within the joint limits: count x joints. Joint j of point i is
/// the radical inverse of first_index + i in base j, so a longer list begins with the shorter one.
/// Throws InputError for a robot with measured torques, for a count or index below 0, another
/// number of bases than joints, and bases below 2, above 100 000 or with a common factor.
RowMatrixXd halton_configurations(const Chain& chain, Index count,
                                  const HaltonOptions& options = {});

/// The robot with its limits drawn in by the margin at both ends. Throws InputError if the margin
/// is negative or not finite, or if it leaves nothing of a joint's range.
Chain with_margin(const Chain& chain, const JointMargin& margin);

}  // namespace posewise::detail
