#include "../../src/core/text.hpp"

#include <gtest/gtest.h>

namespace posewise {
namespace {

using namespace detail;

TEST(EscapeControls, LeavesOneHarmlessLine) {
    EXPECT_EQ(escape_controls("a\nb\x1b[31m\x7f"), "a\\x0ab\\x1b[31m\\x7f");
    EXPECT_EQ(escape_controls("\u00b5m"), "\u00b5m");
    EXPECT_EQ(escape_controls("a\u009b31m"), "a\\xc2\\x9b31m") << "C1";
    EXPECT_EQ(escape_controls("a\u202eb\u2066c\u2028"),
              "a\\xe2\\x80\\xaeb\\xe2\\x81\\xa6c\\xe2\\x80\\xa8");
    EXPECT_EQ(escape_controls("\u00a0\u2030\u4e2d"), "\u00a0\u2030\u4e2d");
    EXPECT_EQ(escape_controls("\x9b\xe9"), "\\x9b\\xe9") << "not UTF-8";
    EXPECT_EQ(escape_controls("\xff\x98\x98\x98"), "\\xff\\x98\\x98\\x98") << "no first byte";
    EXPECT_EQ(escape_controls("\xc1\x9b\xe0\x82\x9b\xed\xa0\x80"),
              "\\xc1\\x9b\\xe0\\x82\\x9b\\xed\\xa0\\x80")
        << "overlong, a surrogate";
    EXPECT_EQ(escape_controls(std::string_view("\0", 1)), "\\x00");
}

TEST(Quote, CutsLongTextsBehindAWholeCharacter) {
    EXPECT_EQ(quote("q1"), "'q1'");
    EXPECT_EQ(quote(std::string(60, 'a')), "'" + std::string(60, 'a') + "'");
    EXPECT_EQ(quote(std::string(61, 'a')), "'" + std::string(60, 'a') + "...'");
    EXPECT_EQ(quote(std::string(59, 'a') + "\u03a9\u03a9"), "'" + std::string(59, 'a') + "...'");
    EXPECT_EQ(quote(std::string(100, '\x80')).size(), 4 * 60 + 5U);  // no UTF-8 at all
}

TEST(CharacterLength, IsThatOfTheFirstCharacter) {
    EXPECT_EQ(character_length("ab"), 1U);
    EXPECT_EQ(character_length("\u00b5m"), 2U);
    EXPECT_EQ(character_length("\u2207"), 3U);
    EXPECT_EQ(character_length("\U0001F916"), 4U);
    EXPECT_EQ(character_length("\xC3"), 1U);
    EXPECT_EQ(character_length("\xC3("), 1U);
}

TEST(DescribeCombination, NamesTheLargestTermsFirstAndPositive) {
    const VectorXd direction = Eigen::Vector4d(3, -4, 0.1, 0);
    EXPECT_EQ(describe_combination(direction, {"a", "b", "c", "d"}), "0.8 b - 0.6 a");
    EXPECT_EQ(describe_combination(direction, {}), "0.8 column 2 - 0.6 column 1");
    EXPECT_EQ(describe_combination(VectorXd::Ones(25), {}),
              "0.2 column 1 + 0.2 column 2 + 0.2 column 3 + 0.2 column 4");
}

TEST(CountOf, IsSingularOfOneOnly) {
    EXPECT_EQ(count_of(0, "pose"), "0 poses");
    EXPECT_EQ(count_of(1, "pose"), "1 pose");
    EXPECT_EQ(count_of(2, "pose"), "2 poses");
    EXPECT_EQ(these(1, "pose"), "this pose");
    EXPECT_EQ(these(2, "pose"), "these 2 poses");
}

TEST(Suggest, NamesTheNearestOrAll) {
    EXPECT_EQ(suggest("calibrated", {"calibrate", "study"}), "did you mean 'calibrate'?");
    EXPECT_EQ(suggest("xyz", {"calibrate", "study"}), "must be calibrate or study");
    EXPECT_EQ(suggest("xyz", {}), "none is known here");
}

}  // namespace
}  // namespace posewise
