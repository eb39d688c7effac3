#include "order.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"

namespace posewise::detail {
namespace {

using Path = std::vector<Index>;  // of nodes; the start, 0, comes first and stays there

void check_times(const MatrixXd& times) {
    if (times.rows() < 1 || times.rows() != times.cols()) {
        throw InputError("travel times are " + std::to_string(times.rows()) + " x " +
                         std::to_string(times.cols()) + ", must be square, the start first");
    }
    if (times.rows() > 0 && (!(times.array() >= 0).all() || times != times.transpose())) {
        throw InputError("travel times must be symmetric and not negative");
    }
}

/// Impossible moves as finite ones that outweigh all others, so that differences are numbers.
MatrixXd penalise(const MatrixXd& times) {
    double largest = 0;
    for (const double time : times.reshaped()) {
        if (std::isfinite(time)) largest = std::max(largest, time);
    }
    const double penalty = 2 * static_cast<double>(times.rows()) * (largest + 1);
    return times.unaryExpr([=](double time) { return std::isfinite(time) ? time : penalty; });
}

/// Local search on one path.
class Improver {
  public:
    Improver(const MatrixXd& times, Path& path, const std::function<bool()>& is_over)
        : times_(times),
          path_(path),
          is_over_(is_over),
          last_(static_cast<Index>(path.size()) - 1),
          least_gain_(rounding * std::max(1.0, longest(times))) {}

    void run() {
        while (reverse_something() || move_something()) {
        }
    }

  private:
    /// Sums of times that long differ by so much of them though they are of the same legs; more is
    /// gained, or the search would go round for ever.
    static constexpr double rounding = 1e-12;

    static double longest(const MatrixXd& times) {
        return times.array().isFinite().select(times.array(), 0).maxCoeff();
    }

    Index node(Index position) const { return path_[static_cast<std::size_t>(position)]; }
    /// Time between neighbours; nothing follows the last.
    double leg(Index from, Index to) const { return to > last_ ? 0 : times_(node(from), node(to)); }
    auto at(Index position) { return path_.begin() + position; }

    /// 2-opt: the first reversal of positions i to j that shortens the path.
    bool reverse_something() {
        for (Index i = 1; i < last_ && !is_over(); ++i) {
            for (Index j = i + 1; j <= last_; ++j) {
                const double end = j < last_ ? times_(node(i), node(j + 1)) : 0;
                const double change =
                    times_(node(i - 1), node(j)) + end - leg(i - 1, i) - leg(j, j + 1);
                if (change > -least_gain_) continue;
                std::reverse(at(i), at(j + 1));
                return true;
            }
        }
        return false;
    }

    /// Or-opt: the first move of up to three neighbours, as they are or reversed, after another
    /// position that shortens the path.
    bool move_something() {
        for (Index size = 1; size <= 3; ++size) {
            for (Index i = 1; i + size - 1 <= last_ && !is_over(); ++i) {
                const Index j = i + size - 1;
                const double bridge = j < last_ ? times_(node(i - 1), node(j + 1)) : 0;
                const double gain = leg(i - 1, i) + leg(j, j + 1) - bridge;
                for (Index k = 0; k <= last_; ++k) {
                    if (k >= i - 1 && k <= j) continue;
                    if (insert(i, j, k, gain)) return true;
                }
            }
        }
        return false;
    }

    /// Moves positions i to j after position k if that costs less than taking them out gains.
    bool insert(Index i, Index j, Index k, double gain) {
        const auto cost = [&](Index first, Index second) {
            const double end = k < last_ ? times_(node(second), node(k + 1)) : 0;
            return times_(node(k), node(first)) + end - leg(k, k + 1);
        };
        const double straight = cost(i, j);
        const double reversed = cost(j, i);
        if (std::min(straight, reversed) > gain - least_gain_) return false;
        if (reversed < straight) std::reverse(at(i), at(j + 1));
        if (k > j) {
            std::rotate(at(i), at(j + 1), at(k + 1));
        } else {
            std::rotate(at(k + 1), at(i), at(j + 1));
        }
        return true;
    }

    bool is_over() const { return is_over_ && is_over_(); }

    const MatrixXd& times_;
    Path& path_;
    const std::function<bool()>& is_over_;
    Index last_;
    double least_gain_;
};

double path_time(const MatrixXd& times, const Path& path) {
    double time = 0;
    for (std::size_t k = 1; k < path.size(); ++k) time += times(path[k - 1], path[k]);
    return time;
}

/// Double bridge: exchanges two neighbouring pieces after the start.
Path kick(const Path& path, RandomStream& stream) {
    const auto size = static_cast<Index>(path.size());
    const std::vector<Index> cuts = stream.subset(size - 1, 3);
    Path kicked = path;
    const auto cut = [&](std::size_t k) { return kicked.begin() + 1 + cuts[k]; };
    std::rotate(cut(0), cut(1), cut(2) + 1);
    return kicked;
}

Path nearest_neighbour_path(const MatrixXd& times) {
    const auto count = static_cast<std::size_t>(times.rows());
    Path path(count);
    std::iota(path.begin(), path.end(), Index{0});
    for (std::size_t k = 1; k < count; ++k) {
        const auto rest = path.begin() + static_cast<std::ptrdiff_t>(k);
        const Index here = path[k - 1];
        std::iter_swap(rest, std::min_element(rest, path.end(), [&](Index a, Index b) {
                           const double to_a = times(a, here);
                           const double to_b = times(b, here);
                           return to_a != to_b ? to_a < to_b : a < b;  // of equals the first pose
                       }));
    }
    return path;
}

VisitingOrder to_order(const MatrixXd& times, const Path& path) {
    VisitingOrder order{{path.begin() + 1, path.end()}, path_time(times, path)};
    for (Index& pose : order.poses) --pose;
    return order;
}

}  // namespace

VisitingOrder nearest_neighbour_order(const MatrixXd& times) {
    check_times(times);
    return to_order(times, nearest_neighbour_path(times));
}

VisitingOrder shortest_order(const MatrixXd& times, const OrderOptions& options) {
    check_times(times);
    const MatrixXd finite = penalise(times);
    Path best = nearest_neighbour_path(finite);
    Improver(finite, best, options.is_over).run();
    double least = path_time(finite, best);
    const auto is_over = [&] { return options.is_over && options.is_over(); };
    for (Index k = 0; k < options.kicks && best.size() > 4 && !is_over(); ++k) {
        RandomStream stream(options.seed, static_cast<std::uint64_t>(k));
        Path path = kick(best, stream);
        Improver(finite, path, options.is_over).run();
        const double time = path_time(finite, path);
        if (time < least - 1e-12) {
            best = std::move(path);
            least = time;
        }
    }
    return to_order(times, best);
}

VisitingOrder random_order(const MatrixXd& times, const VisitingOrder& shortest, double factor,
                           const OrderOptions& options) {
    const MatrixXd finite = penalise(times);
    const Index last = times.rows() - 1;
    // Streams of kicks have small numbers.
    RandomStream stream(options.seed, std::uint64_t{1} << 32);
    Path path(static_cast<std::size_t>(times.rows()));
    std::iota(path.begin(), path.end(), Index{0});
    for (auto end = path.end() - 1; end > path.begin() + 1; --end) {
        std::iter_swap(end, path.begin() + 1 + stream.index(end - path.begin()));
    }
    const auto leg = [&](Index from, Index to) {
        return to > last ? 0
                         : finite(path[static_cast<std::size_t>(from)],
                                  path[static_cast<std::size_t>(to)]);
    };
    const double most = factor * shortest.time;
    double time = path_time(finite, path);
    for (Index left = 100 * times.size(); time > most && left > 0; --left) {
        if (options.is_over && options.is_over()) return shortest;
        const Index a = stream.index(last) + 1;
        const Index b = stream.index(last) + 1;
        const auto [i, j] = std::minmax(a, b);
        const double end = j < last ? leg(i, j + 1) : 0;
        if (!(leg(i - 1, j) + end < leg(i - 1, i) + leg(j, j + 1))) continue;
        std::reverse(path.begin() + i, path.begin() + j + 1);
        time = path_time(finite, path);
    }
    return time > most ? shortest : to_order(times, path);
}

}  // namespace posewise::detail
