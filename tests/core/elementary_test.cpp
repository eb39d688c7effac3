#include "../../src/core/elementary.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "posewise/core/random.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr double epsilon = std::numeric_limits<double>::epsilon();
constexpr double infinity = std::numeric_limits<double>::infinity();

/// To one unit in the last place of the result.
void expect_same(double found, double expected) {
    EXPECT_NEAR(found, expected, epsilon * std::abs(expected)) << expected;
}

TEST(Elementary, AgreesWithTheLibraryToAUnitInTheLastPlace) {
    RandomStream random(1, 0);
    for (int i = 0; i < 100000; ++i) {
        const double size = std::pow(10, random.uniform(-9, 4));
        const double x = size * random.uniform(-1, 1);
        const double y = std::pow(10, random.uniform(-9, 4)) * random.uniform(-1, 1);
        expect_same(sine_and_cosine(x).sine, std::sin(x));
        expect_same(sine_and_cosine(x).cosine, std::cos(x));
        expect_same(logarithm(std::abs(x)), std::log(std::abs(x)));
        expect_same(exponential(x / 20), std::exp(x / 20));
        expect_same(arc_tangent(y, x), std::atan2(y, x));
        const double exponent = random.uniform(-8, 8);
        EXPECT_NEAR(power(size, exponent) / std::pow(size, exponent), 1, 1e-13);
    }
}

TEST(Elementary, IsExactWhereItCanBe) {
    EXPECT_EQ(sine_and_cosine(0).sine, 0);
    EXPECT_EQ(sine_and_cosine(0).cosine, 1);
    EXPECT_EQ(sine_and_cosine(std::numbers::pi / 2).sine, 1);
    expect_same(sine_and_cosine(std::numbers::pi).sine, std::sin(std::numbers::pi));
    EXPECT_EQ(logarithm(1), 0);
    EXPECT_EQ(logarithm(0), -infinity);
    EXPECT_TRUE(std::isnan(logarithm(-1)));
    expect_same(logarithm(4e-310), std::log(4e-310));
    EXPECT_EQ(exponential(0), 1);
    EXPECT_EQ(exponential(-infinity), 0);
    EXPECT_EQ(exponential(1000), infinity);
    EXPECT_EQ(power(0, 2), 0);
    EXPECT_EQ(power(5, 0), 1);
    EXPECT_EQ(power(4, -infinity), 0);
    EXPECT_EQ(arc_tangent(0, 1), 0);
    EXPECT_EQ(arc_tangent(0, -1), std::numbers::pi);
    EXPECT_EQ(arc_tangent(-0.0, -1), -std::numbers::pi);
    EXPECT_EQ(arc_tangent(1, 0), std::numbers::pi / 2);
    EXPECT_EQ(arc_tangent(0, 0), 0);
}

}  // namespace
}  // namespace posewise
