#include "posewise/measurement/measurements.hpp"

#include <gtest/gtest.h>

namespace posewise {
namespace {

/// Configurations a (2 samples), b (1), c (3) of one joint, two observed numbers.
Measurements small_campaign() {
    Measurements measurements;
    measurements.configurations = Eigen::Vector3d(0.1, 0.2, 0.3);
    measurements.ids = {"a", "b", "c"};
    measurements.first_sample = {0, 2, 3, 6};
    measurements.observations.resize(6, 2);
    measurements.observations << 1, 10, 3, 10,  // a
        5, 20,                                  // b
        0, 0, 3, 0, 6, 3;                       // c
    return measurements;
}

TEST(MeanObservations, AverageTheSamplesOfEachConfiguration) {
    RowMatrixXd expected(3, 2);
    expected << 2, 10, 5, 20, 3, 1;
    EXPECT_EQ(mean_observations(small_campaign()), expected);
}

TEST(Repeatability, PoolsTheScatterAboutEachMean) {
    // a: 1 + 1; c: 9 + 9 and 1 + 1 + 4; degrees of freedom 2 (1 + 2).
    EXPECT_DOUBLE_EQ(repeatability(small_campaign()).value(), std::sqrt(26.0 / 6.0));
}

TEST(Repeatability, IsUnknownWithoutRepeats) {
    EXPECT_FALSE(repeatability(take(small_campaign(), {1})).has_value());
    EXPECT_FALSE(repeatability(Measurements{}).has_value());
}

TEST(TakeMeasurements, KeepsTheOrderAskedFor) {
    const Measurements all = small_campaign();
    const Measurements taken = take(all, {2, 0});
    EXPECT_EQ(taken.ids, (std::vector<std::string>{"c", "a"}));
    EXPECT_EQ(taken.first_sample, (std::vector<Index>{0, 3, 5}));
    EXPECT_EQ(taken.configurations, Eigen::Vector2d(0.3, 0.1));
    EXPECT_EQ(taken.observations.topRows(3), all.observations.bottomRows(3));
    EXPECT_EQ(taken.observations.bottomRows(2), all.observations.topRows(2));
}

TEST(TakeMeasurements, OfNoneIsEmpty) {
    EXPECT_EQ(take(small_campaign(), {}).configuration_count(), 0);
}

TEST(AllBut, ListsTheOthersInOrder) {
    EXPECT_EQ(all_but(5, {3, 0}), (std::vector<Index>{1, 2, 4}));
    EXPECT_EQ(all_but(2, {}), (std::vector<Index>{0, 1}));
    EXPECT_TRUE(all_but(2, {1, 0}).empty());
}

}  // namespace
}  // namespace posewise
