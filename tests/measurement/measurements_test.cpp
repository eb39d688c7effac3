#include "posewise/measurement/measurements.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "posewise/measurement/sensors.hpp"

namespace posewise {
namespace {

const DistanceSensor two_lengths(Targets({std::nullopt, std::nullopt}), {Vector3d::Zero()}, true,
                                 1e-5);
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Configurations a (2 samples), b (1), c (3) of one joint; two targets of one number each.
Measurements small_campaign() {
    Measurements measurements;
    measurements.configurations = Eigen::Vector3d(0.1, 0.2, 0.3);
    measurements.ids = {"a", "b", "c"};
    measurements.first_sample = {0, 2, 3, 6};
    measurements.observations.resize(6, 2);
    measurements.observations << 1, 10, 3, 10,  // a
        5, 20,                                  // b
        0, 0, 3, 0, 6, 3;                       // c
    measurements.is_seen.setConstant(6, 2, true);
    return measurements;
}

/// The second target is seen nowhere at b; at c the first is missing once, the second twice.
Measurements with_gaps() {
    Measurements measurements = small_campaign();
    for (const auto& [sample, target] :
         std::vector<std::pair<Index, Index>>{{2, 1}, {3, 0}, {3, 1}, {5, 1}}) {
        measurements.is_seen(sample, target) = false;
        measurements.observations(sample, target) = nan;
    }
    return measurements;
}

TEST(MeanMeasurements, AverageTheSamplesOfEachConfiguration) {
    RowMatrixXd expected(3, 2);
    expected << 2, 10, 5, 20, 3, 1;
    const Measurements means = mean_measurements(two_lengths, small_campaign());
    EXPECT_EQ(means.observations, expected);
    EXPECT_TRUE(means.is_seen.all());
    EXPECT_EQ(means.first_sample, (std::vector<Index>{0, 1, 2, 3}));
    EXPECT_EQ(means.ids, small_campaign().ids);
    EXPECT_EQ(means.configurations, small_campaign().configurations);
}

TEST(MeanMeasurements, AverageEachTargetOverTheSamplesThatShowIt) {
    const Measurements means = mean_measurements(two_lengths, with_gaps());
    EXPECT_EQ(means.observations, (RowMatrixXd{{2, 10}, {5, 0}, {4.5, 0}}));
    EXPECT_TRUE((means.is_seen == Seen{{true, true}, {true, false}, {true, true}}).all());
}

TEST(TimesSeen, CountTheSamplesThatShowEachTarget) {
    EXPECT_EQ(times_seen(with_gaps()), (RowMatrixXd{{2, 2}, {1, 0}, {2, 1}}));
    EXPECT_EQ(share_seen(with_gaps()), (RowMatrixXd{{1, 1}, {1, 0}, {2.0 / 3, 1.0 / 3}}));
    EXPECT_EQ(share_seen(small_campaign()), RowMatrixXd(RowMatrixXd::Ones(3, 2)));
}

TEST(Repeatability, PoolsTheScatterAboutEachMean) {
    // a: 1 + 1; c: 9 + 9 and 1 + 1 + 4; degrees of freedom 2 (1 + 2).
    EXPECT_DOUBLE_EQ(repeatability(two_lengths, small_campaign())->length, std::sqrt(26.0 / 6.0));
}

TEST(Repeatability, PoolsWhatWasSeenOnly) {
    // a: 1 + 1, 2 degrees of freedom; c: 1.5^2 twice, 1 of the first target, none of the second.
    EXPECT_DOUBLE_EQ(repeatability(two_lengths, with_gaps())->length, std::sqrt(6.5 / 3));
}

TEST(Repeatability, IsUnknownWithoutRepeats) {
    Measurements in_turns = take(small_campaign(), {0});  // each target once
    in_turns.is_seen << true, false, false, true;
    EXPECT_FALSE(repeatability(two_lengths, in_turns).has_value());
    EXPECT_FALSE(repeatability(two_lengths, take(small_campaign(), {1})).has_value());
    EXPECT_FALSE(repeatability(two_lengths, Measurements{}).has_value());
}

TEST(TakeMeasurements, KeepsTheOrderAskedFor) {
    const Measurements all = small_campaign();
    const Measurements taken = take(all, {2, 0});
    EXPECT_EQ(taken.ids, (std::vector<std::string>{"c", "a"}));
    EXPECT_EQ(taken.first_sample, (std::vector<Index>{0, 3, 5}));
    EXPECT_EQ(taken.configurations, Eigen::Vector2d(0.3, 0.1));
    EXPECT_EQ(taken.observations.topRows(3), all.observations.bottomRows(3));
    EXPECT_EQ(taken.observations.bottomRows(2), all.observations.topRows(2));
    const Seen seen = with_gaps().is_seen;
    EXPECT_TRUE((take(with_gaps(), {2, 0}).is_seen.topRows(3) == seen.bottomRows(3)).all());
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
