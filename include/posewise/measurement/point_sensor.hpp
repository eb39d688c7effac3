#pragma once

#include <optional>
#include <vector>

#include "posewise/measurement/point_noise.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// An instrument that returns the position of n targets fixed to the flange, in its own frame
/// (laser tracker with SMRs, stereo camera). Each target's position in the flange frame is either
/// known or three unknowns.
class PointSensor final : public Sensor {
  public:
    /// `known_targets[i]` is target i's position in the flange frame (m), or nothing if it is
    /// unknown. Throws InputError if there is no target, one is not finite, or as check_noise().
    PointSensor(std::vector<std::optional<Vector3d>> known_targets, PointNoise noise);
    /// With isotropic noise of standard deviation sigma (m).
    PointSensor(std::vector<std::optional<Vector3d>> known_targets, double sigma);

    const PointNoise& noise() const { return noise_; }
    /// Standard deviation of one coordinate of one observation, m (root mean square over the axes;
    /// a laser tracker's at 3 m).
    double sigma() const { return coordinate_sigma(noise_, 3); }
    bool is_known(Index target) const;
    /// Position of a target in the flange frame, from the known ones or from the unknowns.
    Vector3d target(Index target, const VectorXd& unknowns) const;
    /// Index of a target's x among the unknowns; -1 if it is known.
    Index unknown_offset(Index target) const;

    Index row_count() const override { return 3 * target_count(); }
    Index target_count() const override { return static_cast<Index>(known_targets_.size()); }
    std::vector<std::string> observation_names() const override;
    std::vector<std::string> unknown_names() const override;
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

  private:
    std::vector<std::optional<Vector3d>> known_targets_;
    std::vector<Index> unknown_offset_;  // -1: known
    PointNoise noise_;
};

}  // namespace posewise
