#include <gtest/gtest.h>

#include "posewise/core/types.hpp"

namespace posewise {
namespace {

TEST(UnitsOf, SayHowAnAmountIsWrittenAndRead) {
    const AmountUnits& length = units_of(false);
    EXPECT_EQ(length.si, "m");
    EXPECT_EQ(length.reading, "mm");
    EXPECT_EQ(length.error, "mm");
    EXPECT_EQ(length.to_reading(0.25), 250);
    EXPECT_EQ(length.to_si(250), 0.25);

    const AmountUnits& angle = units_of(true);
    EXPECT_EQ(angle.si, "rad");
    EXPECT_EQ(angle.reading, "deg");
    EXPECT_EQ(angle.error, "mrad");
    EXPECT_DOUBLE_EQ(angle.to_reading(1), 57.295779513082323);
    EXPECT_DOUBLE_EQ(angle.to_si(180), std::numbers::pi);
}

TEST(ToDegrees, IsTheInverseOfToRadians) {
    EXPECT_EQ(to_degrees(std::numbers::pi), 180);
    EXPECT_DOUBLE_EQ(to_degrees(to_radians(12.5)), 12.5);
}

}  // namespace
}  // namespace posewise
