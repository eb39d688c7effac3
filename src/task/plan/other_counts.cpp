#include <algorithm>
#include <set>

#include "pool_choices.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/task/planning.hpp"

namespace posewise {

std::vector<CountAccuracy> predict_other_counts(const Planning& planning, const StopSignal& stop) {
    const Blocks& prediction = planning.errors.by_parameters;
    const detail::PoolChoices choices(planning.campaign, planning.pool,
                                      planning.plan.request.repeats, planning.search, prediction);
    const Index count = planning.search.pose_count;
    const Index least =
        least_calibration_count(planning.campaign) - planning.search.held_pose_count;
    std::vector<CountAccuracy> rows;
    for (const Index k : std::set<Index>{std::max<Index>(1, count / 2), count, 2 * count}) {
        if (k == count && planning.chosen) {
            rows.push_back({k, false, planning.chosen});
            rows.push_back({k, true, planning.plan.predicted});
            continue;
        }
        const auto chosen = k >= least ? choices.choose(k, stop) : std::nullopt;
        if (!stop.is_set()) {  // else it may be any choice
            rows.push_back({k, false, std::nullopt});
            if (chosen) {
                rows.back().accuracy =
                    predict_accuracy(planning.errors, choices.information(*chosen),
                                     planning.campaign, choices.by_noise(*chosen));
            }
        }
        if (k == count) rows.push_back({k, true, planning.plan.predicted});
    }
    return rows;
}

}  // namespace posewise
