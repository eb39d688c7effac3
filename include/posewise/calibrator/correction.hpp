#pragma once

#include <functional>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/types.hpp"
#include "posewise/model/cell.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

struct CorrectionOptions {
    /// The point whose position counts, in the flange frame, m.
    Vector3d tool = Vector3d::Zero();
    /// Weight of an angle against position where both cannot be met, m/rad: at 1, 1 mrad counts
    /// like 1 mm. 0: only the position counts.
    double length_per_angle = 1;
    /// Largest change of each joint. Near a singular pose a small correction would need a large
    /// one.
    double largest_turn = 0.1;   ///< for a revolute joint (rad)
    double largest_slide = 0.1;  ///< for a prismatic joint (m)
    Index iteration_limit = 100;
    /// Sums of joints that a correction carries no further beyond their limits.
    std::vector<JointSum> joint_sums = {};
};

/// How far a pose is from where it should be.
struct PoseError {
    double position = 0;     ///< at the tool point, m
    double orientation = 0;  ///< angle, rad
};

/// Joint values that bring the real robot where the nominal one would be.
struct Correction {
    Ending ending = Ending::NotRun;
    VectorXd joints;                       ///< the configuration; measured torques unchanged
    PoseError uncorrected;                 ///< real robot at the nominal joint values
    PoseError residual;                    ///< real robot at the corrected ones
    std::vector<Index> held_by_limit;      ///< joints whose limit prevents further correction
    std::vector<Index> held_by_change;     ///< joints whose largest turn or slide does
    std::vector<std::string> held_by_sum;  ///< names of joint sums whose limit does
    /// Whether an error is left although the robot has enough joints (six; three if only the
    /// position counts) and none is held: near a singular pose, or out of reach.
    bool is_singular = false;
};

/// Corrects the joint values of a nominal configuration so that the flange of the robot with error
/// parameters `parameters` is at `base_from_flange`. Uses Levenberg-Marquardt [Marquardt 1963] with
/// the analytic twists, within the joint limits and those of joint sums. Minimises the squares of
/// position error and weighted angle; among equally good joint values it takes the smallest change.
/// A robot with fewer than six joints, or with a held joint or sum, comes as near as it can. Throws
/// InputError if the nominal configuration is not within the joint limits, or for options out of
/// range.
Correction correct_configuration(const Chain& robot, const VectorXd& parameters,
                                 const VectorXd& nominal, const Isometry3d& base_from_flange,
                                 const CorrectionOptions& options = {});

/// Why a correction is incomplete: "q3 at its limit, q4 at the largest change"; "singular"; empty
/// if it is complete.
std::string describe_shortfall(const Chain& robot, const Correction& correction);

struct InverseOptions {
    /// Which joint values will do, such as those of the configuration that a program states; empty:
    /// all.
    std::function<bool(const VectorXd&)> is_wanted = {};
    /// Number of configurations that searches begin at: half are near the seed, the others spread
    /// over the joint ranges.
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
