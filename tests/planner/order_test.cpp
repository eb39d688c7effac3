#include "../../src/planner/order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "posewise/core/errors.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr double no_limit = std::numeric_limits<double>::infinity();

/// Chebyshev times between random points in six dimensions.
MatrixXd random_times(RandomStream& stream, Index poses) {
    MatrixXd points(6, poses + 1);
    for (double& x : points.reshaped()) x = stream.uniform();
    MatrixXd times(poses + 1, poses + 1);
    for (Index i = 0; i <= poses; ++i) {
        for (Index j = 0; j <= poses; ++j) {
            times(i, j) = (points.col(i) - points.col(j)).cwiseAbs().maxCoeff();
        }
    }
    return times;
}

/// The shortest open path by dynamic programming over subsets [Held & Karp 1962].
double exact_time(const MatrixXd& times) {
    const Index poses = times.rows() - 1;
    const std::size_t sets = std::size_t{1} << poses;
    // least(last, set): from the start through the poses of the set to `last`, one of them.
    MatrixXd least = MatrixXd::Constant(poses, static_cast<Index>(sets), no_limit);
    for (Index i = 0; i < poses; ++i) least(i, Index{1} << i) = times(0, i + 1);
    for (std::size_t set = 1; set < sets; ++set) {
        for (Index i = 0; i < poses; ++i) {
            const double here = least(i, static_cast<Index>(set));
            if (here == no_limit) continue;
            for (Index j = 0; j < poses; ++j) {
                const std::size_t larger = set | (std::size_t{1} << j);
                if (larger == set) continue;
                double& there = least(j, static_cast<Index>(larger));
                there = std::min(there, here + times(i + 1, j + 1));
            }
        }
    }
    return least.col(static_cast<Index>(sets - 1)).minCoeff();
}

bool is_permutation(std::vector<Index> poses, Index count) {
    std::sort(poses.begin(), poses.end());
    for (Index i = 0; i < count; ++i) {
        if (poses[static_cast<std::size_t>(i)] != i) return false;
    }
    return static_cast<Index>(poses.size()) == count;
}

/// Time of a path that starts at node 0 and visits the poses in this order.
double order_time(const MatrixXd& times, const std::vector<Index>& poses) {
    double time = 0;
    Index here = 0;
    for (const Index pose : poses) {
        time += times(here, pose + 1);
        here = pose + 1;
    }
    return time;
}

TEST(ShortestOrder, IsTheExactOneForFewPoses) {
    for (int i = 0; i < 30; ++i) {
        RandomStream stream(21, static_cast<std::uint64_t>(i));
        const MatrixXd times = random_times(stream, 3 + i % 10);
        const VisitingOrder order = shortest_order(times);
        EXPECT_TRUE(is_permutation(order.poses, times.rows() - 1));
        EXPECT_NEAR(order.time, order_time(times, order.poses), 1e-12);
        EXPECT_NEAR(order.time, exact_time(times), 1e-12) << times.rows() - 1 << " poses";
    }
}

TEST(ShortestOrder, IsNeverLongerThanNearestNeighbour) {
    for (int i = 0; i < 20; ++i) {
        RandomStream stream(22, static_cast<std::uint64_t>(i));
        const MatrixXd times = random_times(stream, stream.index(60));
        const VisitingOrder order = shortest_order(times, {20, 1, {}});
        EXPECT_TRUE(is_permutation(order.poses, times.rows() - 1));
        EXPECT_LE(order.time, nearest_neighbour_order(times).time + 1e-12);
    }
}

TEST(ShortestOrder, FollowsPosesOnALine) {
    VectorXd x(7);
    x << 0, 5, 1, 4, 2, 6, 3;  // the start at 0
    const MatrixXd times = (x.replicate(1, 7) - x.transpose().replicate(7, 1)).cwiseAbs();
    EXPECT_EQ(shortest_order(times).poses, (std::vector<Index>{1, 3, 5, 2, 0, 4}));
    EXPECT_EQ(shortest_order(times).time, 6);
    EXPECT_EQ(nearest_neighbour_order(times).poses, (std::vector<Index>{1, 3, 5, 2, 0, 4}));
}

TEST(ShortestOrder, AvoidsImpossibleMovesIfItCan) {
    RandomStream stream(23);
    MatrixXd times = random_times(stream, 9);
    for (int k = 0; k < 18; ++k) {
        const Index i = stream.index(10);
        const Index j = stream.index(10);
        if (i != j) times(i, j) = times(j, i) = no_limit;
    }
    const VisitingOrder order = shortest_order(times);
    EXPECT_TRUE(std::isfinite(order.time));
    EXPECT_NEAR(order.time, exact_time(times), 1e-12);
    times.row(4).setConstant(no_limit);
    times.col(4).setConstant(no_limit);
    times(4, 4) = 0;
    EXPECT_EQ(shortest_order(times).time, no_limit);
    EXPECT_TRUE(is_permutation(shortest_order(times).poses, 9));
}

/// Times of which sums are rounded by more than any gain: it ends, with the same order.
TEST(ShortestOrder, EndsForMovesOfAnyLength) {
    RandomStream stream(3);
    for (int k = 0; k < 20; ++k) {
        const MatrixXd times = random_times(stream, 14);
        const auto order = shortest_order(times, {});
        for (const double scale : {1e-6, 1e7, 1e200}) {
            const auto scaled = shortest_order(scale * times, {});
            EXPECT_NEAR(
                order_time(scale * times, scaled.poses) / order_time(scale * times, order.poses), 1,
                1e-9);
        }
    }
}

TEST(ShortestOrder, TakesNoPoseAndOnePose) {
    EXPECT_TRUE(shortest_order(MatrixXd::Zero(1, 1)).poses.empty());
    MatrixXd two(2, 2);
    two << 0, 3, 3, 0;
    EXPECT_EQ(shortest_order(two).poses, std::vector<Index>{0});
    EXPECT_EQ(shortest_order(two).time, 3);
}

TEST(ShortestOrder, RejectsTimesThatAreNone) {
    EXPECT_THROW(shortest_order(MatrixXd::Zero(0, 0)), InputError);
    EXPECT_THROW(shortest_order(MatrixXd::Zero(2, 3)), InputError);
    MatrixXd times(2, 2);
    times << 0, 1, 2, 0;
    EXPECT_THROW(shortest_order(times), InputError);
    EXPECT_THROW(shortest_order(-MatrixXd::Ones(2, 2)), InputError);
    EXPECT_THROW(nearest_neighbour_order(MatrixXd::Constant(2, 2, std::nan(""))), InputError);
}

TEST(RandomOrder, TakesAtMostSoManyTimesAsLongAsTheShortest) {
    RandomStream stream(17);
    for (const Index count : {0, 1, 2, 12, 40}) {
        const MatrixXd times = random_times(stream, count);
        const double shortest = shortest_order(times).time;
        EXPECT_EQ(random_order(times, shortest_order(times), 1).poses, shortest_order(times).poses);
        std::set<std::vector<Index>> orders;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            const OrderOptions options{.kicks = 20, .seed = seed};
            const VisitingOrder order =
                random_order(times, shortest_order(times, options), 1.5, options);
            EXPECT_TRUE(is_permutation(order.poses, count));
            EXPECT_LE(order.time, 1.5 * shortest_order(times, options).time);
            EXPECT_NEAR(order.time, order_time(times, order.poses), 1e-12);
            orders.insert(order.poses);
            EXPECT_GT(order.time, count == 40 ? 1.2 * shortest : -1);
        }
        EXPECT_EQ(orders.size(), count >= 12 ? 8U : orders.size());
    }
}

TEST(RandomOrder, DoesNotBeginWhereTheShortestDoes) {
    // Poses in a row, from the start on: the shortest order is their place.
    MatrixXd times(31, 31);
    for (Index i = 0; i < 31; ++i) {
        for (Index j = 0; j < 31; ++j) times(i, j) = static_cast<double>(std::abs(i - j));
    }
    double correlation = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
        const std::vector<Index> poses =
            random_order(times, shortest_order(times, {.seed = seed}), 3, {.seed = seed}).poses;
        VectorXd places(30);
        for (Index k = 0; k < 30; ++k)
            places[k] = static_cast<double>(poses[static_cast<std::size_t>(k)]);
        const VectorXd centred = places.array() - places.mean();
        const VectorXd rank = VectorXd::LinSpaced(30, -14.5, 14.5);
        correlation += centred.dot(rank) / (centred.norm() * rank.norm()) / 40;
    }
    EXPECT_LT(correlation, 0.75);  // 1 in the shortest order
}

}  // namespace
}  // namespace posewise
