#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "posewise/measurement/sensor.hpp"
#include "posewise/model/cell.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

/// Values of everything a calibration identifies. As a vector (names: parameter_names()) the order
/// is base (6, less those known), robot, sensor; see advance() for what those of the base mean.
struct Parameters {
    Isometry3d world_from_base = Isometry3d::Identity();
    VectorXd robot;   ///< the chain's error parameters, m or rad; zero is nominal
    VectorXd sensor;  ///< the sensor's unknowns (targets in the flange frame), m
};

/// The expected size of each parameter's error: the scale of its column, and its prior standard
/// deviation where priors are on. Metres and radians.
struct ParameterSpread {
    double length = 1e-3;
    double angle = 1e-3;
    std::map<std::string, double> by_name;  ///< exceptions, by parameter name
    bool is_prior = false;      ///< whether it is also the prior standard deviation of robot errors
    double gravity = 1e-3;      ///< of terms of TermKind::Gravity and TermKind::Torque
    double harmonic = 0.15e-3;  ///< of terms of TermKind::Harmonic
    double tilt = 0.05e-3;      ///< of terms of TermKind::Tilt
    std::optional<double> offset = {};  ///< of joints that turn; nothing: as other angles
};

/// Model errors differ so much from robot to robot that one standard deviation is this factor.
inline constexpr double model_error_factor = 2.5;
/// And the sizes of the errors that parameters express this one.
inline constexpr double error_size_factor = 2;

/// How surely they are known before measuring: one standard deviation is a factor of so much. Of
/// robots nobody has measured, or as an earlier estimate tells.
struct KnownWithin {
    double model_error = model_error_factor;
    double error_size = error_size_factor;
};

/// The size of this error of the robot by its kind; `by_name` may state another.
double& size_of(ParameterSpread& spread, const Chain& robot, Index parameter);

/// A size that several errors of a robot share.
struct SharedSize {
    std::string key;  ///< under `spread` in a campaign file, without unit: "offset"
    double size = 0;  ///< m or rad
    bool is_angle = false;
    std::vector<Index> members;  ///< parameters of the robot
};

/// The sizes that the robot's errors share, but for those that `by_name` states.
std::vector<SharedSize> shared_sizes(const ParameterSpread& spread, const Chain& robot);

/// What errors robots of this size have, as a prior: for full_model().
ParameterSpread population_spread(const Chain& robot);

/// What an earlier calibration tells: parameters are as `mean`, give or take `covariance`. It may
/// tell nothing of base or sensor, where they were moved.
struct Prior {
    Parameters mean;
    bool has_base = true;
    bool has_sensor = true;
    MatrixXd covariance;  ///< of those it tells of, in their order; m and rad, positive definite
};

/// Everything about a measurement campaign that is known before measuring: the robot, the sensor,
/// how large the errors are expected to be. The subject of every question posewise answers.
struct Campaign {
    std::string name;
    Chain robot;
    std::shared_ptr<const Sensor> sensor;
    ParameterSpread spread;
    /// In place of the spread as the prior, where that is one.
    std::optional<Prior> prior;
    /// Standard deviation (m) of what the model cannot express; acts like noise that repeats do
    /// not reduce.
    double model_error = 1e-4;
    /// The same of measured orientations (rad).
    double model_error_orientation = 1e-4;
    KnownWithin known_within{};  ///< for the interval of what is predicted
    /// Standard deviation of each joint about where it was sent (rad or m): one error a
    /// configuration, the same for all its repeats. Empty: none.
    VectorXd joint_repeatability;
    /// Which of base.x .. base.z, base.rx .. base.rz are as stated, so that none is identified.
    std::array<bool, 6> base_is_known{};
    /// Expected base and targets, for planning and simulation; robot errors too, zero at first.
    Parameters nominal;
    /// Whether base and targets in `nominal` were stated, not made up.
    bool has_nominal_base = false;
    bool has_nominal_targets = false;
    /// Poses that the model needs which is fitted in the end, if that is another than the robot
    /// here; 0: this one is.
    Index fitted_pose_count = 0;
    Cell cell;  ///< the place it stands in; empty if nothing is said of one
};

/// Number of identified parameters of the base: 6 less those known.
Index base_parameter_count(const Campaign& campaign);

/// Number of identified parameters: of the base, the robot, the sensor's unknowns.
Index parameter_count(const Campaign& campaign);

/// base.x .. base.z, base.rx .. base.rz, the chain's, the sensor's.
std::vector<std::string> parameter_names(const Campaign& campaign);

/// Whether each parameter is an angle (rad), else a length (m).
std::vector<bool> parameter_is_angle(const Campaign& campaign);

/// Expected error of each parameter (m or rad): the column scale. Throws InputError if `spread`
/// names a parameter the campaign does not have.
VectorXd parameter_scale(const Campaign& campaign);

/// The parameters that have a prior are so many, from this one on: none, the robot's errors, and
/// base and sensor where an earlier calibration tells of them.
Index prior_begin(const Campaign& campaign);
Index prior_count(const Campaign& campaign);

/// What is known before measuring, in scaled parameters (parameter_count() square): 1 for each of
/// the robot's errors if the spread is their prior, the inverse of an earlier calibration's
/// covariance if that is; 0 for what has none. Throws InputError for a prior of other parameters,
/// or a covariance that is not positive definite.
MatrixXd prior_information(const Campaign& campaign);

/// Parameters moved by a small step (parameter_count(), m and rad): the base turns by exp([phi]x)
/// about its own origin in world axes and is translated along world axes; the rest is added.
Parameters advance(const Campaign& campaign, const Parameters& parameters, const VectorXd& step);

/// The step from one to other parameters near it: advance() of which is `to`.
VectorXd step_between(const Campaign& campaign, const Parameters& from, const Parameters& to);
/// How that changes with a further step, d step_between(from, advance(to, s)) / ds at s = 0
/// (parameters square): the identity but for the turn phi of the base so far, where it is
/// I - [phi]x / 2 + (1 / phi^2 - cot(phi / 2) / (2 phi)) [phi]x^2, the inverse left Jacobian of
/// SO(3).
MatrixXd differentiate_step(const Campaign& campaign, const Parameters& from, const Parameters& to);

/// world_from_flange at a configuration.
Isometry3d world_from_flange(const Campaign& campaign, const Parameters& parameters,
                             const VectorXd& configuration);

/// Chain::differentiate() at these parameters; of the base's twists only those of parameters, those
/// by joints only where their repeatability is stated, as its noise needs them.
void differentiate_flange(const Campaign& campaign, const Parameters& parameters,
                          const VectorXd& configuration, FlangeMotion& motion);

/// Chain::differentiate_twice() likewise.
void differentiate_flange_twice(const Campaign& campaign, const Parameters& parameters,
                                const VectorXd& configuration, FlangeMotion& motion,
                                std::vector<FlangeMotionRate>& rates);

/// The same campaign with another robot model (and so other error parameters, at zero).
Campaign with_robot(const Campaign& campaign, Chain robot);

}  // namespace posewise
