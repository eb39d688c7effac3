#include "../../src/selection/recombination.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr Index group_count = 20;

/// Candidates of which two of a group may be chosen, and what plain exchanges from some random
/// choices end at.
struct Searched {
    explicit Searched(std::uint64_t seed) : candidates(test::random_blocks(200, 3, 40, seed)) {
        options.pose_count = 16;
        for (Index i = 0; i < 200; ++i) options.groups.push_back(i % group_count);
        options.group_limit = 2;
        shortlist = make_shortlist(candidates, test::indices_below(200));
        RandomStream random(seed);
        for (int start = 0; start < 6; ++start) {
            std::vector<Index> poses;
            for (Index k = 0; k < 16; ++k) poses.push_back(group_count * random.index(10) + k);
            const SearchScore score = problem.score(problem.regularised_information(poses));
            ends.push_back(improve(problem, shortlist, {poses, score}));
            if (best.poses.empty() || is_better(ends.back().score, best.score)) best = ends.back();
        }
    }

    Blocks candidates;
    SelectOptions options;
    Objective objective;
    SearchProblem problem{candidates, options, objective, MatrixXd::Zero(40, 40),
                          ridge_of(candidates)};
    Shortlist shortlist;
    std::vector<ScoredPoses> ends;
    ScoredPoses best;
};

TEST(Recombine, FindsBetterOnesBetweenTheEndsWithinTheLimits) {
    int improved = 0;
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
        const Searched search(seed);
        const SearchProblem& problem = search.problem;
        const ScoredPoses combined = recombine(problem, search.shortlist, search.best, search.ends);
        EXPECT_GE(combined.score.value, search.best.score.value);
        if (is_better(combined.score, search.best.score)) ++improved;
        ASSERT_EQ(combined.poses.size(), 16);
        std::vector<int> taken(group_count);
        for (const Index pose : combined.poses) {
            EXPECT_LE(++taken[static_cast<std::size_t>(pose % group_count)], 2);
        }
        const double value = problem.score(problem.regularised_information(combined.poses)).value;
        EXPECT_NEAR(combined.score.value, value, 1e-12 * value);
    }
    EXPECT_GE(improved, 4);
}

TEST(Recombine, LeavesTheBestWhereThereIsNothingToCross) {
    const Searched search(1);
    for (const std::vector<ScoredPoses>& ends :
         {std::vector<ScoredPoses>{}, {search.best}, {search.best, search.best}}) {
        EXPECT_EQ(recombine(search.problem, search.shortlist, search.best, ends).poses,
                  search.best.poses);
    }
}

}  // namespace
}  // namespace posewise
