#include "choice_cell.hpp"

#include "measurement/places.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"

namespace posewise::detail {

void heed_cell(ChoiceProblem& problem, const Campaign& campaign, bool are_places_found) {
    Campaign placed = campaign;
    if (are_places_found) {
        placed.nominal.world_from_base = problem.parameters.world_from_base;
        placed.nominal.sensor = problem.parameters.sensor;
        placed.has_nominal_base = placed.has_nominal_targets = true;
    }
    check_places(placed);
    if (!placed.has_nominal_base || !placed.has_nominal_targets) {
        placed.cell.sight.reset();
        placed.cell.target_boxes.clear();
    }
    const CellViolations violations =
        find_violations(Constraints(placed, placed.cell, false), problem.configurations);
    const std::vector<std::string>& ids = problem.ids;
    if (std::ssize(violations.rows) == std::ssize(ids)) {
        throw InputError(describe(violations, ids) + "; at least one must be allowed there");
    }
    auto& excluded = problem.options.excluded;
    excluded.insert(excluded.end(), violations.rows.begin(), violations.rows.end());
    auto left_out = violations.rows.begin();
    Index allowed = 0;
    for (Index i = 0; i < problem.share.rows(); ++i) {
        if (left_out != violations.rows.end() && *left_out == i) {
            ++left_out;
            continue;
        }
        problem.share.row(i) =
            violations.allowed.is_seen.row(allowed++).select(problem.share.row(i).array(), 0.0);
        if ((problem.share.row(i).array() == 0).all()) excluded.push_back(i);  // shows nothing
    }
    if (violations.rows.empty()) return;
    problem.cell_doubts.push_back(describe(violations, ids) + ": not chosen");
}

void add_unchecked_bodies(ChoiceProblem& problem, const Campaign& campaign) {
    if (problem.kind == CandidateKind::Measurements) return;
    const std::string unchecked = describe_unchecked_bodies(campaign);
    if (!unchecked.empty()) problem.cell_doubts.push_back(unchecked);
}

}  // namespace posewise::detail
