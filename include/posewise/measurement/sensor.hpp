#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

class Sensor;

/// Which targets each pose (or each sample) shows: poses x targets, stored like RowMatrixXd.
using Seen = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The targets that one pose shows, a row of Seen.
using SeenTargets = Eigen::Array<bool, 1, Eigen::Dynamic>;

/// Numbers of a camera, which are thousands of pixels, and what has no unit.
inline constexpr AmountUnits pixel_units{"kpx", "px", "px", "", 1e3, 1};
inline constexpr AmountUnits plain_units{"", "", "1e-3", "", 1, 1};

/// Every pose shows every target.
Seen all_seen(Index pose_count, Index target_count);

/// How often each target is observed, `repeats` times or never: poses x targets.
RowMatrixXd times_seen(const Seen& is_seen, double repeats);

/// The targets that a pose shows, from 0, ascending.
std::vector<Index> targets_seen(const SeenTargets& is_seen);

/// A pose that shows the listed targets (from 0) out of `target_count`.
SeenTargets seen_targets(const std::vector<Index>& targets, Index target_count);

/// Rows of an observation that belong to the targets seen, `rows_per_target` each. Ascending.
std::vector<Index> seen_rows(const SeenTargets& is_seen, Index rows_per_target);
/// Rows of a sensor's observation that belong to the targets seen. Ascending.
std::vector<Index> seen_rows(const Sensor& sensor, const SeenTargets& is_seen);
/// How many numbers the targets seen have, in all poses or samples: rows of `is_seen`.
template <typename Derived>
Index seen_row_count(const Sensor& sensor, const Eigen::DenseBase<Derived>& is_seen);

/// Numbers of the targets seen as text, from 1: "1 3".
std::string target_numbers(const SeenTargets& is_seen);

/// Lines of sight, a column for each target: a point of the instrument, then the target's, both in
/// the world, m. Where they are the same nothing hides the target.
using SightLines = Eigen::Matrix<double, 6, Eigen::Dynamic>;

/// Radius of the ball that a laser tracker follows (1.5 inch in diameter), m.
inline constexpr double tracker_ball_radius = 0.01905;

/// Points fixed to the flange. Each coordinate in the flange frame is known, or an unknown of the
/// sensor that observes them; the targets' unknowns come first among the sensor's, or after
/// `unknowns_before`.
class Targets {
  public:
    /// Whole positions, known (m) or not. Throws InputError if there is none or one is not finite.
    explicit Targets(const std::vector<std::optional<Vector3d>>& known_positions,
                     Index unknowns_before = 0);
    /// Positions (m) with only the marked coordinates known; the others are ignored.
    Targets(std::vector<Vector3d> positions, std::vector<std::array<bool, 3>> is_known,
            Index unknowns_before = 0);

    /// The points as centres of balls with this radius, m. Throws InputError if it is negative, not
    /// finite or above 1 m.
    Targets with_radius(double radius) const;
    /// Radius of the balls; nothing: not stated.
    std::optional<double> radius() const { return radius_; }

    Index count() const { return static_cast<Index>(known_.size()); }
    Index unknown_count() const { return unknown_count_; }
    /// Names of the unknown coordinates: "target1.x", ...
    std::vector<std::string> unknown_names() const;

    /// Index of a coordinate among the sensor's unknowns; -1 if it is known.
    Index unknown_index(Index target, Index axis) const {
        return unknown_index_[static_cast<std::size_t>(target)][static_cast<std::size_t>(axis)];
    }
    /// Whether all coordinates of the target are known.
    bool is_known(Index target) const;
    /// Position in the flange frame, m.
    Vector3d position(Index target, const VectorXd& unknowns) const;

    /// Derivative of the world positions by flange motions and unknowns: 3 count() x (twists.cols()
    /// + any number of unknowns, with zero columns after unknown_count()), or without the unknowns'
    /// columns.
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_positions_parameters) const;
    /// Rate of differentiate() while the flange moves by `direction` and the twists change at
    /// `twist_rates`.
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J_rate) const;

  private:
    std::vector<Vector3d> known_;  ///< unknown coordinates hold any finite value
    std::vector<std::array<Index, 3>> unknown_index_;
    Index unknown_count_ = 0;
    std::optional<double> radius_;
};

/// "3 targets (1 known, 2 to be identified)".
std::string describe(const Targets& targets);

/// Velocity of a point that moves with a twist (angular w; velocity v of the point at the origin).
inline Vector3d velocity_of(const Vector3d& point, const Twist& twist) {
    return twist.tail<3>() + twist.head<3>().cross(point);
}

/// A number that determines a sensor's noise; its name ends with its unit. One value, or one per
/// axis.
struct NoiseNumber {
    std::string name;  ///< "sigma_m", "angle_sigma_rad"
    std::vector<double> values;
};

/// Words for a sensor's readings and unknowns in messages.
struct SensorWords {
    std::string readings = "points";
    std::string place = "targets";  ///< what is registered together with the base
    std::string unknowns = "targets in the flange frame";
    std::string key = "sensor.targets.position_mm";  ///< key of `place` in the campaign file
    /// Keys that state what is known of the base and of the sensor's unknowns.
    std::vector<std::string> known{"base.known", "sensor.targets.known"};
    std::string sentence;  ///< "points of 3 targets (0 known, 3 to be identified), sigma 0.05 mm"
};

/// Points fixed to the flange whose world positions follow from an observation. Registration then
/// needs no first guess, because its equations are linear.
struct ObservedPoints {
    /// Equally many points for each target, one target after another, or those of one body that
    /// some of many targets determine together; coordinates may be unknown.
    Targets points;
    /// World positions (m, 3 per point) from an observation of the targets seen; empty if these do
    /// not determine them.
    std::function<VectorXd(const VectorXd& observation, const SeenTargets& is_seen)> positions;
    /// The sensor's unknowns from the points' unknown coordinates.
    std::function<VectorXd(const VectorXd& coordinates)> unknowns;
    /// The points in the flange frame (m, 3 per point) from the sensor's unknowns. Not stated: they
    /// are what is observed where the flange is the world.
    std::function<VectorXd(const VectorXd& unknowns)> in_flange{};
};

struct Measurements;

/// Numbers of an observation, wherever they are stored.
using ConstNumbers = Eigen::Ref<const VectorXd>;

/// What one measurement of a pose returns, how noisy it is, and which unknowns it adds. The only
/// virtual type in the library: a new kind of instrument is a new subclass and nothing else. A
/// subclass must define targets, names, prediction, derivative and covariance; everything else has
/// a default that is right for any sensor. Results for a pose are written into memory of the
/// caller, so that a calibration allocates nothing per pose.
class Sensor {
  public:
    virtual ~Sensor() = default;

    // ---- What a sensor must define ----

    /// The points on the flange that it observes.
    virtual const Targets& targets() const = 0;
    /// Length of one complete observation, in the order of observation_names().
    virtual Index row_count() const = 0;
    /// Column names of an observation without units, e.g. "p1_x".
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

    /// Radius of the ball at each of targets(), m: a body of the robot that must not hit the cell's
    /// obstacles. Nothing: the targets are no bodies, like the tip of a probe that must touch.
    virtual std::optional<double> target_radius() const { return std::nullopt; }

    // ---- Kinds of numbers: lengths by default ----

    /// Whether the number in this row of an observation is an angle (rad, or 1000 px of a sensor
    /// with has_pixels()); else it is a length (m). For each target, lengths come first.
    virtual bool is_angle(Index) const { return false; }
    /// Whether the numbers that count as angles are places in an image, thousands of pixels. What
    /// the model cannot express then reaches them as a motion of the flange alone.
    virtual bool has_pixels() const { return false; }
    /// Whether there is nothing else: a camera alone.
    bool has_only_pixels() const { return has_pixels() && !has_lengths(); }
    /// Units of the lengths in an observation, or of its other numbers.
    const AmountUnits& units(bool of_angles) const {
        return of_angles && has_pixels() ? pixel_units : units_of(of_angles);
    }
    /// Units of the lengths if there are any, else of all numbers.
    const AmountUnits& main_units() const { return units(!has_lengths()); }
    /// Whether there are angles, or lengths, in an observation.
    bool has_angles() const { return count_angles() > 0; }
    bool has_lengths() const { return count_angles() < row_count(); }
    /// Whether the number in this row is a distance, which is positive.
    virtual bool is_distance(Index) const { return false; }
    /// Whether the last three numbers of an observation are the rotation vector of one body.
    virtual bool has_orientation() const { return false; }
    /// Whether each unknown is an angle (rad) or no amount of space; else it is a length (m).
    virtual std::vector<bool> unknown_is_angle() const;
    /// Units of each unknown: of a length or an angle by default.
    virtual std::vector<const AmountUnits*> unknown_units() const;

    /// Standard deviations of the first unknowns about 0, where these are errors of something
    /// stated: their priors, as the sizes of the robot's errors are. Empty: of none.
    virtual VectorXd unknown_sizes() const { return {}; }

    // ---- What is seen or missed as a whole: the targets by default ----

    /// An observation holds row_count() / target_count() numbers for each, one after another; the
    /// errors of two are independent. A multiple of targets().count(); those of one point are
    /// consecutive. Only where is_combined() says so it is otherwise.
    virtual Index target_count() const { return targets().count(); }
    /// Whether several instruments make an observation: CombinedSensor, whose targets have as many
    /// numbers each as their own instrument returns.
    virtual bool is_combined() const { return false; }
    /// The row of an observation where a target's numbers begin; of target_count() their end.
    virtual Index first_row(Index target) const { return target * rows_per_target(); }
    Index rows_of(Index target) const { return first_row(target + 1) - first_row(target); }
    /// The target whose number is in this row.
    virtual Index target_of(Index row) const { return row / rows_per_target(); }
    /// Columns of residuals(), one row a target, lengths first; where targets have different
    /// numbers as many lengths as any has, then as many angles.
    virtual Index rows_per_target() const { return row_count() / target_count(); }
    virtual Index lengths_per_target() const {
        return rows_per_target() - count_angles() / target_count();
    }
    /// The column for the number in this row.
    virtual Index column_of(Index row) const { return row % rows_per_target(); }
    /// Names of the contacts, for a sensor whose poses show only that the robot touches one of
    /// these: all readings are 0, and files have a column of these names instead. Empty: readings
    /// differ.
    virtual std::vector<std::string> contact_names() const { return {}; }
    bool has_contacts() const { return !contact_names().empty(); }
    /// Whether readings are about 0, because a probe is moved to what it measures.
    virtual bool touches() const { return has_contacts(); }
    /// How many targets a pose can show at once.
    Index seen_at_once() const { return has_contacts() ? 1 : target_count(); }
    /// Whether it sees targets only where they face it, so that planning needs clearances.
    virtual bool has_view() const { return false; }
    /// For a sensor with a view: how far each target is from being out of sight, rad or m;
    /// negative: it is. One value a target.
    virtual void view_clearances(const Isometry3d& /*world_from_flange*/,
                                 const VectorXd& /*unknowns*/,
                                 Eigen::Ref<VectorXd> /*clearances*/) const {}
    /// For a sensor with a view: the lines along which it sees its targets; none if nothing in the
    /// cell hides them.
    virtual SightLines sight_lines(const Isometry3d& /*world_from_flange*/,
                                   const VectorXd& /*unknowns*/) const {
        return {};
    }
    /// For a sensor of several parts: makes all clearances of a part negative if these let it show
    /// fewer targets than it needs. view_clearances() has done so; other obstacles may hide more.
    virtual void hide_incomplete_parts(Eigen::Ref<VectorXd> /*clearances*/) const {}
    /// Whether a sensor with a view may read these numbers of a target: inside of an image.
    virtual bool is_readable(Index /*target*/, const ConstNumbers& /*observation*/) const {
        return true;
    }
    /// How many targets a pose must show for a sensor with a view.
    virtual Index least_in_view() const { return 1; }
    /// Index in targets() of the point that a target belongs to.
    virtual Index point_of(Index target) const {
        return target * targets().count() / target_count();
    }
    /// Position of a target's point in the flange frame, m.
    Vector3d target_position(Index target, const VectorXd& unknowns) const {
        return targets().position(point_of(target), unknowns);
    }
    /// How many positions count where accuracy is predicted: one a target, but of pixels and of
    /// several instruments one for each of targets(), since all corners belong to one body.
    Index position_count() const { return counts_points() ? targets().count() : target_count(); }
    /// One of these in the flange frame, m.
    Vector3d counted_position(Index position, const VectorXd& unknowns) const {
        return targets().position(counts_points() ? position : point_of(position), unknowns);
    }
    /// Derivative of the targets' world positions, whatever is measured of them: as
    /// differentiate(), with 3 * target_count() rows in m, or 3 * targets().count() for these.
    void differentiate_positions(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                 const VectorXd& unknowns,
                                 Eigen::Ref<RowMatrixXd> J_positions_parameters) const;

    // ---- Differences of observations: plain, except for orientations and periodic angles ----

    /// Deviation of an observation from another: the step that leads there, row_count() values in m
    /// or rad. `deviation` must be neither of the two.
    virtual void deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                           Eigen::Ref<VectorXd> deviation) const {
        deviation = observation - reference;
    }
    /// The observation with this deviation from `reference`; must be neither of the two.
    virtual void deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                         Eigen::Ref<VectorXd> observation) const {
        observation = reference + deviation;
    }

    // ---- The same with return values, where memory does not matter ----

    VectorXd predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const;
    MatrixXd covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns) const;
    VectorXd deviation(const ConstNumbers& observation, const ConstNumbers& reference) const;
    VectorXd deviate(const ConstNumbers& reference, const ConstNumbers& deviation) const;

    // ---- Rates with the pose: by differences, to about ten digits; override to plan faster ----

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

    // ---- For files, messages and registration ----

    /// What the noise depends on. Default: standard deviations of the observed numbers, with the
    /// flange frame equal to the world and all unknowns 0.
    virtual std::vector<NoiseNumber> noise_numbers() const;
    /// Default: words about numbers and targets.
    virtual SensorWords words() const;
    /// Nothing if an observation does not determine positions by itself; registration then starts
    /// at the campaign's nominal values.
    virtual std::optional<ObservedPoints> observed_points() const { return std::nullopt; }
    /// The same where they also rest on what all configurations show, one sample each (`means`): a
    /// camera's intrinsic parameters.
    virtual std::optional<ObservedPoints> observed_points(const Measurements& /*means*/) const {
        return observed_points();
    }
    /// Whether the unknowns need good initial values, even if the base is known.
    virtual bool needs_first_guess() const { return true; }
    /// Whether the observed points are the targets and nothing else is unknown: a sensor of points.
    bool observes_targets() const;

  private:
    Index count_angles() const;
    bool counts_points() const { return has_pixels() || is_combined(); }
};

template <typename Derived>
Index seen_row_count(const Sensor& sensor, const Eigen::DenseBase<Derived>& is_seen) {
    Index count = 0;
    for (Index j = 0; j < is_seen.cols(); ++j) count += sensor.rows_of(j) * is_seen.col(j).count();
    return count;
}

}  // namespace posewise
