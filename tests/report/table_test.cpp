#include "posewise/report/table.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "posewise/report/units.hpp"

namespace posewise {
namespace {

TEST(FormatTable, AlignsNumbersRightAndTextLeft) {
    const Table table{{"name", "RMS/mm"}, {{"x", "1.5"}, {"distance", "-"}, {"y", "-12.25"}}};
    EXPECT_EQ(format_table(table),
              "name      RMS/mm\n"
              "--------  ------\n"
              "x            1.5\n"
              "distance       -\n"
              "y         -12.25\n");
}

TEST(FormatTable, PadsShortRowsAndLeavesNoTrailingBlanks) {
    const Table table{{"a", "note"}, {{"1"}, {"2", "b"}}};
    EXPECT_EQ(format_table(table), "a  note\n-  ----\n1\n2  b\n");
}

TEST(FormatTable, OfNothingIsItsHeader) { EXPECT_EQ(format_table({{"a"}, {}}), "a\n-\n"); }

TEST(Units, PrintMillimetresAndNoNegativeZero) {
    EXPECT_EQ(format_mm(1.23456e-3), "1.2346");
    EXPECT_EQ(format_mm(-1e-9), "0.0000");
    EXPECT_EQ(format_mm(-2e-3, 1), "-2.0");
    EXPECT_EQ(format_fixed(std::numeric_limits<double>::quiet_NaN(), 2), "-");
    EXPECT_EQ(format_short(0.05), "0.05");
    EXPECT_EQ(format_short(-std::numeric_limits<double>::infinity()), "-inf");
    EXPECT_EQ(error_unit(true), "mrad");
    EXPECT_DOUBLE_EQ(to_degrees(1), 57.295779513082323);
}

}  // namespace
}  // namespace posewise
