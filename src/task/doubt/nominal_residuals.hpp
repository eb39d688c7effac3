#pragma once

#include "posewise/calibrator/identification.hpp"

namespace posewise::detail {

/// The robot as its maker says, base and targets fitted.
struct NominalRobot {
    Campaign campaign;  ///< without errors of the robot
    Parameters start;   ///< as registered
    Estimate fitted;    ///< undetermined where fitting takes more configurations

    const Parameters& parameters() const {
        return fitted.undetermined.empty() ? fitted.parameters : start;
    }
};
NominalRobot fit_nominal_robot(const Campaign& campaign, const Chain& robot,
                               const Measurements& measurements, Parameters registered,
                               const LevenbergMarquardtOptions& options);

/// Residuals of the robot as its maker says: base and targets of the campaign fitted, as far as
/// they are not known, `robot` without its errors; as they are registered where fitting takes more
/// configurations.
RowMatrixXd nominal_residuals(const Campaign& campaign, const Chain& robot,
                              const Measurements& measurements, Parameters registered,
                              const LevenbergMarquardtOptions& options);

/// Of residuals as mean_residuals() gives them, the median length: some may be grossly wrong.
/// Of several instruments those that measure lengths.
double median_distance(const RowMatrixXd& residuals);

}  // namespace posewise::detail
