#include "expected_distance.hpp"

#include <cmath>

#include "posewise/planner/prediction.hpp"

namespace posewise::detail {

double expected_distance(const Campaign& campaign, const Measurements& measured) {
    // At nominal targets: fitted to another robot's points they may be anywhere.
    const Blocks blocks =
        make_prediction_blocks(campaign, campaign.nominal, measured.configurations);
    const auto points = static_cast<double>(blocks.matrix.rows()) / 3;
    return std::sqrt(
               blocks.matrix
                   .middleCols(base_parameter_count(campaign), campaign.robot.parameter_count())
                   .squaredNorm() /
               points) +
           campaign.model_error;
}

}  // namespace posewise::detail
