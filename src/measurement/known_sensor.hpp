#pragma once

#include <memory>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise::detail {

/// A sensor whose unknowns are known: another one with these values of them.
class KnownSensor final : public Sensor {
  public:
    KnownSensor(std::shared_ptr<const Sensor> sensor, VectorXd unknowns);

    /// The sensor whose unknowns these are.
    const Sensor& original() const { return *sensor_; }

    const Targets& targets() const override { return targets_; }
    Index row_count() const override { return sensor_->row_count(); }
    std::vector<std::string> observation_names() const override {
        return sensor_->observation_names();
    }
    std::vector<std::string> unknown_names() const override { return {}; }
    void predict(const Isometry3d& world_from_flange, const VectorXd&,
                 Eigen::Ref<VectorXd> observation) const override {
        sensor_->predict(world_from_flange, unknowns_, observation);
    }
    void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                       const VectorXd&, Eigen::Ref<RowMatrixXd> J) const override {
        sensor_->differentiate(world_from_flange, twists, unknowns_, J);
    }
    void covariance(const Isometry3d& world_from_flange, const VectorXd&,
                    Eigen::Ref<MatrixXd> covariance) const override {
        sensor_->covariance(world_from_flange, unknowns_, covariance);
    }

    bool is_angle(Index row) const override { return sensor_->is_angle(row); }
    bool has_pixels() const override { return sensor_->has_pixels(); }
    bool has_view() const override { return sensor_->has_view(); }
    void view_clearances(const Isometry3d& world_from_flange, const VectorXd&,
                         Eigen::Ref<VectorXd> clearances) const override {
        sensor_->view_clearances(world_from_flange, unknowns_, clearances);
    }
    SightLines sight_lines(const Isometry3d& world_from_flange, const VectorXd&) const override {
        return sensor_->sight_lines(world_from_flange, unknowns_);
    }
    void hide_incomplete_parts(Eigen::Ref<VectorXd> clearances) const override {
        sensor_->hide_incomplete_parts(clearances);
    }
    Index least_in_view() const override { return sensor_->least_in_view(); }
    bool is_distance(Index row) const override { return sensor_->is_distance(row); }
    bool has_orientation() const override { return sensor_->has_orientation(); }
    Index target_count() const override { return sensor_->target_count(); }
    std::vector<std::string> contact_names() const override { return sensor_->contact_names(); }
    void deviation(const ConstNumbers& observation, const ConstNumbers& reference,
                   Eigen::Ref<VectorXd> deviation) const override {
        sensor_->deviation(observation, reference, deviation);
    }
    void deviate(const ConstNumbers& reference, const ConstNumbers& deviation,
                 Eigen::Ref<VectorXd> observation) const override {
        sensor_->deviate(reference, deviation, observation);
    }
    void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                             const Twist& direction, const TwistMatrix& twist_rates,
                             const VectorXd&, Eigen::Ref<RowMatrixXd> J_rate) const override {
        sensor_->differentiate_along(world_from_flange, twists, direction, twist_rates, unknowns_,
                                     J_rate);
    }
    MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                             const VectorXd&) const override {
        return sensor_->covariance_rate(world_from_flange, direction, unknowns_);
    }
    bool has_constant_covariance() const override { return sensor_->has_constant_covariance(); }
    std::vector<NoiseNumber> noise_numbers() const override { return sensor_->noise_numbers(); }
    SensorWords words() const override;
    using Sensor::observed_points;
    std::optional<ObservedPoints> observed_points() const override;

  private:
    std::shared_ptr<const Sensor> sensor_;
    VectorXd unknowns_;
    Targets targets_;
};

/// The campaign with these values of the sensor's unknowns, if it has some, known.
Campaign with_known_sensor(Campaign campaign, const VectorXd& unknowns);

}  // namespace posewise::detail
