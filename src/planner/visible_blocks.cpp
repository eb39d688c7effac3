#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/pool.hpp"

namespace posewise {

Blocks make_visible_blocks(const Campaign& campaign, const Parameters& parameters,
                           const RowMatrixXd& configurations,
                           const std::vector<std::vector<bool>>& is_visible, double repeats) {
    if (is_visible.empty()) return make_blocks(campaign, parameters, configurations, repeats);
    const auto targets = static_cast<std::size_t>(campaign.sensor->target_count());
    RowMatrixXd times =
        RowMatrixXd::Zero(static_cast<Index>(is_visible.size()), static_cast<Index>(targets));
    for (std::size_t i = 0; i < is_visible.size(); ++i) {
        if (is_visible[i].size() != targets) {
            throw InputError("visibility is stated for " + std::to_string(is_visible[i].size()) +
                             " targets, the sensor has " + std::to_string(targets));
        }
        for (std::size_t j = 0; j < targets; ++j) {
            if (is_visible[i][j]) times(static_cast<Index>(i), static_cast<Index>(j)) = repeats;
        }
    }
    return make_blocks(campaign, parameters, configurations, times);
}

}  // namespace posewise
