#include "pool_choices.hpp"

#include <algorithm>

#include "core/decompositions.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::detail {

PoolChoices::PoolChoices(const Campaign& campaign, const Pool& pool, double repeats,
                         const PlanOptions& search, const Blocks& prediction)
    : campaign_(campaign) {
    const Index part = std::min(pool.configurations.rows(), quick_pool_part);
    configurations_ = pool.configurations.topRows(part);
    repeats_ = times_seen(pool.is_seen.topRows(part), repeats);
    blocks_ = make_blocks(campaign, campaign.nominal, configurations_, repeats_);
    select_.criterion = search.criterion;
    if (select_.criterion == Criterion::G) select_.criterion = Criterion::V;  // much quicker
    if (select_.criterion == Criterion::V) select_.test_poses = &prediction;
    select_.nuisance = search.nuisance;
    select_.held_rows = search.held.rows;
    select_.held_pose_count = search.held_pose_count;
    select_.starts = 1;
    select_.kicks = 0;
    select_.proof = 0;
    select_.gap = 0.05;
    select_.seed = search.seed;
}

std::optional<std::vector<Index>> PoolChoices::choose(Index pose_count,
                                                      const StopSignal& stop) const {
    if (pose_count > blocks_.count()) return std::nullopt;
    SelectOptions select = select_;
    select.pose_count = pose_count;
    select.stop = stop;
    const Choice choice = select_poses(blocks_, select);
    if (choice.ending == Ending::NotIdentifiable) return std::nullopt;
    return choice.poses;
}

MatrixXd PoolChoices::information(const std::vector<Index>& chosen) const {
    return information_of(select_.held_rows, blocks_.parameter_count()) +
           posewise::information(blocks_, chosen);
}

InformationByNoise PoolChoices::by_noise(const std::vector<Index>& chosen) const {
    return information_by_noise(campaign_, campaign_.nominal,
                                RowMatrixXd(configurations_(chosen, Eigen::all)),
                                RowMatrixXd(repeats_(chosen, Eigen::all)));
}

}  // namespace posewise::detail
