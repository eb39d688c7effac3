#pragma once

#include "posewise/measurement/campaign.hpp"

namespace posewise::detail {

/// The coordinates that identification works in: parameters in expected errors, those that have a
/// prior in such that it is standard normal.
class ParameterUnits {
  public:
    /// Throws InputError if the campaign's prior is none of its robot.
    explicit ParameterUnits(const Campaign& campaign);

    Index size() const { return scale_.size(); }
    /// Those of the parameters that have a prior; 0 is most probable.
    VectorXd prior_coordinates(const Campaign& campaign, const Parameters& parameters) const;
    /// How these change with a step in all coordinates (those that have a prior, square): the
    /// identity but for turns of the base, beside an earlier calibration.
    MatrixXd prior_derivative(const Campaign& campaign, const Parameters& parameters) const;
    /// A step in parameters (m, rad).
    VectorXd step(const VectorXd& d) const;
    /// Derivatives by parameters become such by coordinates.
    void scale_columns(Eigen::Ref<RowMatrixXd> J) const;
    /// A covariance of coordinates becomes one of parameters.
    void unscale(MatrixXd& covariance) const;

  private:
    VectorXd scale_;
    Index begin_;     ///< of those that have a prior
    MatrixXd units_;  ///< where there is an earlier calibration: parameters by coordinates
};

}  // namespace posewise::detail
