#include "posewise/core/errors.hpp"

#include <gtest/gtest.h>

namespace posewise {
namespace {

TEST(InputErrorAt, PutsPathLineAndColumnInFront) {
    EXPECT_STREQ(input_error_at({"a.csv", 3, 14}, "text").what(), "a.csv:3:14: text");
    EXPECT_STREQ(input_error_at({"a.csv", 3, 0}, "text").what(), "a.csv:3: text");
    EXPECT_STREQ(input_error_at({"a.csv"}, "text").what(), "a.csv: text");
}

}  // namespace
}  // namespace posewise
