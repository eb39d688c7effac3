#pragma once

#include <string>

#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// Where each joint may be, rad or m; both ends the same: it stays.
struct JointRange {
    VectorXd lower;
    VectorXd upper;
};
JointRange limits_of(const Chain& robot);

/// "q2 is 61 deg, must be from -50 to 60 deg" (mm where it slides).
std::string describe_range(const std::string& name, Motion motion, double value, double lower,
                           double upper);

/// In these words: the first joint that is beyond
/// its limits by more than rounding, 1e-6 rad or m. Empty: none is.
std::string describe_limit_violation(const Chain& robot, const VectorXd& q);

}  // namespace posewise::detail
