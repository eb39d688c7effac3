#include "../../src/core/statistics.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "posewise/core/random.hpp"

namespace posewise {
namespace {

using namespace detail;

using enum QuantileRule;

VectorXd numbers(std::initializer_list<double> values) {
    return Eigen::Map<const VectorXd>(values.begin(), static_cast<Index>(values.size()));
}

TEST(Quantile, OfAnEvenCountDependsOnTheRule) {
    const VectorXd four = numbers({40, 10, 30, 20});
    EXPECT_EQ(quantile(four, 0.5, Lower), 20);
    EXPECT_EQ(quantile(four, 0.5, Upper), 30);
    EXPECT_EQ(quantile(four, 0.5, Linear), 25);
}

TEST(Quantile, OfAnOddCountIsTheMiddleByEveryRule) {
    const VectorXd five = numbers({5, 1, 4, 2, 3});
    for (const auto rule : {Lower, Upper, Linear}) EXPECT_EQ(quantile(five, 0.5, rule), 3);
}

TEST(Quantile, AtTheEndsIsTheExtremes) {
    const VectorXd three = numbers({2, 3, 1});
    for (const auto rule : {Lower, Upper, Linear}) {
        EXPECT_EQ(quantile(three, 0, rule), 1);
        EXPECT_EQ(quantile(three, 1, rule), 3);
        EXPECT_EQ(quantile(numbers({7}), 0.3, rule), 7);
    }
}

TEST(Quantile, InterpolatesAsTheNumbersLie) {
    EXPECT_DOUBLE_EQ(quantile(numbers({0, 1, 3}), 0.75, Linear), 2);
    EXPECT_DOUBLE_EQ(quantile(numbers({0, 1, 3}), 0.25, Linear), 0.5);
}

TEST(Quantile, TakesInfiniteNumbersAsTheLargest) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const VectorXd four = numbers({infinity, 1, 2, 3});
    EXPECT_EQ(quantile(four, 2.0 / 3, Linear), 3);
    EXPECT_EQ(quantile(four, 0.7, Linear), infinity);
    EXPECT_EQ(quantile(numbers({infinity, infinity}), 0.5, Linear), infinity);
}

/// By quantile(), and by quantile_of_many() with at most seven in memory.
void expect_same_quantiles(const VectorXd& all) {
    const VisitNumbers visit = [&](const std::function<void(double)>& visitor) {
        for (const double x : all) visitor(x);
    };
    for (const double p : {0.0, 0.1, 0.25, 0.5, 0.777, 0.95, 1.0}) {
        const double expected = quantile(all, p, Linear);
        EXPECT_EQ(quantile_of_many(visit, p, 7), expected) << all.size() << " numbers, " << p;
        EXPECT_EQ(quantile_of_many(visit, p), expected);
    }
}

TEST(QuantileOfMany, IsTheSameWithFewInMemory) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    RandomStream stream(3);
    for (const Index count : {1, 7, 8, 9, 100, 3001}) {
        expect_same_quantiles(stream.normals(count));                           // of both signs
        expect_same_quantiles((1e-4 + 1e-12 * stream.normals(count).array()));  // close together
        expect_same_quantiles(stream.normals(count).array().round());           // with ties
        VectorXd all = stream.normals(count).array().abs().exp();
        for (Index i = 0; i < count; i += 3) all[i] = infinity;
        expect_same_quantiles(all);
        expect_same_quantiles(VectorXd::Constant(count, 0.3));
        expect_same_quantiles(VectorXd::Constant(count, infinity));
    }
    expect_same_quantiles(numbers({0, -0.0, 0, -0.0, 1, -1, -0.0, 0, 0, -2}));
}

TEST(QuantileOfMany, IsNothingOfNone) {
    EXPECT_FALSE(quantile_of_many([](const std::function<void(double)>&) {}, 0.5));
}

TEST(DistributionQuantile, IsThatOfTables) {
    EXPECT_NEAR(student_quantile(0.975, 10), 2.2281388520, 1e-9);
    EXPECT_NEAR(student_quantile(0.025, 4), -2.7764451052, 1e-9);
    EXPECT_NEAR(chi_squared_quantile(0.95, 5), 11.0704976935, 1e-9);
    EXPECT_NEAR(chi_squared_quantile(0.05, 2.5), 0.2101, 2e-3);
}

TEST(MixtureQuantile, IsThatOfItsPartsTogether) {
    EXPECT_NEAR(mixture_quantile(0.95, {{6, 3}}), 6 * 7.8147279033 / 3, 1e-8);
    EXPECT_NEAR(mixture_quantile(0.95, {{6, 3}}, 10), 6 * 3.7082648190, 1e-8);
    // Of a small and a large one alike, that of the large alone at 90 %; of nothing and one at all.
    EXPECT_NEAR(mixture_quantile(0.95, {{1e-6, 3}, {6, 3}}), 6 * 6.2513886311 / 3, 1e-8);
    EXPECT_NEAR(mixture_quantile(0.95, {{0, 1}, {6, 3}}), 6 * 6.2513886311 / 3, 1e-8);
    EXPECT_EQ(mixture_quantile(0.95, {{0, 1}}), 0);
}

}  // namespace
}  // namespace posewise
