#include "posewise/planner/pool.hpp"

#include <algorithm>
#include <numeric>

#include "../core/parallel.hpp"
#include "../model/halton.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

constexpr Index drawn_at_once = 4096;

void count_rejections(const ConstraintReport& report,
                      std::array<Rejections, constraint_count>& rejections) {
    bool is_first = true;
    for (std::size_t k = 0; k < constraint_count; ++k) {
        if (report.clearance[k] >= 0) continue;
        ++rejections[k].in_all;
        if (is_first) ++rejections[k].first;
        is_first = false;
    }
}

/// Constraints that removed anything, the largest first.
std::vector<std::size_t> by_rejections(const Pool& pool) {
    std::vector<std::size_t> kinds(constraint_count);
    std::iota(kinds.begin(), kinds.end(), std::size_t{0});
    std::erase_if(kinds, [&](std::size_t k) { return pool.rejections[k].in_all == 0; });
    std::stable_sort(kinds.begin(), kinds.end(), [&](std::size_t a, std::size_t b) {
        return pool.rejections[a].in_all > pool.rejections[b].in_all;
    });
    return kinds;
}

InputError nothing_feasible(const Pool& pool) {
    const std::vector<std::size_t> kinds = by_rejections(pool);
    std::string violated;
    for (const std::size_t k : kinds) {
        violated += (violated.empty() ? "" : ", ") +
                    std::string(constraint_name(static_cast<Constraint>(k))) + " by " +
                    std::to_string(pool.rejections[k].in_all);
    }
    const Rejections& worst = pool.rejections[kinds.front()];
    const std::string name = constraint_name(static_cast<Constraint>(kinds.front()));
    return InputError("none of " + std::to_string(pool.candidate_count) +
                      " candidates is feasible; violated are " + violated + "; " +
                      (worst.in_all == pool.candidate_count ? name + " alone leaves nothing"
                                                            : "together they leave nothing") +
                      ", so relax " + name + " first");
}

/// Parts of a pool, one after the other.
Pool join(const std::vector<Pool>& parts) {
    Pool pool;
    Index rows = 0;
    for (const Pool& part : parts) rows += part.configurations.rows();
    pool.configurations.resize(rows, parts.front().configurations.cols());
    pool.is_seen.resize(rows, parts.front().is_seen.cols());
    Index row = 0;
    for (const Pool& part : parts) {
        pool.configurations.middleRows(row, part.configurations.rows()) = part.configurations;
        pool.is_seen.middleRows(row, part.configurations.rows()) = part.is_seen;
        row += part.configurations.rows();
        pool.candidate_count += part.candidate_count;
        for (std::size_t k = 0; k < constraint_count; ++k) {
            pool.rejections[k].first += part.rejections[k].first;
            pool.rejections[k].in_all += part.rejections[k].in_all;
        }
    }
    return pool;
}

}  // namespace

Pool filter_pool(const Constraints& constraints, const RowMatrixXd& candidates) {
    std::vector<ConstraintReport> reports(static_cast<std::size_t>(candidates.rows()));
    detail::for_each_range(candidates.rows(), 64, [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            reports[static_cast<std::size_t>(i)] = constraints.check(candidates.row(i).transpose());
        }
    });
    Pool pool;
    pool.candidate_count = candidates.rows();
    std::vector<Index> feasible;
    for (Index i = 0; i < candidates.rows(); ++i) {
        const ConstraintReport& report = reports[static_cast<std::size_t>(i)];
        count_rejections(report, pool.rejections);
        if (report.is_feasible()) feasible.push_back(i);
    }
    pool.configurations = candidates(feasible, Eigen::all);
    pool.is_seen.resize(pool.configurations.rows(), constraints.target_count());
    for (Index k = 0; k < pool.is_seen.rows(); ++k) {
        const auto i = static_cast<std::size_t>(feasible[static_cast<std::size_t>(k)]);
        pool.is_seen.row(k) = reports[i].is_seen;
    }
    return pool;
}

Pool make_pool(const Constraints& constraints, Index count, std::uint64_t seed,
               const StopSignal& stop) {
    if (count < 1) {
        throw InputError("a pool of " + std::to_string(count) + " candidates, must be at least 1");
    }
    std::vector<Pool> parts;
    Index drawn = 0;
    while (drawn < count && !(drawn > 0 && stop.is_set())) {
        const Index size = std::min(count - drawn, drawn_at_once);
        RowMatrixXd candidates =
            detail::halton_configurations(constraints.robot(), size, {{}, 1 + drawn, seed});
        for (const auto& [joint, value] : constraints.cell().fixed_joints) {
            candidates.col(joint).setConstant(value);
        }
        parts.push_back(filter_pool(constraints, constraints.bring_to_contacts(candidates, drawn)));
        // Those that reach no contact were drawn, too.
        parts.back().candidate_count = size;
        drawn += size;
    }
    Pool pool = join(parts);
    if (pool.configurations.rows() == 0) throw nothing_feasible(pool);
    return pool;
}

void check_pool_size(const Pool& pool, Index needed) {
    const Index count = pool.configurations.rows();
    if (count >= needed) return;
    const std::vector<std::size_t> kinds = by_rejections(pool);
    const std::string relax =
        kinds.empty()
            ? ""
            : " or relax " + std::string(constraint_name(static_cast<Constraint>(kinds.front())));
    throw InputError("the pool has only " + std::to_string(count) + " feasible poses of " +
                     std::to_string(pool.candidate_count) + " candidates, " +
                     std::to_string(needed) + " are needed; raise --pool" + relax);
}

std::string describe_rejections(const Pool& pool) {
    std::string text;
    for (const std::size_t k : by_rejections(pool)) {
        text += std::string(constraint_name(static_cast<Constraint>(k))) + ": " +
                std::to_string(pool.rejections[k].in_all) + " (" +
                std::to_string(pool.rejections[k].first) + " first)\n";
    }
    return text;
}

}  // namespace posewise
