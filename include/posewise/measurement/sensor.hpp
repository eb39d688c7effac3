#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"

namespace posewise {

/// What one measurement of a pose returns, how noisy it is, and which unknowns of its own it
/// brings (target positions). The only virtual type of the library: a new kind of instrument is a
/// new subclass.
class Sensor {
  public:
    virtual ~Sensor() = default;

    /// Numbers one complete observation has, in the order of observation_names().
    virtual Index row_count() const = 0;
    /// What is seen or missed as a whole: an observation holds row_count() / target_count() numbers
    /// of each, one after another, and the errors of two are independent.
    virtual Index target_count() const = 0;
    Index rows_per_target() const { return row_count() / target_count(); }
    /// Column names of an observation without unit, e.g. "p1_x".
    virtual std::vector<std::string> observation_names() const = 0;
    /// Whether the number in this row of an observation is an angle (rad), else a length (m).
    virtual bool is_angle(Index row) const = 0;
    /// Names of the sensor's own unknowns, e.g. "target1.x".
    virtual std::vector<std::string> unknown_names() const = 0;
    /// Whether each of them is an angle (rad), else a length (m).
    virtual std::vector<bool> unknown_is_angle() const = 0;

    /// The observation expected without noise, row_count() values in m or rad.
    virtual VectorXd predict(const Isometry3d& world_from_flange,
                             const VectorXd& unknowns) const = 0;

    /// By how much an observation deviates from another: the step that leads there, row_count()
    /// values in m or rad. Their difference, but for orientations.
    virtual VectorXd deviation(const VectorXd& observation, const VectorXd& reference) const {
        return observation - reference;
    }
    /// The observation with this deviation from `reference`.
    virtual VectorXd deviate(const VectorXd& reference, const VectorXd& deviation) const {
        return reference + deviation;
    }

    /// Derivative of predict() by flange motions and by the sensor's own unknowns:
    /// row_count() x (twists.cols() + unknowns), or without the unknowns' columns. With the
    /// twists of a FlangeMotion this is the identification Jacobian of one pose.
    virtual void differentiate(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                               const VectorXd& unknowns,
                               Eigen::Ref<RowMatrixXd> J_measured_parameters) const = 0;

    /// Rate of differentiate() while the flange moves by `direction` and the twists change at
    /// `twist_rates` (6 x twists.cols()); same shape.
    virtual void differentiate_along(const Isometry3d& world_from_flange, const TwistMatrix& twists,
                                     const Twist& direction, const TwistMatrix& twist_rates,
                                     const VectorXd& unknowns,
                                     Eigen::Ref<RowMatrixXd> J_rate) const = 0;

    /// Where the point of each target is in the flange frame, m.
    virtual Vector3d target_position(Index target, const VectorXd& unknowns) const = 0;

    /// Derivative of the targets' positions in the world, whatever of them is measured: as
    /// differentiate(), 3 * target_count() rows in m.
    virtual void differentiate_positions(const Isometry3d& world_from_flange,
                                         const TwistMatrix& twists, const VectorXd& unknowns,
                                         Eigen::Ref<RowMatrixXd> J_positions_parameters) const = 0;

    /// Covariance of the noise of one observation at this pose: row_count() square, m^2 (rad^2).
    virtual MatrixXd covariance(const Isometry3d& world_from_flange,
                                const VectorXd& unknowns) const = 0;

    /// Rate of covariance() while the flange moves by `direction`.
    virtual MatrixXd covariance_rate(const Isometry3d& world_from_flange, const Twist& direction,
                                     const VectorXd& unknowns) const = 0;

    /// Whether covariance() is the same at every pose, so that its rate is zero.
    virtual bool has_constant_covariance() const = 0;
};

}  // namespace posewise
