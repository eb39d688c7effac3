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

TEST(FormatTable, GoesOnBelowWhereTheLastTextIsLong) {
    const std::string ten = "123456789 ";
    std::string words;
    for (int k = 0; k < 12; ++k) words += ten;
    const std::string text =
        format_table({{"parameter", "absorbed by"}, {{"Tx1", words + "end"}, {"Ty1", "a"}}});
    // 11 characters of the first column leave 89: nine words of nine and the blanks between.
    const std::string nine = words.substr(0, 89);
    EXPECT_EQ(text, "parameter  absorbed by\n---------  " + std::string(89, '-') + "\nTx1        " +
                        nine + "\n           " + words.substr(0, 30) + "end\nTy1        a\n");
}

TEST(FormatTable, OfNothingIsItsHeader) { EXPECT_EQ(format_table({{"a"}, {}}), "a\n-\n"); }

}  // namespace
}  // namespace posewise
