#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/measurement/targets.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

/// A number that a sensor's noise depends on, by a name that ends with its unit: one value or one
/// an axis.
struct NoiseNumber {
    std::string name;  ///< "sigma_m", "angle_sigma_rad"
    std::vector<double> values;
};

/// What messages call a sensor's readings and unknowns.
struct SensorWords {
    std::string readings = "points";
    std::string place = "targets";  ///< what is registered with the base
    std::string unknowns = "targets in the flange frame";
    std::string key = "sensor.targets.position_mm";  ///< of the campaign file, places `place`
    /// Keys that say what is known of the base and of the sensor's unknowns.
    std::vector<std::string> known{"base.known", "sensor.targets.known"};
    std::string sentence;  ///< "points of 3 targets (0 known, 3 to be identified), sigma 0.05 mm"
};

/// Points fixed to the flange whose positions in the world an observation tells. A registration
/// then needs no first guess: its equations are linear.
struct ObservedPoints {
    /// As many of each target, one after another; their coordinates are known or not.
    Targets points;
    /// Positions in the world (m, 3 a point) as an observation tells them.
    std::function<VectorXd(const VectorXd& observation)> positions;
    /// The sensor's unknowns, from the unknown coordinates of the points.
    std::function<VectorXd(const VectorXd& coordinates)> unknowns;
};

/// Numbers of an observation, wherever they stand.
using ConstNumbers = Eigen::Ref<const VectorXd>;

/// What one measurement of a pose returns, how noisy it is, and which unknowns of its own it
/// brings. The only virtual type of the library: a new kind of instrument is a new subclass and
/// nothing else. It must say what it looks at and returns (targets, names, prediction, derivative,
/// covariance); everything else has a default that is right for any sensor. What is asked of it for
/// each pose it writes to where the caller has room, so that a calibration takes no memory a pose.
class Sensor {
  public:
    virtual ~Sensor() = default;

    // ---- What a sensor must say ----

    /// The points on the flange that it looks at. Their unknown coordinates come first among the
    /// sensor's unknowns.
    virtual const Targets& targets() const = 0;
    /// Numbers one complete observation has, in the order of observation_names().
    virtual Index row_count() const = 0;
    /// Column names of an observation without unit, e.g. "p1_x".
    virtual std::vector<std::string> observation_names() const = 0;
    /// Names of the sensor's own unknowns, e.g. "target1.x".
    virtual std::vector<std::string> unknown_names() const = 0;

    /// The observation expected without noise, row_count() values in m or rad.
    virtual void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                         Eigen::Ref<VectorXd> observation) const = 0;
    /// Derivative of predict() by flange motions and by the sensor's own unknowns:
    /// row_count() x (twists.cols() + unknowns), or without the unknowns' columns. With the
    /// twists of a FlangeMotion this is the identification Jacobian of one pose.
    virtual void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                               const VectorXd& unknowns,
                               Eigen::Ref<RowMatrixXd> J_measured_parameters) const = 0;
    /// Covariance of the noise of one observation at this pose: row_count() square, m^2 (rad^2).
    virtual void covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                            Eigen::Ref<MatrixXd> covariance) const = 0;

    /// Radius of the ball about each of targets(), m: a body of the robot, which keeps off what
    /// stands in its cell. Nothing: they are no bodies, as the tip of a probe that is to touch.
    virtual std::optional<double> target_radius() const { return std::nullopt; }

    // ---- What kinds of numbers these are: lengths, unless it says otherwise ----

    /// Whether the number in this row of an observation is an angle (rad), else a length (m). Of
    /// each target lengths come first.
    virtual bool is_angle(Index) const { return false; }
    /// Whether there is an angle among them, and a length.
    bool has_angles() const { return count_angles() > 0; }
    bool has_lengths() const { return count_angles() < row_count(); }
    /// Whether it is a distance, which is above 0.
    virtual bool is_distance(Index) const { return false; }
    /// Whether the last three numbers of an observation are the rotation vector of one body.
    virtual bool has_orientation() const { return false; }
    /// Whether each unknown is an angle (rad), else a length (m).
    virtual std::vector<bool> unknown_is_angle() const;

    // ---- What is seen or missed as a whole: the targets, unless it says otherwise ----

    /// An observation holds row_count() / target_count() numbers of each, one after another, and
    /// the errors of two are independent. A multiple of targets().count(), those of a point
    /// follow each other.
    virtual Index target_count() const { return targets().count(); }
    Index rows_per_target() const { return row_count() / target_count(); }
    Index lengths_per_target() const { return rows_per_target() - count_angles() / target_count(); }
    /// What the robot touches, if each pose shows one of these and no other, and that it is there:
    /// all readings are 0, and files have a column of these names instead. Empty: readings differ.
    virtual std::vector<std::string> contact_names() const { return {}; }
    bool has_contacts() const { return !contact_names().empty(); }
    /// Whether its readings are those of a probe that is brought to what it measures: about 0.
    virtual bool touches() const { return has_contacts(); }
    /// How many a pose can show at once.
    Index seen_at_once() const { return has_contacts() ? 1 : target_count(); }
    /// Which of targets() it belongs to.
    Index point_of(Index target) const { return target * targets().count() / target_count(); }
    /// Where the point of each target is in the flange frame, m.
    Vector3d target_position(Index target, const VectorXd& unknowns) const {
        return targets().position(point_of(target), unknowns);
    }
    /// Derivative of the targets' positions in the world, whatever of them is measured: as
    /// differentiate(), 3 * target_count() rows in m.
    void differentiate_positions(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_positions_parameters) const;

    // ---- How observations differ: as numbers do, unless they are orientations, or angles that
    //      go round ----

    /// By how much an observation deviates from another: the step that leads there, row_count()
    /// values in m or rad. `deviation` is neither of the two.
    virtual void deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                           Eigen::Ref<VectorXd> deviation) const {
        deviation = observation - reference;
    }
    /// The observation with this deviation from `reference`; neither of the two.
    virtual void deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                         Eigen::Ref<VectorXd> observation) const {
        observation = reference + deviation;
    }

    // ---- The same as values of their own, where memory does not matter ----

    VectorXd predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const;
    MatrixXd covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns) const;
    VectorXd deviation(const ConstNumbers& observation, const ConstNumbers& reference) const;
    VectorXd deviate(const ConstNumbers& reference, const ConstNumbers& deviation) const;

    // ---- How derivative and covariance change with the pose: by differences, exact to about ten
    //      digits; a sensor that says it itself is quicker to plan for ----

    /// Rate of differentiate() while the flange moves by `direction` and the twists change at
    /// `twist_rates` (6 x twists.cols()); same shape.
    virtual void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                     const Twist& direction, const TwistMatrix& twist_rates,
                                     const VectorXd& unknowns,
                                     Eigen::Ref<RowMatrixXd> J_rate) const;
    /// Rate of covariance() while the flange moves by `direction`.
    virtual MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                     const VectorXd& unknowns) const;
    /// Whether covariance() is the same at every pose, so that its rate is zero.
    virtual bool has_constant_covariance() const { return false; }

    // ---- What files, messages and registration ask ----

    /// What its noise depends on. By default the standard deviations of the numbers observed, with
    /// flange and world in one and all unknowns 0.
    virtual std::vector<NoiseNumber> noise_numbers() const;
    /// By default in terms of numbers and targets.
    virtual SensorWords words() const;
    /// Nothing, if an observation does not tell positions by itself: registration then begins at
    /// the campaign's nominal values.
    virtual std::optional<ObservedPoints> observed_points() const { return std::nullopt; }
    /// Whether its unknowns are not found from whatever values they begin at, even where the base
    /// is known.
    virtual bool needs_first_guess() const { return true; }
    /// Whether those are the targets, and nothing else is unknown: a sensor of points.
    bool observes_targets() const;

  private:
    Index count_angles() const;
};

}  // namespace posewise
