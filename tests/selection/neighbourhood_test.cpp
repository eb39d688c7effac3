#include "../../src/selection/neighbourhood.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

std::vector<Index> candidates_below(Index count) {
    std::vector<Index> indices(static_cast<std::size_t>(count));
    std::iota(indices.begin(), indices.end(), Index{0});
    return indices;
}

TEST(Neighbourhood, NearestAreThoseThatLoseLeastInThePlaceOfAnyPose) {
    for (const Criterion criterion : {Criterion::D, Criterion::O1, Criterion::A, Criterion::V}) {
        const Blocks candidates = test::random_blocks(60, 3, 10, 1);
        const Objective objective = make_objective(criterion, 8, &candidates);
        const Shortlist shortlist = make_shortlist(candidates, candidates_below(60));
        const StopSignal stop;
        Neighbourhood neighbourhood(objective, candidates, shortlist, 8, stop);
        const std::vector<Index> poses = candidates_below(8);
        const MatrixXd M = information(candidates, poses);
        neighbourhood.move_to(M);
        std::vector<double> best(60, -1e300);
        for (Index i = 0; i < 60; ++i) {
            for (const Index pose : poses) {
                const MatrixXd exchanged = M - candidates[pose].transpose() * candidates[pose] +
                                           candidates[i].transpose() * candidates[i];
                double& largest = best[static_cast<std::size_t>(i)];
                largest = std::max(largest, evaluate(objective, exchanged));
            }
        }
        std::vector<Index> expected = candidates_below(60);
        std::sort(expected.begin(), expected.end(), [&](Index a, Index b) {
            return best[static_cast<std::size_t>(a)] > best[static_cast<std::size_t>(b)];
        });
        expected.resize(25);
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(neighbourhood.nearest(poses, 25), expected);
        EXPECT_EQ(neighbourhood.nearest(poses, 100), candidates_below(60));
    }
}

}  // namespace
}  // namespace posewise
