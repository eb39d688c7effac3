#include "../../src/selection/neighbourhood.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;
using test::indices_below;

TEST(Neighbourhood, NearestAreThoseThatLoseLeastInThePlaceOfAnyPose) {
    for (const Criterion criterion : {Criterion::D, Criterion::O1, Criterion::A, Criterion::V}) {
        const Blocks candidates = test::random_blocks(60, 3, 10, 1);
        const Objective objective = make_objective(criterion, 8, &candidates);
        const Shortlist shortlist = make_shortlist(candidates, indices_below(60));
        const StopSignal stop;
        Neighbourhood neighbourhood(objective, candidates, shortlist, 8, stop);
        const std::vector<Index> poses = indices_below(8);
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
        std::vector<Index> expected = indices_below(60);
        std::sort(expected.begin(), expected.end(), [&](Index a, Index b) {
            return best[static_cast<std::size_t>(a)] > best[static_cast<std::size_t>(b)];
        });
        expected.resize(25);
        std::sort(expected.begin(), expected.end());
        EXPECT_EQ(neighbourhood.nearest(poses, 25), expected);
        EXPECT_EQ(neighbourhood.nearest(poses, 100), indices_below(60));
    }
}

}  // namespace
}  // namespace posewise
