#pragma once

#include <functional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

struct InverseOptions {
    /// Which joint values will do, such as those of the configuration that a program states; empty:
    /// all.
    std::function<bool(const VectorXd&)> is_wanted = {};
    /// Searches begin at so many configurations: half of them near the seed, the others all over
    /// the joint ranges.
    Index start_count = 64;
};

/// Joint values that bring a flange to a pose.
struct InverseSolution {
    /// Within the limits, nearest to the seed by the sum of squares (rad, m); empty: none was
    /// found.
    VectorXd joints;
    /// The next one of another branch, unless it is over twice as far from the seed: which of both
    /// was meant is not sure then. Empty: none.
    VectorXd rival;
};

/// Inverse kinematics of any chain: joint values at which the flange of the robot with these error
/// parameters is at `base_from_flange`, to 1e-6 m and rad, found by correct_configuration() from
/// many starts; joints that may turn more than once are tried at each turn. The search is the same
/// whenever its input is. A pose at which none was found may still have some. Throws InputError if
/// the seed is of another robot, not finite or beyond the joint limits, and for a robot with
/// measured torques.
InverseSolution inverse_kinematics(const Chain& robot, const VectorXd& parameters,
                                   const Isometry3d& base_from_flange, const VectorXd& seed,
                                   const InverseOptions& options = {});

}  // namespace posewise
