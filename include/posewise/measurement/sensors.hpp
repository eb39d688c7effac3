#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// Isotropic noise: standard deviation of one coordinate, m.
struct IsotropicNoise {
    double sigma = 0;
};

/// Standard deviations along the axes of the instrument, whose frame is that of the observations
/// (the world), m.
struct PerAxisNoise {
    Vector3d sigma = Vector3d::Zero();
};

/// Laser tracker: a point at distance d in direction u has covariance
/// range_sigma^2 u u^T + (angle_sigma d)^2 (I - u u^T).
struct LaserTrackerNoise {
    double range_sigma = 0;  ///< m, along the beam
    double angle_sigma = 0;  ///< rad, for each of the two angles
    /// Start of the beam in the frame of the observations (the world): its origin, unless the
    /// observations were moved to another frame.
    Vector3d position = Vector3d::Zero();
};

/// Noise of one observed point.
using PointNoise = std::variant<IsotropicNoise, PerAxisNoise, LaserTrackerNoise>;

/// Throws InputError if a sigma is not finite or below 1e-15 (m or rad), or a position not finite.
void check_noise(const PointNoise& noise);

/// Covariance of an observed point (m, in the world), m^2. Positive definite: a point less than
/// 1 mm from a tracker counts as 1 mm away.
Matrix3d point_covariance(const PointNoise& noise, const Vector3d& point);

/// Rate of point_covariance() while the point moves with `velocity`.
Matrix3d point_covariance_rate(const PointNoise& noise, const Vector3d& point,
                               const Vector3d& velocity);

/// Standard deviation of one coordinate (root mean square over the axes) at `distance` (m) from the
/// instrument.
double coordinate_sigma(const PointNoise& noise, double distance);

// The built-in instruments; another one is a subclass of Sensor.

/// An instrument that returns the positions of n targets on the flange in its own frame (laser
/// tracker with SMRs, stereo camera).
class PointSensor final : public Sensor {
  public:
    /// Throws InputError as check_noise() does.
    PointSensor(Targets targets, PointNoise noise);
    /// `known_targets[i]` is the position of target i in the flange frame (m), or nothing if it is
    /// unknown. Throws InputError as Targets does.
    PointSensor(const std::vector<std::optional<Vector3d>>& known_targets, PointNoise noise);
    /// With isotropic noise of standard deviation sigma (m).
    PointSensor(const std::vector<std::optional<Vector3d>>& known_targets, double sigma);

    const PointNoise& noise() const { return noise_; }
    /// Standard deviation of one coordinate of one observation, m (root mean square over the axes;
    /// a laser tracker's at 3 m).
    double sigma() const { return coordinate_sigma(noise_, 3); }

    const Targets& targets() const override { return targets_; }
    std::optional<double> target_radius() const override {
        return targets_.radius().value_or(tracker_ball_radius);
    }
    Index row_count() const override { return 3 * targets_.count(); }
    std::vector<std::string> observation_names() const override;
    std::vector<std::string> unknown_names() const override { return targets_.unknown_names(); }
    using Sensor::covariance;
    using Sensor::predict;
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns,
                             Eigen::Ref<RowMatrixXd> J_rate) const override;
    void covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                    Eigen::Ref<MatrixXd> covariance) const override;
    MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                             const VectorXd& unknowns) const override;
    bool has_constant_covariance() const override;
    std::vector<NoiseNumber> noise_numbers() const override;
    SensorWords words() const override;
    std::optional<ObservedPoints> observed_points() const override;

  private:
    Targets targets_;
    PointNoise noise_;
};

/// What an instrument records of a pose, and where its noise arises.
struct PoseRecord {
    /// Files have the instrument's frame in the body's, the inverse of an observation: a board that
    /// a camera on the flange sees.
    bool is_inverse = false;
    /// The noise arises at the body, along its axes: it is the camera. Else at the instrument.
    bool is_made_at_body = false;
};

/// The inverse of each pose, one a row: position and rotation vector.
void invert_poses(RowMatrixXd& poses);

/// An instrument that returns position and orientation of one body on the flange (a tool or a
/// six-degree-of-freedom probe) in its own frame. Observations are x, y, z and the rotation vector;
/// deviations of orientation are rotation vectors in the world. Position and orientation (rotation
/// vector) of the body in the flange frame are known or six unknowns, tool.x to tool.rz.
class PoseSensor final : public Sensor {
  public:
    /// `known_tool` is the body in the flange frame. Throws InputError if it is not finite, if
    /// sigma_orientation (standard deviation of each of the three angles, rad) is not finite or
    /// below 1e-15, for a tracker's noise that arises at the body, or as check_noise() does.
    PoseSensor(std::optional<Isometry3d> known_tool, PointNoise position_noise,
               double sigma_orientation, PoseRecord record = {});

    const PointNoise& noise() const { return noise_; }
    double sigma_orientation() const { return sigma_orientation_; }
    const PoseRecord& record() const { return record_; }
    /// Pose of the body in the flange frame.
    Isometry3d tool(const VectorXd& unknowns) const;

    /// The body's origin.
    const Targets& targets() const override { return origin_; }
    Index row_count() const override { return 6; }
    std::vector<std::string> observation_names() const override;
    bool is_angle(Index row) const override { return row >= 3; }
    bool has_orientation() const override { return true; }
    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;
    using Sensor::covariance;
    using Sensor::deviate;
    using Sensor::deviation;
    using Sensor::predict;
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override;
    void deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                   Eigen::Ref<VectorXd> deviation) const override;
    void deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                 Eigen::Ref<VectorXd> observation) const override;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns,
                             Eigen::Ref<RowMatrixXd> J_rate) const override;
    void covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                    Eigen::Ref<MatrixXd> covariance) const override;
    MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                             const VectorXd& unknowns) const override;
    bool has_constant_covariance() const override;
    std::vector<NoiseNumber> noise_numbers() const override;
    SensorWords words() const override;
    /// Four points of the body: its origin and one on each axis.
    std::optional<ObservedPoints> observed_points() const override;

  private:
    std::optional<Isometry3d> known_tool_;
    Targets origin_;  ///< the body's: a target with the unknowns tool.x to tool.z
    PointNoise noise_;
    double sigma_orientation_;
    PoseRecord record_;
};

/// Whether files have the inverse of what this sensor observes: PoseRecord::is_inverse.
bool records_inverse(const Sensor& sensor);

/// A tool pose as the six unknowns of a PoseSensor.
VectorXd tool_unknowns(const Isometry3d& flange_from_tool);

/// An instrument with features fixed in the world (anchors, planes) that returns one length per
/// target and feature. Each such pair is seen or missed by itself; those of the first target come
/// first. All lengths have the same standard deviation.
class ScalarSensor : public Sensor {
  public:
    double sigma() const { return sigma_; }

    const Targets& targets() const final { return targets_; }
    Index row_count() const final { return targets_.count() * feature_count(); }
    Index target_count() const final { return row_count(); }
    std::vector<std::string> observation_names() const final;
    std::vector<std::string> unknown_names() const final;
    std::vector<bool> unknown_is_angle() const final;
    using Sensor::covariance;
    using Sensor::predict;
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const final;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const final;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J_rate) const final;
    void covariance(const Isometry3d&, const VectorXd&,
                    Eigen::Ref<MatrixXd> covariance) const final;
    bool has_constant_covariance() const final { return true; }
    std::vector<NoiseNumber> noise_numbers() const final { return {{"sigma_m", {sigma_}}}; }
    SensorWords words() const final;

  protected:
    /// Names of the features and of the three values that describe one.
    struct FeatureWords {
        std::string name;                    ///< in unknowns: "anchor", "plane"
        std::string letter;                  ///< in observations: "a", "plane"
        std::array<std::string, 3> values;   ///< "x", "y", "z"
        std::array<bool, 3> value_is_angle;  ///< an angle (rad), else a length (m)
        std::string known_key;               ///< in the campaign file: states that they are known
    };
    /// A length as a function of the target's world position x and of the feature.
    struct Length {
        double value = 0;
        Vector3d gradient;       ///< derivative by x
        Matrix3d gradient_by_x;  ///< derivative of the gradient by x
        Vector3d by_feature;     ///< derivative by the feature's three values
        Matrix3d feature_by_x;   ///< row k: derivative of by_feature[k] by x
    };
    /// `stated[k]` are the values of feature k. Only the marked ones are known; the others are
    /// unknowns and ignored. Throws InputError if there is no feature, if a known value is not
    /// finite, or if sigma (m) is not finite or below 1e-15.
    ScalarSensor(Targets targets, std::vector<Vector3d> stated,
                 const std::vector<std::array<bool, 3>>& is_known, FeatureWords feature_words,
                 double sigma);
    /// The length from the feature with these values to a target at x.
    virtual Length measure(const Vector3d& x, Index feature, const Vector3d& values) const = 0;

    /// The values of a feature: known ones as stated, others from the unknowns.
    Vector3d feature_values(Index feature, const VectorXd& unknowns) const;
    bool is_known(Index feature, Index value) const { return unknown_index(feature, value) < 0; }

  private:
    Index feature_count() const { return static_cast<Index>(stated_.size()); }
    /// Index of a value among the unknowns, after the targets'; -1 if it is known.
    Index unknown_index(Index feature, Index value) const {
        return unknown_index_[static_cast<std::size_t>(feature)][static_cast<std::size_t>(value)];
    }

    Targets targets_;
    std::vector<Vector3d> stated_;
    std::vector<std::array<Index, 3>> unknown_index_;
    FeatureWords feature_words_;
    double sigma_;
};

/// Distances (m) of n targets from anchors fixed in the world (draw-wires, ball-bars). Each
/// anchor's position is known or three unknowns, anchor1.x, ...
class DistanceSensor final : public ScalarSensor {
  public:
    /// `anchors`: positions in the world (m), ignored if unknown. Throws InputError as ScalarSensor
    /// does, or if a known one is not finite.
    DistanceSensor(Targets targets, std::vector<Vector3d> anchors, bool are_known, double sigma);

    bool is_distance(Index) const override { return true; }
    std::optional<double> target_radius() const override {
        return targets().radius().value_or(tracker_ball_radius);
    }

  protected:
    Length measure(const Vector3d& x, Index anchor, const Vector3d& position) const override;
};

/// A plane in the world: the points x with normal . x = offset.
struct Plane {
    Vector3d normal = Vector3d::UnitZ();
    double offset = 0;  ///< m
    /// Which parts are exact as stated; the others are unknown.
    bool normal_is_known = false;
    bool offset_is_known = false;
};

/// Signed distances (m) of n targets from planes fixed in the world, positive on the side the
/// normal points to (a touch probe on ground faces: 0 where it touches). Unknown parts of a plane
/// are parameters: its normal plane1.tilt1 and .tilt2 (rad, a rotation vector from the stated
/// normal about two axes in the plane), its offset plane1.offset (m).
class PlaneSensor final : public ScalarSensor {
  public:
    /// Throws InputError as ScalarSensor does, or if a plane is not finite or a normal zero.
    PlaneSensor(Targets targets, std::vector<Plane> planes, double sigma);

    /// The planes as stated.
    const std::vector<Plane>& planes() const { return planes_; }
    /// A plane with these values of the unknowns.
    Plane plane(Index plane, const VectorXd& unknowns) const;
    bool touches() const override { return true; }

  protected:
    Length measure(const Vector3d& x, Index plane, const Vector3d& tilts_and_offset) const override;

  private:
    std::vector<Plane> planes_;  ///< normals of length 1
};

/// A place fixed in the world that holds a ball.
struct Socket {
    std::string name;
    Vector3d position = Vector3d::Zero();  ///< in the world, m: exact or expected
    /// Known distance of its centre from that of an earlier socket: the other's index (-1: there is
    /// none) and the distance, m.
    Index from = -1;
    double distance = 0;
};

/// No instrument: a ball on the flange, its only target, is put into sockets fixed in the world. A
/// pose shows one socket, and that the ball's centre is where the socket's is: readings are ball
/// minus socket, three lengths each, 0. Sockets are known or have three unknowns each,
/// socket.NAME.x to .z; at a known distance from another one, two: socket.NAME.tilt1 and .tilt2
/// (rad, a rotation vector from the expected direction about two axes across it).
class SocketSensor final : public Sensor {
  public:
    /// Throws InputError if there is no socket, if a name is empty or occurs twice, if there is
    /// more than one target, if sigma (standard deviation of each coordinate, m) is not finite or
    /// below 1e-15, or if a distance is not above 0 or not from an earlier socket at another place.
    SocketSensor(Targets ball, std::vector<Socket> sockets, bool are_known, double sigma);

    double sigma() const { return sigma_; }
    const std::vector<Socket>& sockets() const { return sockets_; }
    Vector3d socket_position(Index socket, const VectorXd& unknowns) const;
    /// Whether the socket's unknowns are two tilts.
    bool has_distance(Index socket) const { return of(socket).from >= 0 && !are_known_; }

    const Targets& targets() const override { return ball_; }
    Index target_count() const override { return static_cast<Index>(sockets_.size()); }
    Index row_count() const override { return 3 * target_count(); }
    std::vector<std::string> contact_names() const override;
    bool needs_first_guess() const override { return are_known_; }
    std::vector<std::string> observation_names() const override;
    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;
    using Sensor::covariance;
    using Sensor::predict;
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns,
                             Eigen::Ref<RowMatrixXd> J_rate) const override;
    void covariance(const Isometry3d&, const VectorXd&,
                    Eigen::Ref<MatrixXd> covariance) const override;
    bool has_constant_covariance() const override { return true; }
    std::vector<NoiseNumber> noise_numbers() const override { return {{"sigma_m", {sigma_}}}; }
    SensorWords words() const override;

  private:
    const Socket& of(Index socket) const { return sockets_[static_cast<std::size_t>(socket)]; }

    Targets ball_;
    std::vector<Socket> sockets_;
    bool are_known_;
    double sigma_;
    std::vector<Index> unknown_index_;  ///< index of each socket's first unknown
};

struct Parameters;

/// One of several instruments that measure together.
struct SensorPart {
    std::shared_ptr<const Sensor> sensor;
    /// Where its frame is in the first one's; nothing: six unknowns. The identity: it is the same.
    std::optional<Isometry3d> known_frame = Isometry3d::Identity();
    /// Whether nominal values of its unknowns are stated, if only roughly, and that of its frame.
    bool has_nominal_unknowns = true;
    bool has_nominal_frame = true;
    /// Another part before it, from 0, which sees by the same camera: another board on the same
    /// side, the flange or the world. What is unknown of the camera is unknown once.
    std::optional<Index> same_camera{};
};

/// Several instruments that see the robot, each as it does alone: a tracker and a camera, or two
/// trackers. An observation holds theirs one after another, each target is seen or missed by
/// itself, their noise is independent. The world is the first one's frame. Unknowns: of all parts
/// those whose sizes are known, then the coordinates of targets, then the others, and where the
/// frame of each further one is in the first one's (position and rotation vector, sensor2.x to
/// sensor2.rz). Names of a part that another one before it has begin with its number: s2_p1_x,
/// sensor2.target1.x. What parts share of one camera has the first one's names.
class CombinedSensor final : public Sensor {
  public:
    /// Throws InputError if there are fewer than two, if one is combined itself or is touched
    /// (has_contacts()), records the inverse of poses, if one sees pixels beside another's angles,
    /// if the first one's known frame is not the identity, or if a part is said to be of a camera
    /// that another part is not.
    explicit CombinedSensor(std::vector<SensorPart> parts);

    Index part_count() const { return static_cast<Index>(parts_.size()); }
    const SensorPart& part(Index part) const { return of(part).stated; }
    /// The part that observes a target, and its first target.
    Index part_of(Index target) const;
    Index first_target(Index part) const { return of(part).first_target; }
    Index first_row_of(Index part) const { return of(part).first_row; }
    /// Whether all that is unknown of a part, if anything, is of a camera that it shares.
    bool has_only_shared_unknowns(Index part) const;
    /// The unknowns of one part, from all.
    VectorXd unknowns_of(Index part, const VectorXd& unknowns) const;
    /// What a part alone has of all parameters: the base in its own frame, its unknowns.
    Parameters parameters_of(Index part, const Parameters& all) const;
    /// All unknowns from those of each part and where its frame is in the first one's.
    VectorXd unknowns(const std::vector<VectorXd>& of_parts,
                      const std::vector<Isometry3d>& frames) const;
    /// Where a part's frame is in the first one's.
    Isometry3d frame(Index part, const VectorXd& unknowns) const;

    const Targets& targets() const override { return targets_; }
    std::optional<double> target_radius() const override;
    Index row_count() const override { return row_count_; }
    Index target_count() const override { return static_cast<Index>(first_rows_.size()) - 1; }
    bool is_combined() const override { return true; }
    Index first_row(Index target) const override {
        return first_rows_[static_cast<std::size_t>(target)];
    }
    Index target_of(Index row) const override;
    Index rows_per_target() const override { return lengths_ + angles_; }
    Index lengths_per_target() const override { return lengths_; }
    Index column_of(Index row) const override;
    Index point_of(Index target) const override;
    bool is_angle(Index row) const override;
    bool is_distance(Index row) const override;
    bool has_pixels() const override;
    std::vector<std::string> observation_names() const override;
    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;
    std::vector<const AmountUnits*> unknown_units() const override;
    VectorXd unknown_sizes() const override;
    using Sensor::covariance;
    using Sensor::deviate;
    using Sensor::deviation;
    using Sensor::predict;
    void predict(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                 Eigen::Ref<VectorXd> observation) const override;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns,
                             Eigen::Ref<RowMatrixXd> J_rate) const override;
    void covariance(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                    Eigen::Ref<MatrixXd> covariance) const override;
    MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                             const VectorXd& unknowns) const override;
    bool has_constant_covariance() const override;
    void deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                   Eigen::Ref<VectorXd> deviation) const override;
    void deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                 Eigen::Ref<VectorXd> observation) const override;
    bool has_view() const override;
    bool is_readable(Index target, const ConstNumbers& observation) const override;
    /// A part that shows fewer than the least it needs shows none.
    void view_clearances(const Isometry3d& world_from_flange, const VectorXd& unknowns,
                         Eigen::Ref<VectorXd> clearances) const override;
    SightLines sight_lines(const Isometry3d& world_from_flange,
                           const VectorXd& unknowns) const override;
    void hide_incomplete_parts(Eigen::Ref<VectorXd> clearances) const override;
    /// One at least of the parts with a view must see what it needs: the least that any needs.
    Index least_in_view() const override;
    bool needs_first_guess() const override;
    std::vector<NoiseNumber> noise_numbers() const override;
    SensorWords words() const override;

  private:
    struct Part {
        SensorPart stated;
        Index first_row = 0;
        Index first_target = 0;
        Index first_point = 0;
        Index lengths = 0;              ///< a target
        std::vector<Index> unknowns{};  ///< index of each among all
        std::vector<bool> is_shared{};  ///< whether each is that of a part before
        Index frame = -1;               ///< of the first of six; -1: it is known
        bool has_own_rows = true;       ///< their names are no other part's
        bool has_own_unknowns = true;
        const Sensor& sensor() const { return *stated.sensor; }
    };
    const Part& of(Index part) const { return parts_[static_cast<std::size_t>(part)]; }
    const Part& of_row(Index row) const;
    /// Twists by the frame's unknowns in the frame of a part: six, or none if it is known.
    TwistMatrix frame_twists(const Part& part, const VectorXd& unknowns) const;
    /// Of a part's derivative its rows and columns among all.
    void take_in(const Part& part, const RowMatrixXd& J, Index twists,
                 Eigen::Ref<RowMatrixXd> J_all) const;
    Isometry3d frame_of(const Part& part, const VectorXd& unknowns) const;
    Isometry3d part_from_first(const Part& part, const VectorXd& unknowns) const {
        return frame_of(part, unknowns).inverse();
    }
    /// Twists of the first one's frame as a part has them, and if they are asked for, those by its
    /// unknown frame behind them.
    TwistMatrix part_twists(const Part& part, const Isometry3d& part_from_first,
                            const TwistMatrix& twists, bool has_unknowns,
                            const VectorXd& unknowns) const;

    std::vector<Part> parts_;
    Targets targets_;
    std::vector<Index> first_rows_;  ///< of each target, and the end
    Index row_count_ = 0;
    Index unknown_count_ = 0;
    Index lengths_ = 0;  ///< the most a target has
    Index angles_ = 0;
};

}  // namespace posewise
