#include "../../src/report/table.hpp"

#include <gtest/gtest.h>

namespace posewise {
namespace {

using namespace detail;

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

}  // namespace
}  // namespace posewise
