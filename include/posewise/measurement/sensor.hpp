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
    /// Column names of an observation without unit, e.g. "p1_x".
    virtual std::vector<std::string> observation_names() const = 0;
    /// Names of the sensor's own unknowns, e.g. "target1.x".
    virtual std::vector<std::string> unknown_names() const = 0;

    /// The observation expected without noise, row_count() values in m (or rad).
    virtual VectorXd predict(const Isometry3d& world_from_flange,
                             const VectorXd& unknowns) const = 0;

    /// The identification Jacobian of one pose: row_count() x (motion.twists.cols() + unknowns).
    virtual void differentiate(const FlangeMotion& motion, const VectorXd& unknowns,
                               Eigen::Ref<RowMatrixXd> J_measured_parameters) const = 0;

    /// Covariance of the noise of one observation at this pose: row_count() square, m^2 (rad^2).
    virtual MatrixXd covariance(const Isometry3d& world_from_flange,
                                const VectorXd& unknowns) const = 0;
};

}  // namespace posewise
