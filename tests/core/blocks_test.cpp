#include "posewise/core/blocks.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <string>

#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

RowMatrixXd three_blocks_of_two() {
    RowMatrixXd matrix(6, 2);
    matrix << 1, 2, 3, 4,  //
        5, 6, 7, 8,        //
        9, 10, 11, 12;
    return matrix;
}

TEST(Blocks, ViewTheRowsOfEachPose) {
    const Blocks blocks = make_equal_blocks(three_blocks_of_two(), 2);
    EXPECT_EQ(blocks.count(), 3);
    EXPECT_EQ(blocks.parameter_count(), 2);
    EXPECT_EQ(MatrixXd(blocks[1]), (Eigen::Matrix2d() << 5, 6, 7, 8).finished());
}

TEST(Blocks, AreNoneByDefault) {
    EXPECT_EQ(Blocks{}.count(), 0);
    EXPECT_EQ(make_equal_blocks(RowMatrixXd(0, 4), 3).count(), 0);
}

TEST(MakeEqualBlocks, RefusesWhatIsNotAMultipleOfTheHeight) {
    EXPECT_THROW(make_equal_blocks(three_blocks_of_two(), 4), InputError);
    EXPECT_THROW(make_equal_blocks(three_blocks_of_two(), 0), InputError);
    EXPECT_THROW(make_equal_blocks(three_blocks_of_two(), -2), InputError);
}

TEST(MakeEqualBlocks, RefusesNumbersThatAreNotFinite) {
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        RowMatrixXd matrix = three_blocks_of_two();
        matrix(3, 1) = bad;
        EXPECT_THROW(make_equal_blocks(matrix, 2), InputError);
    }
}

TEST(MakeEqualBlocks, RefusesNumbersWhoseSquaresOverflowOrVanish) {
    const auto error_of = [](Index row, Index column, double value) {
        RowMatrixXd matrix = three_blocks_of_two();
        if (row < 0) matrix.col(column).setZero();
        matrix(std::max<Index>(row, 0), column) = value;
        try {
            make_equal_blocks(matrix, 2);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    EXPECT_EQ(
        error_of(3, 1, -1e160),
        "row 4, column 2 of the matrix is -1e+160; must be finite, at most 1e+50 in magnitude, for "
        "its square is taken");
    EXPECT_EQ(error_of(3, 1, 1e50), "");
    EXPECT_EQ(error_of(3, 1, 1e-160), "");  // beside others it is as good as 0
    EXPECT_EQ(error_of(-1, 0, 1e-160),
              "column 1 of the matrix is at most 1e-160 in magnitude, whose square is lost; must "
              "be 0, or its parameter in a larger unit");
    EXPECT_EQ(error_of(-1, 0, 0), "");
}

TEST(TakeBlocks, KeepsTheOrderAskedForAndRepeats) {
    Blocks blocks{three_blocks_of_two(), {0, 1, 3, 6}};  // of unequal height
    const Blocks taken = take(blocks, {2, 0, 2});
    ASSERT_EQ(taken.count(), 3);
    EXPECT_EQ(taken.first_row, (std::vector<Index>{0, 3, 4, 7}));
    EXPECT_EQ(RowMatrixXd(taken[0]), RowMatrixXd(blocks[2]));
    EXPECT_EQ(RowMatrixXd(taken[1]), RowMatrixXd(blocks[0]));
    EXPECT_EQ(RowMatrixXd(taken[2]), RowMatrixXd(blocks[2]));
}

TEST(Information, IsTheSumOfBlockTransposedTimesBlock) {
    const Blocks blocks = make_equal_blocks(three_blocks_of_two(), 2);
    const MatrixXd first = blocks[0].transpose() * blocks[0];
    const MatrixXd last = blocks[2].transpose() * blocks[2];
    EXPECT_EQ(information(blocks, {0, 2, 2}), first + 2 * last);
    EXPECT_EQ(information(blocks), blocks.matrix.transpose() * blocks.matrix);
    EXPECT_EQ(information(blocks), information(blocks, {0, 1, 2}));
    EXPECT_EQ(information(blocks, {}), MatrixXd::Zero(2, 2));
}

}  // namespace
}  // namespace posewise
