#pragma once

#include <cstdint>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/constraints.hpp"

namespace posewise {

/// How many candidates a constraint removed.
struct Rejections {
    Index first = 0;   ///< those for which it was the first violated, in the order of Constraint
    Index in_all = 0;  ///< those that violate it, whatever else they violate
};

/// The candidates that satisfy all constraints, in the order they were drawn.
struct Pool {
    RowMatrixXd configurations;  ///< feasible x joints
    Seen is_seen;                ///< feasible x targets
    Index candidate_count = 0;
    std::array<Rejections, constraint_count> rejections{};  ///< by Constraint
};

/// Draws `count` configurations of a scrambled Halton sequence within the limits and margins, fixed
/// joints at their values, and keeps the feasible ones. The same for any number of threads. Fewer
/// are drawn if `stop` comes, see Pool::candidate_count. Throws InputError for a count below 1, or
/// if none is feasible: it names the constraints to blame.
Pool make_pool(const Constraints& constraints, Index count, std::uint64_t seed,
               const StopSignal& stop = {});

/// Throws InputError if a pool has fewer poses than a plan needs; it names the constraint to blame.
void check_pool_size(const Pool& pool, Index needed);

/// What to throw where so many poses are needed and only those of this pool were found: it names
/// the constraint to blame and, if that is a collision, the bodies that collide most.
InputError few_feasible(const Constraints& constraints, const Pool& pool, Index needed);

/// Which of these configurations the cell of the constraints does not allow, rows from 0. What
/// rounding to twelve digits does is let pass.
struct CellViolations {
    std::vector<Index> rows;
    Pool allowed;  ///< the others, and what rejects these
};
CellViolations find_violations(const Constraints& constraints, const RowMatrixXd& configurations);

/// "3 of 20 configurations violate the campaign's cell: 4, 7, 9 (keep_out: 2, tracker.range: 1)",
/// by their ids; empty if there is none.
std::string describe(const CellViolations& violations, const std::vector<std::string>& ids);

/// One line a constraint that removed anything: "keep_out: 812 (310 first)", the largest first.
std::string describe_rejections(const Pool& pool);

/// The configurations checked as they are, not drawn.
Pool filter_pool(const Constraints& constraints, const RowMatrixXd& candidates);

}  // namespace posewise
