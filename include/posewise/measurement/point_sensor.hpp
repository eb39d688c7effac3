#pragma once

#include <optional>
#include <vector>

#include "posewise/measurement/point_noise.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// An instrument that returns the position of n targets fixed to the flange, in its own frame
/// (laser tracker with SMRs, stereo camera).
class PointSensor final : public Sensor {
  public:
    /// Throws InputError as check_noise() does.
    PointSensor(Targets targets, PointNoise noise);
    /// `known_targets[i]` is target i's position in the flange frame (m), or nothing if it is
    /// unknown. Throws InputError as Targets does.
    PointSensor(const std::vector<std::optional<Vector3d>>& known_targets, PointNoise noise);
    /// With isotropic noise of standard deviation sigma (m).
    PointSensor(const std::vector<std::optional<Vector3d>>& known_targets, double sigma);

    const PointNoise& noise() const { return noise_; }
    /// Standard deviation of one coordinate of one observation, m (root mean square over the axes;
    /// a laser tracker's at 3 m).
    double sigma() const { return coordinate_sigma(noise_, 3); }

    const Targets& targets() const override { return targets_; }
    Index row_count() const override { return 3 * targets_.count(); }
    std::vector<std::string> observation_names() const override;
    std::vector<std::string> unknown_names() const override { return targets_.unknown_names(); }
    VectorXd predict(const Isometry3d& world_from_flange, const VectorXd& unknowns) const override;
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
    std::optional<ObservedPoints> observed_points() const override;

  private:
    Targets targets_;
    PointNoise noise_;
};

}  // namespace posewise
