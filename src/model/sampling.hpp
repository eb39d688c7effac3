#pragma once

#include <cstdint>

#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// Uniformly random configurations within the joint limits, count x configuration_size(); measured
/// torques are as random, up to their largest. Configuration i comes from stream (seed, i), so a
/// longer list begins with the shorter one.
RowMatrixXd random_configurations(const Chain& chain, Index count, std::uint64_t seed);

}  // namespace posewise::detail
