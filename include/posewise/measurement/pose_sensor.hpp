#pragma once

#include <optional>

#include "posewise/measurement/point_noise.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// An instrument that returns position and orientation of one body fixed to the flange (a tool or
/// a six-degree-of-freedom probe) in its own frame. Observations are x, y, z and the rotation
/// vector; deviations of orientation are rotation vectors in the world. The body's position and its
/// orientation (rotation vector) in the flange frame are six unknowns, tool.x to tool.rz, or known.
class PoseSensor final : public Sensor {
  public:
    /// `known_tool` is the body in the flange frame. Throws InputError if it is not finite, if
    /// sigma_orientation (standard deviation of each of the three angles, rad) is not finite or
    /// below 1e-15, or as check_noise() does.
    PoseSensor(std::optional<Isometry3d> known_tool, PointNoise position_noise,
               double sigma_orientation);

    const PointNoise& noise() const { return noise_; }
    double sigma_orientation() const { return sigma_orientation_; }
    /// The body in the flange frame.
    Isometry3d tool(const VectorXd& unknowns) const;

    /// The origin of the body.
    const Targets& targets() const override { return origin_; }
    Index row_count() const override { return 6; }
    std::vector<std::string> observation_names() const override;
    bool is_angle(Index row) const override { return row >= 3; }
    bool has_orientation() const override { return true; }
    std::vector<std::string> unknown_names() const override;
    std::vector<bool> unknown_is_angle() const override;
    VectorXd predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const override;
    VectorXd deviation(const VectorXd& observation, const VectorXd& reference) const override;
    VectorXd deviate(const VectorXd& reference, const VectorXd& deviation) const override;
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd& unknowns,
                       Eigen::Ref<RowMatrixXd> J_measured_parameters) const override;
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd& unknowns,
                             Eigen::Ref<RowMatrixXd> J_rate) const override;
    MatrixXd covariance(const Isometry3d& world_from_flange,
                        const VectorXd& unknowns) const override;
    MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                             const VectorXd& unknowns) const override;
    bool has_constant_covariance() const override;
    std::vector<NoiseNumber> noise_numbers() const override;
    SensorWords words() const override;
    /// Four points of the body: its origin and one on each axis.
    std::optional<ObservedPoints> observed_points() const override;

  private:
    std::optional<Isometry3d> known_tool_;
    Targets origin_;  ///< of the body: a target whose unknowns are tool.x to tool.z
    PointNoise noise_;
    double sigma_orientation_;
};

/// A tool as the six unknowns of a PoseSensor.
VectorXd tool_unknowns(const Isometry3d& flange_from_tool);

}  // namespace posewise
