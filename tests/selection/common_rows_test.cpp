#include "../../src/selection/common_rows.hpp"

#include <gtest/gtest.h>

#include <Eigen/QR>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

/// Three rows of each are the same, turned into the others.
Blocks blocks_with_common_rows(const RowMatrixXd& common) {
    const Blocks own = test::random_blocks(40, 4, common.cols(), 1);
    const Index rows = 4 + common.rows();
    RowMatrixXd all(40 * rows, common.cols());
    for (Index i = 0; i < 40; ++i) {
        RowMatrixXd block(rows, common.cols());
        block << own[i], common;
        const Blocks directions =
            test::random_blocks(1, rows, rows, 100 + static_cast<std::uint64_t>(i));
        const Eigen::HouseholderQR<MatrixXd> turn(directions.matrix);
        all.middleRows(i * rows, rows) = MatrixXd(turn.householderQ()) * block;
    }
    return make_equal_blocks(all, rows);
}

TEST(CommonRows, AreFoundWhateverTheyAreMixedWith) {
    const RowMatrixXd common = test::random_blocks(1, 3, 12, 7).matrix;
    const Blocks blocks = blocks_with_common_rows(common);
    const CommonRows split = split_common_rows(blocks);
    ASSERT_EQ(split.rows.rows(), 3);
    EXPECT_LT((split.rows.transpose() * split.rows - common.transpose() * common).norm(), 1e-10);
    for (Index i = 0; i < blocks.count(); ++i) {
        EXPECT_EQ(split.others[i].rows(), 4);
        const MatrixXd sum =
            split.others[i].transpose() * split.others[i] + split.rows.transpose() * split.rows;
        EXPECT_LT((sum - blocks[i].transpose() * blocks[i]).norm(), 1e-10);
    }
}

TEST(CommonRows, AreNoneWhereOneBlockLacksThem) {
    Blocks blocks = blocks_with_common_rows(test::random_blocks(1, 3, 12, 7).matrix);
    blocks.matrix.middleRows(blocks.first_row[17], 7) *= 1.001;
    EXPECT_EQ(split_common_rows(blocks).rows.rows(), 0);
}

TEST(CommonRows, AreNoneOfBlocksThatDiffer) {
    EXPECT_EQ(split_common_rows(test::random_blocks(20, 3, 10, 1)).rows.rows(), 0);
    EXPECT_EQ(split_common_rows(test::random_blocks(20, 3, 2, 1)).rows.rows(), 0);
}

}  // namespace
}  // namespace posewise
