#include "../../src/io/measurements/matrix_file.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "mat_writer.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::input_error_of;

class ReadMatrix : public ::testing::Test {
  protected:
    std::string error_of(const std::string& text) const {
        return input_error_of([&] { read_matrix(folder_.write("b.csv", text)).values; });
    }
    /// Two variables, `first` 3 x 2 and `second` 1 x 1.
    std::string write_mat() const {
        const std::string path = folder_.path("b.mat");
        mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
        testing::add_matrix(file, "first", 3, 2, {1, 3, 5, 2, 4, 6});
        testing::add_matrix(file, "second", 1, 1, {7});
        Mat_Close(file);
        return path;
    }

    testing::TemporaryFolder folder_;
    const RowMatrixXd expected_{{1, 2}, {3, 4}, {5, 6}};
};

TEST_F(ReadMatrix, TakesNumbersWithAndWithoutHeader) {
    EXPECT_EQ(read_matrix(folder_.write("b.csv", "1,2\n3,4\n5,6\n")).values, expected_);
    EXPECT_EQ(read_matrix(folder_.write("b.csv", "# more\nx;y\n1;2\n3;4\n\n5;6")).values,
              expected_);
}

TEST_F(ReadMatrix, TakesTheFirstOrANamedVariableOfAMatlabFile) {
    EXPECT_EQ(read_matrix(write_mat()).values, expected_);
    EXPECT_EQ(read_matrix(write_mat(), "second").values, (RowMatrixXd{{7}}));
    EXPECT_NE(input_error_of([&] { read_matrix(write_mat(), "secnd"); }).find("'second'?"),
              std::string::npos);
}

/// Zeros are packed a thousandfold: a small file would fill the memory.
TEST_F(ReadMatrix, RefusesZerosThatArePackedAThousandfold) {
    const std::string path = folder_.path("b.mat");
    const auto write = [&](matio_compression compression) {
        mat_t* const file = Mat_CreateVer(path.c_str(), nullptr, MAT_FT_MAT5);
        testing::add_matrix(file, "many", 600000, 2, std::vector<double>(1200000), compression);
        Mat_Close(file);
    };
    write(MAT_COMPRESSION_ZLIB);
    EXPECT_EQ(input_error_of([&] { read_matrix(path); }),
              "b.mat: variable 'many' is 600000 x 2, packed more than fiftyfold; must be saved "
              "unpacked (-v6)");
    write(MAT_COMPRESSION_NONE);
    EXPECT_EQ(read_matrix(path).values.rows(), 600000);
}

TEST_F(ReadMatrix, SaysWhereAFileIsWrong) {
    const std::string rule = "; must be a finite number with a decimal point";
    EXPECT_EQ(error_of("a,b\n1,2\n3,four\n"), "b.csv:3:3: 'four' is not a number" + rule);
    EXPECT_EQ(error_of("a,2\n1,2\n"), "b.csv:1:1: 'a' is not a number" + rule);
    EXPECT_EQ(error_of("1,nan\n"), "b.csv:1:3: 'nan' is not finite" + rule);
    EXPECT_EQ(error_of("nan,nan\n"), "b.csv:1:1: 'nan' is not finite" + rule);
    EXPECT_EQ(error_of("1,2\n3\n"), "b.csv:2:2: row has 1 fields; must have 2 as the first row");
    EXPECT_EQ(error_of("a,b\n1,2,3\n"),
              "b.csv:2:5: row has 3 fields; must have 2 as the first row");
    EXPECT_EQ(error_of(""), "b.csv: has no numbers; must have at least one row");
    EXPECT_EQ(error_of("a,b\n"), "b.csv: has no numbers; must have at least one row");
}

}  // namespace
}  // namespace posewise::io
