#include "tour.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <map>
#include <numeric>

#include "core/parallel.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

Pace pace_of(const Constraints& constraints) {
    const Cell& cell = constraints.cell();
    return {cell.speed.size() > 0 ? cell.speed : VectorXd::Ones(constraints.robot().joint_count()),
            cell.acceleration};
}

/// Where the tour begins (the first, if it is not empty) and poses.
std::vector<VectorXd> nodes_of(const VectorXd& start, const RowMatrixXd& poses) {
    std::vector<VectorXd> nodes{start};
    for (Index i = 0; i < poses.rows(); ++i) nodes.push_back(poses.row(i).transpose());
    return nodes;
}

/// A stop signal, and half a second more: what is planned must still be put in order.
class Respite {
  public:
    explicit Respite(const StopSignal& stop) : stop_(stop) {}

    bool is_over() const {
        using Clock = std::chrono::steady_clock;
        constexpr std::chrono::milliseconds length{500};
        if (!stop_.is_set()) return false;
        const Clock::duration now = Clock::now().time_since_epoch();
        Clock::rep begin = 0;
        if (begin_.compare_exchange_strong(begin, now.count())) return false;
        return now - Clock::duration(begin) > length;
    }

  private:
    const StopSignal& stop_;
    mutable std::atomic<std::chrono::steady_clock::rep> begin_{0};  // 0: not set yet
};

/// Of straight moves between all nodes; 0 from a home that there is not.
MatrixXd times_between(const Pace& pace, const std::vector<VectorXd>& nodes,
                       const Respite& respite) {
    const auto count = static_cast<Index>(nodes.size());
    MatrixXd times = MatrixXd::Zero(count, count);
    for (Index i = 1; i < count && !respite.is_over(); ++i) {
        for (Index j = nodes[0].size() != 0 ? 0 : 1; j < i; ++j) {
            times(i, j) = times(j, i) = move_time(pace, nodes[static_cast<std::size_t>(i)],
                                                  nodes[static_cast<std::size_t>(j)]);
        }
    }
    return times;
}

/// Home (node 0, if there is one) and poses with the ways between them.
class Roadmap {
  public:
    Roadmap(const Constraints& constraints, const RowMatrixXd& poses, const TourOptions& options)
        : constraints_(constraints),
          options_(options),
          respite_(options.stop),
          pace_(pace_of(constraints)) {
        const bool is_from_home = options.start.size() == 0;
        nodes_ = nodes_of(is_from_home ? constraints.cell().home : options.start, poses);
        for (const VectorXd& node : nodes_) {
            if (node.size() != 0 || &node != &nodes_[0]) {
                constraints.robot().check_configuration(node);
            }
        }
        if (!has_home() || !is_from_home) return;
        const std::string fault = describe_violation(constraints, nodes_[0], Stop::Home);
        if (!fault.empty()) throw InputError("cell: home " + fault);
    }

    bool is_over() const { return respite_.is_over(); }
    const MatrixXd& straight_times() const { return straight_times_; }
    double straight_time(Index from, Index to) const {
        return has_home() || from != 0 ? move_time(pace_, node(from), node(to)) : 0;
    }

    /// All straight times, and which moves are free; false if there was no time for it.
    bool measure() {
        straight_times_ = times_between(pace_, nodes_, respite_);
        is_measured_ = !is_over() && find_free_moves();
        return is_measured_;
    }

    /// On to the nearest each, without looking at what is in the way.
    std::vector<Index> to_the_nearest() const {
        const auto count = std::ssize(nodes_) - 1;
        RowMatrixXd left(count, pace_.speed.size());  // poses in s, those not yet visited first
        std::vector<Index> order(static_cast<std::size_t>(count));
        for (Index i = 0; i < count; ++i) {
            left.row(i) = node(i + 1).cwiseQuotient(pace_.speed);
            order[static_cast<std::size_t>(i)] = i;
        }
        VectorXd here = has_home() ? VectorXd(nodes_[0].cwiseQuotient(pace_.speed)) : VectorXd();
        for (Index k = 0; k < count; ++k) {
            Index nearest = 0;
            if (here.size() > 0) {
                (left.bottomRows(count - k).rowwise() - here.transpose())
                    .cwiseAbs()
                    .rowwise()
                    .maxCoeff()
                    .minCoeff(&nearest);
            }
            left.row(k).swap(left.row(k + nearest));
            std::swap(order[static_cast<std::size_t>(k)],
                      order[static_cast<std::size_t>(k + nearest)]);
            here = left.row(k).transpose();
        }
        return order;
    }

    /// Times with what is known: of free moves and of vias. Not free and not yet examined counts
    /// as longer than any tour of the others; found to be blocked, as infinite.
    MatrixXd known_times() const {
        const double unknown =
            static_cast<double>(nodes_.size()) * (straight_times_.maxCoeff() + 1);
        MatrixXd times = straight_times_;
        for (Index i = 0; i < times.rows(); ++i) {
            for (Index j = 0; j < i; ++j) {
                if (is_free_(i, j)) continue;
                const auto found = detours_.find({i, j});
                times(i, j) = found == detours_.end() ? unknown : found->second.time;
                times(j, i) = times(i, j);
            }
        }
        return times;
    }

    /// Looks for a via of a move that needs one; false if it needs none, that was done before or
    /// there is no time.
    bool examine(Index i, Index j) {
        if (i < j) std::swap(i, j);
        if (is_free_(i, j) || detours_.count({i, j}) != 0 || is_over()) return false;
        detours_[{i, j}] = find_detour(i, j);
        return true;
    }

    Visit visit(Index from, Index to) const {
        Visit visit{to - 1, std::nullopt, false};
        if (is_free(from, to)) return visit;
        const auto found = detours_.find({std::max(from, to), std::min(from, to)});
        visit.is_blocked = found == detours_.end() || found->second.time == infinity;
        if (!visit.is_blocked) visit.via = found->second.via;
        return visit;
    }

    double time_of(Index from, const Visit& visit) const {
        const Index to = visit.pose + 1;
        if (!visit.via) return straight_time(from, to);
        return detours_.at({std::max(from, to), std::min(from, to)}).time;
    }

  private:
    struct Detour {
        double time = infinity;
        VectorXd via;
    };

    bool has_home() const { return nodes_[0].size() != 0; }
    const VectorXd& node(Index i) const { return nodes_[static_cast<std::size_t>(i)]; }

    bool is_free(Index from, Index to) const {
        if (from == 0 && !has_home()) return true;
        if (is_measured_) return is_free_(std::max(from, to), std::min(from, to)) != 0;
        return is_move_free(constraints_, node(from), node(to), options_.resolution);
    }

    /// False if there was no time for it.
    bool find_free_moves() {
        const auto count = static_cast<Index>(nodes_.size());
        is_free_ = Eigen::Matrix<char, Eigen::Dynamic, Eigen::Dynamic>::Ones(count, count);
        for_each_index(count, [&](Index i) {
            for (Index j = has_home() ? 0 : 1; j < i && !is_over(); ++j) {
                is_free_(i, j) =
                    is_move_free(constraints_, node(i), node(j), options_.resolution) ? 1 : 0;
            }
        });
        return !is_over();
    }

    /// The quickest of the free ways over home and over random points about the middle of the
    /// move, the farther out the more were tried.
    Detour find_detour(Index i, Index j) const {
        Detour best;
        const auto consider = [&](const VectorXd& via) {
            const double time = move_time(pace_, node(i), via) + move_time(pace_, via, node(j));
            if (time >= best.time || constraints_.find_violated(via, Stop::Via)) return;
            if (!is_move_free(constraints_, node(i), via, options_.resolution)) return;
            if (!is_move_free(constraints_, via, node(j), options_.resolution)) return;
            best = {time, via};
        };
        if (has_home() && j != 0) consider(nodes_[0]);
        RandomStream stream(options_.order.seed,
                            static_cast<std::uint64_t>(i * straight_times_.rows() + j));
        for (Index k = 1; k <= options_.via_attempts; ++k) {
            const double spread =
                static_cast<double>(k) / static_cast<double>(options_.via_attempts);
            consider(draw_via(node(i), node(j), spread, stream));
        }
        return best;
    }

    VectorXd draw_via(const VectorXd& a, const VectorXd& b, double spread,
                      RandomStream& stream) const {
        VectorXd via = (a + b) / 2;
        for (Index k = 0; k < via.size(); ++k) {
            const Joint& joint = constraints_.robot().joints()[static_cast<std::size_t>(k)];
            const double drawn = stream.uniform(joint.lower, joint.upper);
            if (constraints_.cell().fixed_joints.count(k) == 0) via[k] += spread * (drawn - via[k]);
        }
        return via;
    }

    const Constraints& constraints_;
    const TourOptions& options_;
    Respite respite_;
    Pace pace_;
    std::vector<VectorXd> nodes_;
    MatrixXd straight_times_;
    Eigen::Matrix<char, Eigen::Dynamic, Eigen::Dynamic> is_free_;  // lower triangle
    bool is_measured_ = false;
    std::map<std::pair<Index, Index>, Detour> detours_;  // larger index first
};

/// Examines the moves of the order that are not free; false if there was nothing left to examine.
bool examine_moves(Roadmap& roadmap, const std::vector<Index>& poses) {
    bool is_new = false;
    Index here = 0;
    for (const Index pose : poses) {
        is_new = roadmap.examine(here, pose + 1) || is_new;
        here = pose + 1;
    }
    return is_new;
}

/// An order, and the shortest one that is known.
struct Orders {
    std::vector<Index> taken;
    double shortest_time = 0;
};

Orders order_by_known_times(Roadmap& roadmap, const TourOptions& asked) {
    OrderOptions options = asked.order;
    options.is_over = [&roadmap] { return roadmap.is_over(); };
    for (;;) {
        const MatrixXd times = roadmap.known_times();
        const VisitingOrder shortest = shortest_order(times, options);
        if (examine_moves(roadmap, shortest.poses)) continue;
        if (asked.random_order <= 0) return {shortest.poses, shortest.time};
        const VisitingOrder order = random_order(times, shortest, asked.random_order, options);
        if (!examine_moves(roadmap, order.poses)) return {order.poses, shortest.time};
    }
}

/// Of straight moves, free or not, in this order.
double straight_time_of(const Roadmap& roadmap, const std::vector<Index>& order) {
    double time = 0;
    Index here = 0;
    for (const Index pose : order) {
        time += roadmap.straight_time(here, pose + 1);
        here = pose + 1;
    }
    return time;
}

}  // namespace

double move_time(const Pace& pace, const VectorXd& a, const VectorXd& b) {
    const VectorXd ways = (b - a).cwiseAbs();
    if (pace.acceleration.size() == 0) return ways.cwiseQuotient(pace.speed).maxCoeff();
    double longest = 0;
    for (Index j = 0; j < ways.size(); ++j) {
        const double rise = pace.speed[j] / pace.acceleration[j];  // s, to the full speed
        const bool is_short = ways[j] < pace.speed[j] * rise;
        const double time = is_short ? 2 * std::sqrt(ways[j] / pace.acceleration[j])
                                     : ways[j] / pace.speed[j] + rise;
        longest = std::max(longest, time);
    }
    return longest;
}

bool is_move_free(const Constraints& constraints, const VectorXd& a, const VectorXd& b,
                  double resolution) {
    constexpr double rounding = 1e-6;  // poses may touch their bound
    const double motion = constraints.clearance_rates().dot((b - a).cwiseAbs());
    double done = 0;
    for (;;) {
        const double share = motion > 0 ? std::min(done / motion, 1.0) : 1.0;
        const double clearance = constraints.collision_clearance(a + share * (b - a));
        if (clearance < -rounding) return false;
        if (share == 1) return true;
        done += std::max(clearance, resolution);
    }
}

double straight_tour_time(const Constraints& constraints, const RowMatrixXd& poses) {
    OrderOptions options;
    options.kicks = 0;
    const StopSignal never;
    return shortest_order(times_between(pace_of(constraints),
                                        nodes_of(constraints.cell().home, poses), Respite(never)),
                          options)
        .time;
}

Tour plan_tour(const Constraints& constraints, const RowMatrixXd& poses,
               const TourOptions& options) {
    Roadmap roadmap(constraints, poses, options);
    const bool is_measured = roadmap.measure();
    const std::vector<Index> nearest = is_measured
                                           ? nearest_neighbour_order(roadmap.straight_times()).poses
                                           : roadmap.to_the_nearest();
    const Orders orders = is_measured ? order_by_known_times(roadmap, options) : Orders{nearest};
    std::vector<Index> given(nearest.size());
    std::iota(given.begin(), given.end(), Index{0});

    Tour tour;
    tour.is_cut_short = roadmap.is_over();
    tour.planning_order_time = straight_time_of(roadmap, given);
    tour.nearest_neighbour_time = straight_time_of(roadmap, nearest);
    tour.shortest_time = is_measured ? orders.shortest_time : tour.nearest_neighbour_time;
    Index here = 0;
    for (const Index pose : orders.taken) {
        const Visit visit = roadmap.visit(here, pose + 1);
        if (visit.is_blocked) ++tour.blocked_count;
        tour.time += roadmap.time_of(here, visit);
        tour.visits.push_back(visit);
        here = pose + 1;
    }
    return tour;
}

}  // namespace posewise::detail
