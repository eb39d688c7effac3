#pragma once

#include "posewise/calibrator/identification.hpp"

namespace posewise::detail {

/// Largest error searched of each of the robot's parameters, m or rad; 0 for error terms.
VectorXd error_bounds(const Chain& robot, const GlobalOptions& options);

/// As register_roughly(), the robot with these errors, which the result has.
Registration register_roughly_with_errors(const Campaign& campaign,
                                          const Measurements& measurements,
                                          const VectorXd& robot_errors);

}  // namespace posewise::detail
