#include "../../src/selection/rayleigh_ritz.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

/// Exchanges of one of the first K candidates for any other, and their values.
struct Exchanges {
    Blocks candidates;
    Objective objective;
    std::vector<Index> members;
    Index removed = 2;
    MatrixXd M;

    Exchanges(Criterion criterion, Index parameters, std::uint64_t seed)
        : candidates(test::random_blocks(40, 2, parameters, seed)),
          objective(make_objective(criterion, parameters)),
          members(40) {
        std::iota(members.begin(), members.end(), Index{0});
        std::vector<Index> plan(members.begin(), members.begin() + parameters);
        M = information(candidates, plan);
    }
    double value_with(Index added) const {
        const auto out = candidates[removed];
        const auto in = candidates[added];
        return evaluate(objective, M - out.transpose() * out + in.transpose() * in);
    }
};

constexpr Criterion extremes[] = {Criterion::E, Criterion::O3, Criterion::O2, Criterion::O4};

TEST(RayleighRitz, NeverRulesOutAnExchangeThatImproves) {
    Index ruled_out = 0;
    for (const Criterion criterion : extremes) {
        for (std::uint64_t seed = 0; seed < 10; ++seed) {
            const Exchanges exchanges(criterion, 12, seed);  // more than it keeps of the spectrum
            RayleighRitz ritz(exchanges.objective, exchanges.candidates, exchanges.members);
            ritz.move_to(exchanges.M);
            ritz.remove(exchanges.removed);
            const double value = evaluate(exchanges.objective, exchanges.M);
            for (Index i = 0; i < 40; ++i) {
                const bool may_exceed = ritz.may_exceed(i, value);
                if (exchanges.value_with(i) > value * (1 + 1e-9)) {
                    EXPECT_TRUE(may_exceed);
                }
                ruled_out += !may_exceed;
            }
        }
    }
    EXPECT_GT(ruled_out, 400);  // of 1600: it is of use
}

TEST(RayleighRitz, IsExactForTheLeastEigenvalueOfASmallMatrix) {
    for (const Criterion criterion : {Criterion::E, Criterion::O3}) {
        const Exchanges exchanges(criterion, 6, 3);
        RayleighRitz ritz(exchanges.objective, exchanges.candidates, exchanges.members);
        ritz.move_to(exchanges.M);
        ritz.remove(exchanges.removed);
        for (Index i = 0; i < 40; ++i) {
            const double value = exchanges.value_with(i);
            if (!(value > 1e-6)) continue;
            EXPECT_TRUE(ritz.may_exceed(i, value * (1 - 1e-8)));
            EXPECT_FALSE(ritz.may_exceed(i, value * (1 + 1e-8)));
        }
    }
}

TEST(RayleighRitz, RulesOutNothingFromAPlanThatIsSingular) {
    const Exchanges exchanges(Criterion::E, 6, 4);
    RayleighRitz ritz(exchanges.objective, exchanges.candidates, exchanges.members);
    ritz.move_to(exchanges.M);
    ritz.remove(exchanges.removed);
    for (Index i = 0; i < 40; ++i) {
        EXPECT_TRUE(ritz.may_exceed(i, -std::numeric_limits<double>::infinity()));
    }
}

}  // namespace
}  // namespace posewise
