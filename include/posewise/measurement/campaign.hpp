#pragma once

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/sensor.hpp"
#include "posewise/model/cell.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

/// Values of everything that a calibration identifies. As a vector (names: parameter_names()) the
/// order is base (6, less the known ones), robot, sensor; advance() defines the values of the base.
struct Parameters {
    Isometry3d world_from_base = Isometry3d::Identity();
    VectorXd robot;   ///< the chain's error parameters, m or rad; zero is nominal
    VectorXd sensor;  ///< the sensor's unknowns (targets in the flange frame), m
};

/// Expected size of each parameter's error: the scale of its column and, where priors are used, its
/// prior standard deviation. Metres and radians.
struct ParameterSpread {
    double length = 1e-3;
    double angle = 1e-3;
    std::map<std::string, double> by_name;  ///< exceptions, by parameter name
    bool is_prior = false;      ///< whether it is also the prior standard deviation of robot errors
    double gravity = 1e-3;      ///< for terms of TermKind::Gravity and TermKind::Torque
    double harmonic = 0.15e-3;  ///< for terms of TermKind::Harmonic, of joints that turn
    /// The same of slides, m: of the screw, which has nothing to do with gears.
    double slide_harmonic = 8e-6;
    double tilt = 0.05e-3;              ///< for terms of TermKind::Tilt
    double gain = 0.2e-3;               ///< for terms of TermKind::Gain, m/m and rad/rad
    std::optional<double> offset = {};  ///< for revolute joints; nothing: like other angles
    /// Whether the sizes of a prior are only expected: a calibration learns the robot's own, which
    /// are these within a factor of error_size_factor. Those of `by_name` are kept.
    bool is_open = true;
};

/// Model errors differ between robots: one standard deviation is this factor.
inline constexpr double model_error_factor = 2.5;
/// Measured: 0.84 to 0.93 on five campaigns with several targets.
inline constexpr double usual_model_error_common = 0.9;
/// Sizes of the errors that are parameters differ, too: one standard deviation is this factor.
inline constexpr double error_size_factor = 2;

/// How well these are known before measuring: one standard deviation is this factor. The defaults
/// are for robots nobody has measured; an earlier estimate may state others.
struct KnownWithin {
    double model_error = model_error_factor;
    double error_size = error_size_factor;
};

/// The expected size of this robot error by its kind; `by_name` may state another.
double& size_of(ParameterSpread& spread, const Chain& robot, Index parameter);

/// The expected size of each error of the robot, m or rad.
VectorXd robot_error_sizes(const ParameterSpread& spread, const Chain& robot);

/// A size that several errors of a robot share.
struct SharedSize {
    std::string key;  ///< under `spread` in a campaign file, without unit: "offset"
    double size = 0;  ///< m or rad
    bool is_angle = false;
    std::vector<Index> members;  ///< parameters of the robot
};

/// Sizes shared by the robot's errors, except those that `by_name` states.
std::vector<SharedSize> shared_sizes(const ParameterSpread& spread, const Chain& robot);

/// Typical sizes of the errors of robots this large, as priors for ErrorModel::Full.
ParameterSpread population_spread(const Chain& robot);

/// Result of an earlier calibration: the parameters are `mean` with uncertainty `covariance`. It
/// does not cover base or sensor if they have moved since.
struct Prior {
    Parameters mean;
    bool has_base = true;
    bool has_sensor = true;
    MatrixXd covariance;  ///< for the parameters it covers (m and rad), positive definite
};

/// Everything known about a measurement campaign before measuring: the robot, the sensor, the
/// expected size of the errors. The subject of every question posewise answers.
struct Campaign {
    std::string name;
    Chain robot;
    std::shared_ptr<const Sensor> sensor;
    ParameterSpread spread;
    /// Replaces the spread as the prior, where the spread is one.
    std::optional<Prior> prior;
    /// Standard deviation of what the model cannot express, which repeats do not reduce: of lengths
    /// (m) and angles (rad).
    double model_error = 1e-4;
    double model_error_orientation = 1e-4;
    /// How much of the model error's variance (of lengths) the targets of a configuration share.
    /// That part moves the flange: half of it is a translation, half a rotation about the middle of
    /// the targets. Each number has the rest by itself. A sensor that shows one target or body
    /// shares nothing. Not stated: usual_model_error_common where sizes are priors, else 0.
    std::optional<double> model_error_common{};
    KnownWithin known_within{};  ///< for the intervals of predictions
    /// Standard deviation of each joint about its commanded value (rad or m): one error per
    /// configuration, shared by all its repeats. Empty: none.
    VectorXd joint_repeatability;
    /// Which of base.x .. base.z, base.rx .. base.rz are exact as stated; these are not identified.
    std::array<bool, 6> base_is_known{};
    /// Expected base and targets, for planning and simulation; also the robot errors, initially
    /// zero.
    Parameters nominal;
    /// Whether base and targets in `nominal` were stated; else they are made up.
    bool has_nominal_base = false;
    bool has_nominal_targets = false;
    /// Poses needed by the model that is fitted in the end, if that is not the robot here; 0: it
    /// is.
    Index fitted_pose_count = 0;
    Cell cell;                           ///< the robot's surroundings; empty if nothing is stated
    Criterion criterion = Criterion::V;  ///< for choices from measured or listed configurations
    std::uint64_t seed = 1;              ///< for all draws
};

/// Number of identified base parameters: 6 less the known ones.
Index base_parameter_count(const Campaign& campaign);

/// Number of identified parameters: base, robot and sensor unknowns.
Index parameter_count(const Campaign& campaign);

/// base.x .. base.z, base.rx .. base.rz, then the chain's names, then the sensor's.
std::vector<std::string> parameter_names(const Campaign& campaign);

/// Whether each parameter is an angle (rad); else it is a length (m).
std::vector<bool> parameter_is_angle(const Campaign& campaign);

/// Units of each parameter: those of a length or an angle, but for some unknowns of sensors.
std::vector<const AmountUnits*> parameter_units(const Campaign& campaign);

/// Expected error of each parameter (m or rad): the column scale. Throws InputError if `spread`
/// names a parameter the campaign does not have.
VectorXd parameter_scale(const Campaign& campaign);

/// Parameters [begin, begin + count) have a prior: the robot's errors where their spread is one,
/// the sensor's unknowns whose sizes are known, also base and all of the sensor where an earlier
/// calibration covers them.
Index prior_begin(const Campaign& campaign);
Index prior_count(const Campaign& campaign);

/// Prior information in scaled parameters, parameter_count() square: 1 for each robot error if the
/// spread is the prior and for the sensor's unknowns of known size, the inverse covariance of an
/// earlier calibration if that is; 0 for parameters without prior. Throws InputError for a prior of
/// other parameters, or a covariance that is not positive definite.
MatrixXd prior_information(const Campaign& campaign);

/// Parameters after a small step (parameter_count(), m and rad): the base turns by exp([phi]x)
/// about its own origin in world axes and translates along world axes; the rest is added.
Parameters advance(const Campaign& campaign, const Parameters& parameters, const VectorXd& step);

/// The step between nearby parameters, inverse of advance(): advance(campaign, from, step) is `to`.
VectorXd step_between(const Campaign& campaign, const Parameters& from, const Parameters& to);
/// Derivative of that step by a further one, d step_between(from, advance(to, s)) / ds at s = 0
/// (parameters square). It is the identity except for the base's rotation phi so far, where it is
/// I - [phi]x / 2 + (1 / phi^2 - cot(phi / 2) / (2 phi)) [phi]x^2, the inverse left Jacobian of
/// SO(3).
MatrixXd differentiate_step(const Campaign& campaign, const Parameters& from, const Parameters& to);

/// world_from_flange at a configuration.
Isometry3d world_from_flange(const Campaign& campaign, const Parameters& parameters,
                             const VectorXd& configuration);

/// Chain::differentiate() at these parameters. Only the identified base twists are kept. Twists by
/// joints are computed only if joint_repeatability is stated; its noise needs them.
void differentiate_flange(const Campaign& campaign, const Parameters& parameters,
                          const VectorXd& configuration, FlangeMotion& motion);

/// Chain::differentiate_twice() at these parameters, with the same base twists.
void differentiate_flange_twice(const Campaign& campaign, const Parameters& parameters,
                                const VectorXd& configuration, FlangeMotion& motion,
                                std::vector<FlangeMotionRate>& rates);

/// The campaign with another robot model, hence other error parameters (at zero) and no earlier
/// prior.
Campaign with_robot(const Campaign& campaign, Chain robot);

/// Kinds of robots that are built alike and so have errors of similar sizes.
enum class RobotClass {
    Unknown,        ///< any robot
    Small,          ///< stiff arms for assembly: reach below 1 m
    Industrial,     ///< heavier arms on the floor
    Collaborative,  ///< light arms with elastic gears
    Service,        ///< coarse arms: mobile manipulators, humanoids, low-cost arms
};

/// "unknown", "small", "industrial", "collaborative" or "service", as in files under `class`.
std::string_view robot_class_name(RobotClass kind);
/// Throws InputError for any other name.
RobotClass parse_robot_class(const std::string& name);

/// What is expected of robots of a class of which none was measured.
struct Population {
    ParameterSpread spread;              ///< sizes of the errors of ErrorModel::Full, as priors
    double model_error = 0;              ///< of that model, m a coordinate
    double model_error_orientation = 0;  ///< rad
    KnownWithin within{};
};

/// `robot` gives the size that lengths are in proportion to.
Population population_of(RobotClass kind, const Chain& robot);

}  // namespace posewise
