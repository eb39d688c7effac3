#include <gtest/gtest.h>

#include "posewise/core/random.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::input_error_of;

/// Ten poses of three rows: the first three columns are one of a base, the others any numbers.
RowMatrixXd jacobian() {
    RowMatrixXd matrix(30, 6);
    RandomStream random(3);
    for (Index row = 0; row < matrix.rows(); ++row) {
        for (Index k = 0; k < 3; ++k) matrix(row, k) = row % 3 == k ? 1 : 0;
        for (Index k = 3; k < 6; ++k) matrix(row, k) = random.normal();
    }
    return matrix;
}

class BlocksInFiles : public ::testing::Test {
  protected:
    std::string path(const std::string& name) const { return folder_.path(name); }

    testing::TemporaryFolder folder_;
};

TEST_F(BlocksInFiles, AreReadAsTheyWereWritten) {
    const Blocks blocks = make_equal_blocks(jacobian(), 3);
    for (const std::string name : {"b.npy", "b.npz", "b.csv"}) {
        write_blocks(path(name), blocks, {"x", "y", "z", "a1", "a,2", "a3"});
        const bool is_text = name == "b.csv";
        const BlocksFile read = read_blocks(path(name), is_text ? 3 : 0);
        EXPECT_EQ(read.blocks.matrix, blocks.matrix) << name;
        EXPECT_EQ(read.blocks.first_row, blocks.first_row) << name;
        EXPECT_EQ(read.rows_per_block, 3) << name;
        EXPECT_EQ(read.names.size(), is_text ? 6U : 0U) << name;
        EXPECT_EQ(read.doubts, std::vector<std::string>{}) << name;
    }
    EXPECT_EQ(read_blocks(path("b.csv"), 3).names[4], "a,2");
}

TEST_F(BlocksInFiles, OfDifferentHeightsAreNotWritten) {
    const Blocks blocks{RowMatrixXd::Ones(3, 2), {0, 1, 3}};
    EXPECT_EQ(input_error_of([&] { write_blocks(path("b.npy"), blocks); }),
              "b.npy: candidate 1 has 2 rows, candidate 0 1; must have equally many to be written");
    EXPECT_EQ(
        input_error_of([&] { write_blocks(path("b.txt"), make_equal_blocks(jacobian(), 3)); }),
        "b.txt: must end in .npy, .npz or .csv");
}

TEST_F(BlocksInFiles, AreReadAsSavetxtWritesThem) {
    const std::string text =
        "# J, stacked\n1.000000000000000000e+00 -2.500000000000000000e-01\n"
        "  0.000000000000000000e+00   4.000000000000000000e+00\n# end\n";
    EXPECT_EQ(read_blocks(folder_.write("b.txt", text), 2).blocks.matrix,
              (RowMatrixXd{{1, -0.25}, {0, 4}}));
}

TEST_F(BlocksInFiles, NeedTheirRowsStatedOnceAndRight) {
    write_blocks(path("b.npy"), make_equal_blocks(jacobian(), 3));
    EXPECT_EQ(input_error_of([&] { read_blocks(path("b.npy"), 2); }),
              "b.npy: is 10 x 3 x 6, so a candidate has 3 rows; --rows is 2, must be that or left "
              "out");
    write_blocks(path("b.csv"), make_equal_blocks(jacobian(), 3));
    EXPECT_EQ(input_error_of([&] { read_blocks(path("b.csv")); }),
              "b.csv: is 30 x 6 and does not say how many rows a candidate has; --rows must state "
              "it, or an array be candidates x rows x parameters");
    EXPECT_EQ(input_error_of([&] { read_blocks(path("b.csv"), 4); }),
              "b.csv: matrix has 30 rows, not a multiple of 4 rows per block");
}

TEST_F(BlocksInFiles, AreDoubtedWhereTheirZerosSayOtherwise) {
    write_blocks(path("b.csv"), make_equal_blocks(jacobian(), 3));
    EXPECT_TRUE(read_blocks(path("b.csv"), 3).doubts.empty());
    EXPECT_TRUE(read_blocks(path("b.csv"), 6).doubts.empty());  // two targets, perhaps
    for (const Index rows : {1, 2, 5, 10}) {
        EXPECT_EQ(read_blocks(path("b.csv"), rows).doubts.size(), 1U) << rows;
    }
    EXPECT_EQ(read_blocks(path("b.csv"), 2).doubts.front(),
              "the zeros of the matrix come again every 3 rows, but one candidate has 2 (--rows); "
              "is it 3?");
}

/// A factor table has zeros that repeat, too, but few numbers.
TEST_F(BlocksInFiles, OfSingleRowsAreNotDoubted) {
    std::string table;
    for (int run = 0; run < 36; ++run) {
        table += std::to_string(run % 2) + ' ' + std::to_string(run % 3 - 1) + ' ' +
                 std::to_string(run / 18) + '\n';
    }
    EXPECT_TRUE(read_blocks(folder_.write("t.txt", table), 1).doubts.empty());
}

TEST_F(BlocksInFiles, AreDoubtedIfAColumnNamesTheRows) {
    const std::string text = ",Pose,a\n0,1,5\n1,1,6\n2,2,7\n3,2,9\n";
    const auto doubts = read_blocks(folder_.write("b.csv", text), 1).doubts;
    ASSERT_EQ(doubts.size(), 2U);
    EXPECT_EQ(doubts[0],
              "column 1 is called '' and is taken for a parameter; leave it out of the file if it "
              "names the rows");
    EXPECT_EQ(doubts[1],
              "column 2 is called 'Pose' and is taken for a parameter; leave it out of the file if "
              "it names the rows; its first value has 2 rows, but a candidate 1 (--rows)");
    EXPECT_EQ(read_blocks(folder_.write("b.csv", text), 2).doubts[1].find("first value"),
              std::string::npos);
}

TEST_F(BlocksInFiles, HaveSubsetsByNumber) {
    EXPECT_EQ(read_subset(folder_.write("s.txt", "3\n0\n3\n"), 4), (std::vector<Index>{3, 0, 3}));
    EXPECT_EQ(read_subset(folder_.write("s.csv", "config\n3\n1\n"), 4), (std::vector<Index>{3, 1}));
    EXPECT_EQ(read_subset(folder_.write("s.txt", "2 1 0\n"), 4), (std::vector<Index>{2, 1, 0}));
    for (const std::string bad : {"4", "-1", "1.5", "1e300"}) {
        EXPECT_NE(input_error_of([&] {
                      read_subset(folder_.write("s.txt", bad), 4);
                  }).find("must be from 0 to 3"),
                  std::string::npos)
            << bad;
    }
}

}  // namespace
}  // namespace posewise::io
