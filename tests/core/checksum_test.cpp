#include "../../src/core/checksum.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace posewise {
namespace {

using namespace detail;

std::string checksum_of(const RowMatrixXd& matrix) {
    Checksum checksum;
    checksum.add(matrix);
    return checksum.text();
}

TEST(ChecksumTest, IsTheOffsetBasisOfNothing) {
    EXPECT_EQ(Checksum().text(), "fnv1a64:cbf29ce484222325");
}

TEST(ChecksumTest, NoticesTheLastBitTheOrderAndTheShape) {
    const RowMatrixXd matrix{{1, 2}, {3, 4}};
    RowMatrixXd nudged = matrix;
    nudged(1, 1) = std::nextafter(4.0, 5.0);
    EXPECT_EQ(checksum_of(matrix), checksum_of(RowMatrixXd{{1, 2}, {3, 4}}));
    EXPECT_NE(checksum_of(matrix), checksum_of(nudged));
    EXPECT_NE(checksum_of(matrix), checksum_of(RowMatrixXd{{3, 4}, {1, 2}}));
    EXPECT_NE(checksum_of(matrix), checksum_of(RowMatrixXd{{1, 2, 3, 4}}));
}

TEST(ChecksumTest, KeepsNamesApart) {
    Checksum first;
    first.add(std::string("ab"));
    first.add(std::string("c"));
    Checksum second;
    second.add(std::string("a"));
    second.add(std::string("bc"));
    EXPECT_NE(first.text(), second.text());
}

}  // namespace
}  // namespace posewise
