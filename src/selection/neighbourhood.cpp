#include "neighbourhood.hpp"

#include "block_updates.hpp"
#include "screening.hpp"

namespace posewise {
namespace {

bool has_kernel(const Objective& objective) {
    return objective.nuisance.empty() &&
           (objective.criterion == Criterion::D || objective.criterion == Criterion::O1 ||
            objective.criterion == Criterion::A || objective.criterion == Criterion::V);
}

}  // namespace

Shortlist make_shortlist(const Objective& objective, const Blocks& candidates,
                         std::vector<Index> members) {
    Shortlist shortlist{std::move(members), {}};
    if (has_kernel(objective)) shortlist.lanes = make_lane_blocks(candidates, shortlist.members);
    return shortlist;
}

std::unique_ptr<Neighbourhood> make_neighbourhood(const Objective& objective,
                                                  const Blocks& candidates,
                                                  const Shortlist& shortlist,
                                                  const std::function<bool()>& must_stop) {
    if (shortlist.lanes.rows > 0) {
        return std::make_unique<BlockUpdates>(objective, candidates, shortlist);
    }
    return std::make_unique<Screening>(objective, candidates, shortlist, must_stop);
}

}  // namespace posewise
