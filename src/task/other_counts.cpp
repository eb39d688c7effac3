#include <algorithm>
#include <set>

#include "posewise/calibrator/registration.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {
namespace {

constexpr Index pool_part = 1500;  // candidates searched

/// Quick selections from a part of the pool.
SelectOptions quick_options(const Planning& planning) {
    SelectOptions options;
    options.criterion = planning.search.criterion;
    if (options.criterion == Criterion::G) options.criterion = Criterion::V;  // much quicker
    if (options.criterion == Criterion::V) options.test_poses = &planning.prediction;
    options.nuisance = planning.search.nuisance;
    options.held = planning.search.held.information;
    options.held_pose_count = planning.search.held_pose_count;
    options.starts = 4;  // one alone may be far off where poses hardly suffice
    options.proof = 0;
    options.gap = 1e-2;
    options.seed = planning.search.seed;
    return options;
}

std::optional<PredictedAccuracy> predict_choice(const Planning& planning, const Blocks& blocks,
                                                const SelectOptions& options) {
    if (options.pose_count > blocks.count()) return std::nullopt;
    const Choice choice = select_poses(blocks, options);
    if (choice.ending == Ending::NotIdentifiable) return std::nullopt;
    MatrixXd M = information(blocks, choice.poses);
    if (options.held.size() > 0) M += options.held;
    return predict_accuracy(planning.prediction, M, planning.campaign);
}

}  // namespace

std::vector<CountAccuracy> predict_other_counts(const Planning& planning) {
    const Pool& pool = planning.pool;
    const Index part = std::min(pool.configurations.rows(), pool_part);
    const Blocks blocks =
        make_blocks(planning.campaign, planning.campaign.nominal, pool.configurations.topRows(part),
                    times_seen(pool.is_seen.topRows(part), planning.plan.request.repeats));
    SelectOptions options = quick_options(planning);
    const Index count = planning.search.pose_count;
    const Index least = least_calibration_count(planning.campaign) - options.held_pose_count;
    std::vector<CountAccuracy> rows;
    for (const Index k : std::set<Index>{std::max<Index>(1, count / 2), count, 2 * count}) {
        options.pose_count = k;
        rows.push_back({k, false, std::nullopt});
        if (k >= least) {
            rows.back().accuracy = predict_choice(planning, blocks, options);
        }
        if (k == count) rows.push_back({k, true, planning.plan.predicted});
    }
    return rows;
}

}  // namespace posewise
