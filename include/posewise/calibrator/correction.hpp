#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"

namespace posewise {

struct CorrectionOptions {
    /// The point whose position counts, in the flange frame, m.
    Vector3d tool = Vector3d::Zero();
    /// How much position an angle is worth where both cannot be had, m/rad: at 1, 1 mrad counts as
    /// 1 mm. 0: only the position counts.
    double length_per_angle = 1;
    /// No joint moves further than this. Near a singular pose a small correction would take a
    /// large one.
    double largest_turn = 0.1;   ///< of a revolute joint, rad
    double largest_slide = 0.1;  ///< of a prismatic joint, m
    Index iteration_limit = 100;
};

/// How far a pose is from where it should be.
struct PoseError {
    double position = 0;     ///< of the tool point, m
    double orientation = 0;  ///< angle, rad
};

/// Joint values that bring the real robot where the nominal one would be.
struct Correction {
    Ending ending = Ending::NotRun;
    VectorXd joints;                    ///< the configuration; measured torques as they were
    PoseError uncorrected;              ///< of the real robot at the nominal joint values
    PoseError residual;                 ///< of the real robot at the corrected ones
    std::vector<Index> held_by_limit;   ///< joints that their limit keeps from correcting further
    std::vector<Index> held_by_change;  ///< those that the largest turn or slide does
    /// Whether an error is left although the robot has joints enough (six; three if only the
    /// position counts) and none is held: near a singular pose, or beyond its reach.
    bool is_singular = false;
};

/// Corrected joint values for a nominal configuration: the flange of the robot with error
/// parameters `parameters` shall be at `base_from_flange`. Levenberg-Marquardt with the analytic
/// twists within the joint limits [Marquardt 1963]; minimises the squares of position error and
/// weighted angle, and among joint values that are equally good the change. A robot with fewer
/// than six joints, or with a joint held, comes as near as it can.
/// Throws InputError if the nominal configuration is not within the joint limits, or for options
/// out of range.
Correction correct_configuration(const Chain& robot, const VectorXd& parameters,
                                 const VectorXd& nominal, const Isometry3d& base_from_flange,
                                 const CorrectionOptions& options = {});

/// What kept a correction from being complete: "q3 at its limit, q4 at the largest change";
/// "singular"; empty if nothing did.
std::string describe_shortfall(const Chain& robot, const Correction& correction);

}  // namespace posewise
