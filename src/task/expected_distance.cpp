#include "expected_distance.hpp"

#include <cmath>

#include "../model/complete_model.hpp"
#include "posewise/calibrator/estimate.hpp"
#include "posewise/planner/prediction.hpp"

namespace posewise::detail {
namespace {

/// Of a robot of which nothing is known but the sizes expected of its errors.
Estimate uncalibrated(const Campaign& campaign, const Parameters& at) {
    Estimate estimate;
    estimate.parameters = at;
    estimate.parameters.robot.setZero(campaign.robot.parameter_count());
    estimate.variance_factor = 1;
    estimate.model_error = campaign.model_error;
    estimate.model_error_orientation = campaign.model_error_orientation;
    VectorXd sizes = parameter_scale(campaign);
    sizes.head(base_parameter_count(campaign)).setZero();
    sizes.tail(at.sensor.size()).setZero();
    estimate.covariance = sizes.cwiseAbs2().asDiagonal();
    return estimate;
}

}  // namespace

double expected_distance(const Campaign& campaign, const Measurements& measured) {
    // At nominal targets: fitted to another robot's points they may be anywhere.
    const Blocks blocks =
        make_prediction_blocks(campaign, campaign.nominal, measured.configurations);
    const auto points = static_cast<double>(blocks.matrix.rows()) / 3;
    const double robot = std::sqrt(
        blocks.matrix.middleCols(base_parameter_count(campaign), campaign.robot.parameter_count())
            .squaredNorm() /
        points);
    const Estimate none = uncalibrated(campaign, campaign.nominal);
    return robot +
           std::hypot(campaign.model_error, expected_error(campaign, none, measured, false).noise);
}

double largest_left_over(const Campaign& campaign, const Parameters& at,
                         const Measurements& measured, bool is_angle) {
    const Campaign complete = with_robot(campaign, complete_model(campaign.robot));
    return expected_error(complete, uncalibrated(complete, at), measured, is_angle).total();
}

}  // namespace posewise::detail
