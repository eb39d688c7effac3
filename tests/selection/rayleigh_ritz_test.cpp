#include "../../src/selection/rayleigh_ritz.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

/// Exchanges of one of the first K candidates for any other, and their values.
struct Exchanges {
    Blocks candidates;
    Objective objective;
    Shortlist shortlist;
    Index removed = 2;
    MatrixXd M;
    RayleighRitz ritz;

    Exchanges(Criterion criterion, Index rows, Index parameters, std::uint64_t seed)
        : candidates(test::random_blocks(41, rows, parameters, seed)),  // the last lanes not full
          objective(make_objective(criterion, parameters)),
          shortlist(make_shortlist(candidates, test::indices_below(41))),
          M(information(candidates, test::indices_below(parameters))),
          ritz(objective, candidates, shortlist) {
        ritz.move_to(M);
        ritz.remove(removed);
    }
    MatrixXd with(Index added) const {
        const auto out = candidates[removed];
        const auto in = candidates[added];
        return M - out.transpose() * out + in.transpose() * in;
    }
    bool surely_exceeds(Index added) {
        const auto out = candidates[removed];
        return !ritz.exceeding(M - out.transpose() * out, {added}).empty();
    }
    double value_with(Index added) const { return evaluate(objective, with(added)); }
};

constexpr Criterion extremes[] = {Criterion::E, Criterion::O3, Criterion::O2, Criterion::O4};

TEST(RayleighRitz, NeverRulesOutAnExchangeThatImproves) {
    Index ruled_out = 0;
    Index ruled_out_of_the_rest = 0;
    for (const Index rows : {2, 13}) {  // with a kernel, and too high for any
        for (const Criterion criterion : extremes) {
            for (std::uint64_t seed = 0; seed < 10; ++seed) {
                Exchanges exchanges(criterion, rows, 12, seed);  // more than it keeps of a spectrum
                const double value = evaluate(exchanges.objective, exchanges.M);
                exchanges.ritz.ask(value);
                for (Index i = 0; i < 41; ++i) {
                    const bool may_exceed = exchanges.ritz.may_exceed(i);
                    const bool surely = exchanges.surely_exceeds(i);
                    if (exchanges.value_with(i) > value) {
                        EXPECT_TRUE(may_exceed && surely);
                    }
                    ruled_out += !may_exceed;
                    ruled_out_of_the_rest += may_exceed && !surely;
                }
            }
        }
    }
    EXPECT_GT(ruled_out, 800);  // of 3280: it is of use
    EXPECT_GT(ruled_out_of_the_rest, 0);
}

TEST(RayleighRitz, IsExactForTheLeastEigenvalueOfASmallMatrix) {
    for (const Criterion criterion : {Criterion::E, Criterion::O3}) {
        Exchanges exchanges(criterion, 2, 6, 3);
        for (Index i = 0; i < 41; ++i) {
            const double value = exchanges.value_with(i);
            if (!(value > 1e-6)) continue;
            exchanges.ritz.ask(value * (1 - 1e-8));
            EXPECT_TRUE(exchanges.ritz.may_exceed(i));
            exchanges.ritz.ask(value * (1 + 1e-8));
            EXPECT_FALSE(exchanges.ritz.may_exceed(i));
        }
    }
}

TEST(RayleighRitz, FactorisesToDecideWhatIsLeft) {
    for (const Criterion criterion : {Criterion::E, Criterion::O3}) {
        Exchanges exchanges(criterion, 2, 12, 3);
        for (Index i = 0; i < 41; ++i) {
            const double value = exchanges.value_with(i);
            if (!(value > 1e-6)) continue;
            exchanges.ritz.ask(value * (1 + 1e-8));
            EXPECT_FALSE(exchanges.surely_exceeds(i));
        }
    }
}

TEST(RayleighRitz, FactorisesSeveralExchangesAsItDoesOne) {
    for (const Criterion criterion : extremes) {
        Exchanges exchanges(criterion, 2, 12, 3);
        exchanges.ritz.ask(exchanges.value_with(17));
        std::vector<Index> alone;
        for (Index i = 11; i < 19; ++i) {
            if (exchanges.surely_exceeds(i)) alone.push_back(i);
        }
        const auto out = exchanges.candidates[exchanges.removed];
        const std::vector<Index> together = exchanges.ritz.exceeding(
            exchanges.M - out.transpose() * out, {11, 12, 13, 14, 15, 16, 17, 18});
        EXPECT_EQ(together, alone);
        EXPECT_GT(together.size(), 0u);
        EXPECT_LT(together.size(), 8u);
    }
}

TEST(RayleighRitz, RulesOutNothingFromAPlanThatIsSingular) {
    Exchanges exchanges(Criterion::E, 2, 6, 4);
    exchanges.ritz.ask(-std::numeric_limits<double>::infinity());
    for (Index i = 0; i < 41; ++i) {
        EXPECT_TRUE(exchanges.ritz.may_exceed(i));
        EXPECT_TRUE(exchanges.surely_exceeds(i));
    }
}

}  // namespace
}  // namespace posewise
