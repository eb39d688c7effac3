#include "../../src/model/exact_angles.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "support/robots.hpp"

namespace posewise::detail {
namespace {

TEST(ExactAngles, TakesRoundedQuarterTurnsForWhatTheyMean) {
    constexpr double quarter = std::numbers::pi / 2;
    const Element drive = testing::driven(Motion::Rotation, Axis::Z, 0);
    const Chain rounded(
        {{"q1", -1, 1}},
        {testing::rotation(Axis::X, 1.570796), drive, testing::rotation(Axis::Y, -3.1415926535),
         testing::rotation(Axis::Z, 3e-7), testing::rotation(Axis::X, 1.5708),
         testing::translation(Axis::X, 1e-7), testing::rotation(Axis::X, quarter),
         testing::rotation(Axis::Y, quarter - 9.66906e-7)});
    const ExactAngles exact = with_exact_angles(rounded);
    const std::vector<Element>& elements = exact.chain.elements();
    EXPECT_EQ(exact.count, 3);
    EXPECT_EQ(elements[0].value, quarter);
    EXPECT_EQ(elements[2].value, -2 * quarter);
    EXPECT_EQ(elements[3].value, 0);
    EXPECT_EQ(elements[4].value, 1.5708) << "4 urad are no rounding";
    EXPECT_EQ(elements[5].value, 1e-7) << "a length has no special values";
    EXPECT_EQ(elements[6].value, quarter);
    EXPECT_EQ(elements[7].value, quarter - 9.66906e-7) << "of a robot that was calibrated";
}

}  // namespace
}  // namespace posewise::detail
