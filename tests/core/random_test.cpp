#include "posewise/core/random.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <vector>

#include "../../src/core/simd.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

/// SplitMix64's, as in src/core/random.cpp.
std::uint64_t mix(std::uint64_t x) {
    x += 0x9e3779b97f4a7c15ULL;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
    return x ^ (x >> 31);
}

TEST(RandomStream, HasTheNumbersOfTheStandardLibrarysEngine) {
    for (const std::uint64_t seed : {0ULL, 1ULL, 5489ULL, ~0ULL}) {
        RandomStream ours(seed, 2);
        std::mt19937_64 theirs(mix(mix(seed) + 2));
        for (int i = 0; i < 1000; ++i) {  // thrice its state
            const double expected = static_cast<double>(theirs() >> 11) * 0x1.0p-53;
            ASSERT_EQ(ours.uniform(), expected) << seed << ", number " << i;
        }
    }
}

TEST(RandomStream, DrawsManyNormalNumbersAsItDrawsOneByOne) {
    const int all = detail::simd::widest();
    for (int width = 2; width <= all; width *= 2) {
        detail::simd::use_width(width);
        RandomStream together(9, 4);
        RandomStream one_by_one(9, 4);
        for (const Index count : {Index{0}, Index{1}, Index{9}, Index{64}, Index{5000}}) {
            for (const double z : together.normals(count)) ASSERT_EQ(z, one_by_one.normal());
        }
        EXPECT_EQ(together.uniform(), one_by_one.uniform());
    }
    detail::simd::use_width(all);
}

TEST(RandomStream, DrawsManyUniformNumbersAsItDrawsOneByOne) {
    RandomStream together(9, 4);
    RandomStream one_by_one(9, 4);
    // So that they begin and end before, at and after each half of a state of 312.
    for (const std::size_t count : {1, 0, 155, 1, 154, 2, 311, 312, 313, 1000, 7}) {
        std::vector<double> numbers(count);
        together.fill_uniform(numbers);
        for (const double x : numbers) ASSERT_EQ(x, one_by_one.uniform()) << count;
    }
    EXPECT_EQ(together.uniform(), one_by_one.uniform());
}

TEST(RandomStream, OfFourItemsAreThoseOfEach) {
    std::array<RandomStream, 4> four = RandomStream::of_four_items(7, 5);
    for (std::size_t k = 0; k < 4; ++k) {
        RandomStream alone(7, 5 + k);
        for (int i = 0; i < 400; ++i) ASSERT_EQ(four[k].uniform(), alone.uniform()) << k;
    }
}

TEST(RandomStream, GivesTheGoldenNumbers) {  // tests/golden/random_stream.py
    RandomStream first(1, 0);
    EXPECT_EQ(first.uniform(), 0.4414916744462515);
    EXPECT_EQ(first.uniform(), 0.328402287217625);
    EXPECT_EQ(first.uniform(), 0.7444413221699605);
    EXPECT_EQ(RandomStream(1, 1).uniform(), 0.7166913209529362);
    EXPECT_EQ(RandomStream(2, 0).uniform(), 0.14270186193336576);
}

TEST(RandomStream, OfAnItemDoesNotDependOnTheOthers) {
    RandomStream alone(7, 3);
    const double expected = alone.uniform();
    std::vector<RandomStream> streams;
    for (std::uint64_t item = 0; item < 5; ++item) streams.emplace_back(7, item);
    for (std::size_t item : {4U, 0U, 2U}) streams[item].uniform();
    EXPECT_EQ(streams[3].uniform(), expected);
}

TEST(RandomStream, DiffersForNearbySeedsAndItems) {
    std::set<double> seen;
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        for (std::uint64_t item = 0; item < 30; ++item) {
            seen.insert(RandomStream(seed, item).uniform());
        }
    }
    EXPECT_EQ(seen.size(), 900U);
}

TEST(RandomStream, FirstNumbersOfManyItemsAreUniform) {
    // Chi-square over 20 cells has mean 19 and standard deviation 6.2; 50 is the 99.99 % point.
    const Index count = 20000;
    std::vector<double> cells(20, 0.0);
    for (Index item = 0; item < count; ++item) {
        const double x = RandomStream(11, static_cast<std::uint64_t>(item)).uniform(-1, 3);
        ASSERT_GE(x, -1);
        ASSERT_LT(x, 3);
        ++cells[static_cast<std::size_t>((x + 1) * 5)];
    }
    double chi_square = 0;
    for (const double cell : cells) chi_square += std::pow(cell - 1000, 2) / 1000;
    EXPECT_LT(chi_square, 50);
    EXPECT_GT(chi_square, 3);
}

TEST(RandomStream, NormalNumbersHaveTheMomentsOfTheNormalDistribution) {
    RandomStream stream(5);
    const Index count = 100000;
    double sum = 0, squares = 0, fourths = 0;
    for (Index k = 0; k < count; ++k) {
        const double z = stream.normal();
        ASSERT_TRUE(std::isfinite(z));
        sum += z;
        squares += z * z;
        fourths += z * z * z * z;
    }
    const double n = static_cast<double>(count);
    EXPECT_NEAR(sum / n, 0, 4 / std::sqrt(n));
    EXPECT_NEAR(squares / n, 1, 4 * std::sqrt(2 / n));
    EXPECT_NEAR(fourths / n, 3, 4 * std::sqrt(96 / n));
}

TEST(RandomStream, IndexReachesEveryValueEquallyOften) {
    RandomStream stream(3);
    std::map<Index, int> counts;
    for (int k = 0; k < 7000; ++k) ++counts[stream.index(7)];
    ASSERT_EQ(counts.size(), 7U);
    for (const auto& [value, count] : counts) {
        EXPECT_GE(value, 0);
        EXPECT_LT(value, 7);
        EXPECT_NEAR(count, 1000, 130);  // 4.4 standard deviations
    }
}

TEST(RandomStream, SubsetHoldsDifferentSortedIndices) {
    RandomStream stream(9);
    for (Index sweep = 0; sweep < testing::sweep_count(); ++sweep) {
        const Index count = 1 + stream.index(20);
        const Index k = stream.index(count + 1);
        const std::vector<Index> subset = stream.subset(count, k);
        ASSERT_EQ(static_cast<Index>(subset.size()), k);
        for (std::size_t i = 0; i < subset.size(); ++i) {
            ASSERT_GE(subset[i], i == 0 ? 0 : subset[i - 1] + 1);
            ASSERT_LT(subset[i], count);
        }
    }
}

TEST(RandomStream, EverySubsetIsEquallyLikely) {
    RandomStream stream(13);
    std::map<std::vector<Index>, int> counts;
    for (int k = 0; k < 6000; ++k) ++counts[stream.subset(4, 2)];
    ASSERT_EQ(counts.size(), 6U);
    for (const auto& [subset, count] : counts) EXPECT_NEAR(count, 1000, 130);
}

}  // namespace
}  // namespace posewise
