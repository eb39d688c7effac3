#pragma once

#include <cstdint>

#include "posewise/model/chain.hpp"

namespace posewise {

/// How far apart the flanges of two robots are at most.
struct FlangeDifference {
    double position = 0;     ///< m
    double orientation = 0;  ///< rad
    Index configuration_count = 0;
};

/// Over random configurations within the limits of `a`, the i-th from stream (seed, i); error
/// parameters of each as for Chain::base_from_flange(). Joints are told by their names; torques
/// that are measured do not matter. Throws InputError if `b` has other joints.
FlangeDifference compare_flanges(const Chain& a, const VectorXd& parameters_a, const Chain& b,
                                 const VectorXd& parameters_b, Index configuration_count = 1000,
                                 std::uint64_t seed = 1);

}  // namespace posewise
