#include <fmt/format.h>

#include <limits>

#include "core/decompositions.hpp"
#include "measurement/prior_rows.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/inspection.hpp"

namespace posewise {
namespace {

Indices compute_indices(const Blocks& tests, Index pose_count, const RowMatrixXd& stacked) {
    const VectorXd s = singular_values(stacked);
    Indices indices;
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        indices.values[i] = evaluate_rows(all_criteria[i], stacked, pose_count, &tests);
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
    rating.scaled = compute_indices(scaled, scaled.count(), stacked);
    rating.plain = compute_indices(plain, plain.count(), plain.matrix);
    rating.weakest = weakest_directions(stacked, directions);
    return rating;
}

Rating rate(const Blocks& candidates, const std::vector<Index>& poses, bool has_prior,
            Index directions) {
    for (const Index pose : poses) {
        if (pose >= 0 && pose < candidates.count()) continue;
        throw InputError(fmt::format("a pose is candidate {}; must be from 0 to {}", pose,
                                     candidates.count() - 1));
    }
    const Blocks rated = poses.empty() ? candidates : take(candidates, poses);
    const Index L = rated.parameter_count();
    const RowMatrixXd stacked =
        has_prior ? detail::stack(RowMatrixXd::Identity(L, L), rated.matrix) : rated.matrix;
    Rating rating;
    rating.configurations = rated.count();
    rating.parameters = L;
    rating.scaled = compute_indices(candidates, rated.count(), stacked);
    rating.plain = compute_indices(candidates, rated.count(), rated.matrix);
    rating.weakest = weakest_directions(stacked, directions);
    return rating;
}

}  // namespace posewise
