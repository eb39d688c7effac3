#include "../../src/core/format.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace posewise {
namespace {

using namespace detail;

TEST(FormatMm, PrintsMillimetresAndNoNegativeZero) {
    EXPECT_EQ(format_mm(1.23456e-3), "1.2346");
    EXPECT_EQ(format_mm(-1e-9), "0.0000");
    EXPECT_EQ(format_mm(-2e-3, 1), "-2.0");
}

TEST(FormatFixed, ShowsADashForNoNumber) {
    EXPECT_EQ(format_fixed(std::numeric_limits<double>::quiet_NaN(), 2), "-");
}

TEST(FormatShort, LeavesOutTrailingZeros) {
    EXPECT_EQ(format_short(0.05), "0.05");
    EXPECT_EQ(format_short(-std::numeric_limits<double>::infinity()), "-inf");
}

}  // namespace
}  // namespace posewise
