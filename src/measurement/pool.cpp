#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "core/parallel.hpp"
#include "model/halton.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"

namespace posewise {
namespace {

constexpr Index drawn_at_once = 4096;

void count_rejections(const ConstraintReport& report, double tolerance,
                      std::array<Rejections, constraint_count>& rejections) {
    bool is_first = true;
    for (std::size_t k = 0; k < constraint_count; ++k) {
        if (report.clearance[k] >= -tolerance) continue;
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

/// "keep_out: 2, tracker.range: 1"
std::string list_rejections(const Pool& pool) {
    std::string text;
    for (const std::size_t k : by_rejections(pool)) {
        text += (text.empty() ? "" : ", ") +
                std::string(constraint_name(static_cast<Constraint>(k))) + ": " +
                std::to_string(pool.rejections[k].in_all);
    }
    return text;
}

/// "; most often target 1 and fence left are too near": of some hundred configurations.
std::string most_frequent_collision(const Constraints& constraints) {
    constexpr Index count = 500;
    const RowMatrixXd drawn = detail::halton_configurations(constraints.robot(), count);
    std::map<std::pair<std::string, std::string>, Index> times;
    for (Index i = 0; i < count; ++i) {
        const Clearance nearest = constraints.nearest(drawn.row(i).transpose());
        if (nearest.distance >= constraints.cell().safety_distance) continue;
        ++times[{nearest.body, nearest.other}];
    }
    const auto most =
        std::max_element(times.begin(), times.end(),
                         [](const auto& a, const auto& b) { return a.second < b.second; });
    if (most == times.end()) return "";
    return "; most often " + most->first.first + " and " + most->first.second +
           " are nearer than safety_distance";
}

std::vector<ConstraintReport> check_all(const Constraints& constraints,
                                        const RowMatrixXd& configurations) {
    std::vector<ConstraintReport> reports(static_cast<std::size_t>(configurations.rows()));
    detail::for_each_range(configurations.rows(), 64, [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            reports[static_cast<std::size_t>(i)] =
                constraints.check(configurations.row(i).transpose());
        }
    });
    return reports;
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

/// What of `configurations` breaks no constraint by more than `tolerance`, and the rows that do.
CellViolations sort_out(const Constraints& constraints, const RowMatrixXd& configurations,
                        double tolerance) {
    const std::vector<ConstraintReport> reports = check_all(constraints, configurations);
    CellViolations sorted;
    Pool& pool = sorted.allowed;
    pool.candidate_count = configurations.rows();
    std::vector<Index> feasible;
    for (Index i = 0; i < configurations.rows(); ++i) {
        const ConstraintReport& report = reports[static_cast<std::size_t>(i)];
        count_rejections(report, tolerance, pool.rejections);
        (report.margin() >= -tolerance ? feasible : sorted.rows).push_back(i);
    }
    pool.configurations = configurations(feasible, Eigen::all);
    pool.is_seen.resize(pool.configurations.rows(), constraints.target_count());
    for (Index k = 0; k < pool.is_seen.rows(); ++k) {
        const auto i = static_cast<std::size_t>(feasible[static_cast<std::size_t>(k)]);
        pool.is_seen.row(k) = reports[i].is_seen;
    }
    return sorted;
}

}  // namespace

Pool filter_pool(const Constraints& constraints, const RowMatrixXd& candidates) {
    return sort_out(constraints, candidates, 0).allowed;
}

CellViolations find_violations(const Constraints& constraints, const RowMatrixXd& configurations) {
    constexpr double rounding = 1e-9;  // rad or m
    return sort_out(constraints, configurations, rounding);
}

std::string describe(const CellViolations& violations, const std::vector<std::string>& ids) {
    constexpr std::size_t most_listed = 20;
    const std::size_t count = violations.rows.size();
    if (count == 0) return "";
    std::string text = std::to_string(count) + " of " + std::to_string(ids.size()) +
                       (ids.size() == 1 ? " configuration" : " configurations") +
                       (count == 1 ? " violates" : " violate") + " the campaign's cell: ";
    for (std::size_t i = 0; i < std::min(count, most_listed); ++i) {
        text += (i == 0 ? "" : ", ") + ids[static_cast<std::size_t>(violations.rows[i])];
    }
    return text + (count > most_listed ? ", ..." : "") + " (" +
           list_rejections(violations.allowed) + ')';
}

InputError few_feasible(const Constraints& constraints, const Pool& pool, Index needed) {
    const Index count = pool.configurations.rows();
    std::string text = (count == 0 ? "none" : "only " + std::to_string(count)) + " of " +
                       std::to_string(pool.candidate_count) + " candidates is feasible";
    if (needed > 1) text += ", " + std::to_string(needed) + " are needed";
    const std::vector<std::size_t> kinds = by_rejections(pool);
    if (kinds.empty()) return InputError(text);
    text += "; violated are " + list_rejections(pool);
    const auto worst = static_cast<Constraint>(kinds.front());
    const std::string name = constraint_name(worst);
    if (worst == Constraint::KeepOuts || worst == Constraint::SelfCollision) {
        text += most_frequent_collision(constraints);
    }
    if (count == 0) {
        const bool is_alone = pool.rejections[kinds.front()].in_all == pool.candidate_count;
        const bool may_hide =
            !constraints.cell().links.empty() || !constraints.cell().keep_outs.empty();
        text += !is_alone ? "; together they leave nothing"
                : worst == Constraint::View
                    ? std::string(
                          "; where base and the sensor's place are stated to be, no pose "
                          "looks at the board") +
                          (may_hide ? " past links and obstacles" : "")
                    : "; " + name + " alone leaves nothing";
    }
    return InputError(text + ", so relax " + name + " first");
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
    if (pool.configurations.rows() == 0) throw few_feasible(constraints, pool, 1);
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
                     std::to_string(needed) + " are needed; raise `pool_count`" + relax);
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
