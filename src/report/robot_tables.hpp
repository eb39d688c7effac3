#pragma once

#include "posewise/model/chain.hpp"
#include "table.hpp"

/// What a chain looks like.
namespace posewise::detail {

/// Transforms from base to flange.
Table element_table(const Chain& robot);

/// What each joint does and its limits.
Table joint_table(const Chain& robot);

/// The line each joint turns about or slides along, in the base frame with all joints at zero.
Table axis_table(const Chain& robot);

/// "position 0 0 980 mm, roll pitch yaw 0 90 0 deg", base to flange with all joints at zero.
std::string describe_flange_at_zero(const Chain& robot);

}  // namespace posewise::detail
