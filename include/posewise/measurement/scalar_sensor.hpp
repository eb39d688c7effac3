#pragma once

#include <vector>

#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// An instrument with features fixed in the world (anchors, planes), that returns one length of a
/// target at a feature. What is seen or missed is such a pair: those of the first target come
/// first. Every length has the same standard deviation.
class ScalarSensor : public Sensor {
  public:
    double sigma() const { return sigma_; }

    const Targets& targets() const final { return targets_; }
    Index row_count() const final { return targets_.count() * feature_count_; }
    Index target_count() const final { return row_count(); }
    std::vector<std::string> observation_names() const final;
    VectorXd predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const final;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const final;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns, Eigen::Ref<RowMatrixXd> J_rate) const final;
    MatrixXd covariance(const Isometry3d&, const VectorXd&) const final;
    bool has_constant_covariance() const final { return true; }
    std::vector<NoiseNumber> noise_numbers() const final { return {{"sigma_m", {sigma_}}}; }
    SensorWords words() const final;

  protected:
    /// A length as a function of the target's position x in the world and of the feature.
    struct Length {
        double value = 0;
        Vector3d gradient;       ///< by x
        Matrix3d gradient_by_x;  ///< derivative of the gradient by x
        Vector3d by_feature;     ///< by the feature's three unknowns
        Matrix3d feature_by_x;   ///< row k: derivative of by_feature[k] by x
    };
    /// Throws InputError if there is no feature, or sigma (m) is not finite or below 1e-15.
    ScalarSensor(Targets targets, Index feature_count, bool are_known, std::string letter,
                 double sigma);
    /// "anchors", "planes".
    virtual std::string features() const = 0;
    virtual Length measure(const Vector3d& x, Index feature, const VectorXd& unknowns) const = 0;

    Index feature_count() const { return feature_count_; }
    bool are_known() const { return are_known_; }
    /// Index of a feature's first unknown; they follow the targets'.
    Index unknown_index(Index feature) const { return targets_.unknown_count() + 3 * feature; }

  private:
    Targets targets_;
    Index feature_count_;
    bool are_known_;
    std::string letter_;  ///< of a feature in observation names
    double sigma_;
};

/// Distances of n targets from anchors fixed in the world (draw-wires, ball-bars), m. Anchors'
/// positions are known or three unknowns each, anchor1.x, ...
class DistanceSensor final : public ScalarSensor {
  public:
    /// `anchors`: positions in the world (m), not looked at if unknown. Throws InputError as
    /// ScalarSensor does, or if one that is known is not finite.
    DistanceSensor(Targets targets, std::vector<Vector3d> anchors, bool are_known, double sigma);

    bool is_distance(Index) const override { return true; }
    std::vector<std::string> unknown_names() const override;

  protected:
    std::string features() const override { return "anchors"; }
    Length measure(const Vector3d& x, Index anchor, const VectorXd& unknowns) const override;

  private:
    std::vector<Vector3d> anchors_;
};

/// A plane in the world: the points x with normal . x = offset.
struct Plane {
    Vector3d normal = Vector3d::UnitZ();
    double offset = 0;  ///< m
};

/// Signed distances of n targets from planes fixed in the world (a touch probe on ground faces:
/// 0 where it touches), m, positive on the side the normal points to. Planes are known, or have
/// three unknowns each: plane1.tilt1 and .tilt2 (rad, from the stated normal, about two axes in
/// the plane; a rotation vector) and plane1.offset (m).
class PlaneSensor final : public ScalarSensor {
  public:
    /// Throws InputError as ScalarSensor does, or if a plane is not finite or a normal zero.
    PlaneSensor(Targets targets, std::vector<Plane> planes, bool are_known, double sigma);

    const std::vector<Plane>& planes() const { return planes_; }

    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;

  protected:
    std::string features() const override { return "planes"; }
    Length measure(const Vector3d& x, Index plane, const VectorXd& unknowns) const override;

  private:
    std::vector<Plane> planes_;  ///< normals of length 1
};

}  // namespace posewise
