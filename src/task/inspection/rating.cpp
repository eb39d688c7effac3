#include <limits>

#include "core/decompositions.hpp"
#include "measurement/prior_rows.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/inspection.hpp"

namespace posewise {
namespace {

Indices compute_indices(const Blocks& blocks, const RowMatrixXd& stacked) {
    const VectorXd s = singular_values(stacked);
    Indices indices;
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        indices.values[i] = evaluate_rows(all_criteria[i], stacked, blocks.count(), &blocks);
    }
    const double least = s[s.size() - 1];
    indices.condition = least > 0 ? s[0] / least : std::numeric_limits<double>::infinity();
    return indices;
}

}  // namespace

Rating rate(const Campaign& campaign, const Measurements& measurements, Index directions) {
    const Parameters registered = determined(register_base_and_targets(campaign, measurements));
    Rating rating;
    rating.repeats = mean_repeats(measurements);
    const RowMatrixXd share = share_seen(measurements);
    const RowMatrixXd& configurations = measurements.configurations;
    const Blocks scaled = make_blocks(campaign, registered, configurations, rating.repeats * share);
    // m per m and m per rad are mm per mm and mm per mrad: nothing to convert.
    const Blocks plain = make_plain_blocks(campaign, registered, configurations, share);
    const RowMatrixXd stacked = detail::stack(detail::prior_rows(campaign), scaled.matrix);
    rating.configurations = scaled.count();
    rating.parameters = scaled.parameter_count();
    rating.scaled = compute_indices(scaled, stacked);
    rating.plain = compute_indices(plain, plain.matrix);
    rating.weakest = weakest_directions(stacked, directions);
    return rating;
}

}  // namespace posewise
