#include <gtest/gtest.h>

#include "../../src/io/format/atomic_file.hpp"
#include "campaign_text.hpp"
#include "mat_writer.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::input_error_of;
using testing::TemporaryFolder;

/// The crane of campaign_text, and MATLAB files for it: q 3 x 3 (deg, mm), mA and mB 3 x 3 (mm).
class ReadMeasurementsMat : public ::testing::Test {
  protected:
    using Value = std::vector<double>;

    ReadMeasurementsMat()
        : campaign_(read_campaign(folder_.write("c.yaml", testing::campaign_text))) {}

    void write(const Value& q, matio_compression compression = MAT_COMPRESSION_NONE,
               mat_ft version = MAT_FT_MAT5, const Value& mA = {1, 2, 3, 4, 5, 6, 7, 8, 9}) const {
        mat_t* const file = Mat_CreateVer(path_.c_str(), nullptr, version);
        add(file, "q", q, compression);
        add(file, "mA", mA, compression);
        add(file, "mB", {11, 12, 13, 14, 15, 16, 17, 18, 19}, compression);
        Mat_Close(file);
    }

    /// Of three columns, column by column as MATLAB has it.
    static void add(mat_t* file, const char* name, const Value& value,
                    matio_compression compression) {
        testing::add_matrix(file, name, value.size() / 3, 3, value, compression);
    }

    /// A good file, but for one variable `mB` made otherwise.
    void write_with(matvar_t* odd) const {
        mat_t* const file = Mat_CreateVer(path_.c_str(), nullptr, MAT_FT_MAT5);
        add(file, "q", good_q, MAT_COMPRESSION_NONE);
        add(file, "mA", good_q, MAT_COMPRESSION_NONE);
        if (odd != nullptr) Mat_VarWrite(file, odd, MAT_COMPRESSION_NONE);
        Mat_VarFree(odd);
        Mat_Close(file);
    }

    Measurements read() const { return read_measurements(path_, campaign_); }

    std::string error() const {
        return input_error_of([&] { read(); });
    }

    const std::string no_matlab_file =
        "m.mat: is not a MATLAB file of version 5 to 7.3; must be one, as saved with -v7";
    const Value good_q{10, 20, 10, 30, 40, 30, 100, 200, 100};  // rows 1 and 3 are equal
    TemporaryFolder folder_;
    std::string path_ = folder_.path("m.mat");
    CampaignFile campaign_;
};

TEST_F(ReadMeasurementsMat, GroupsRowsWithEqualJointValues) {
    for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
        write(good_q, compression);
        const Measurements measurements = read();
        EXPECT_EQ(measurements.ids, (std::vector<std::string>{"0", "1"}));
        EXPECT_EQ(measurements.first_sample, (std::vector<Index>{0, 2, 3}));
        EXPECT_NEAR(measurements.configurations(0, 0), 0.17453292519943295, 1e-15);
        EXPECT_NEAR(measurements.configurations(1, 2), 0.2, 1e-15);
        EXPECT_NEAR(measurements.observations(1, 0), 3e-3, 1e-15);   // row 3 of mA
        EXPECT_NEAR(measurements.observations(2, 5), 18e-3, 1e-15);  // row 2 of mB
    }
}

TEST_F(ReadMeasurementsMat, RefusesAMissingVariable) {
    write_with(nullptr);
    EXPECT_EQ(error(), "m.mat: variable 'mB' is not in the file; did you mean 'mA'?");
}

TEST_F(ReadMeasurementsMat, RefusesAnotherShape) {
    double values[6] = {};
    std::size_t dims[2] = {2, 3};
    write_with(Mat_VarCreate("mB", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values, 0));
    EXPECT_EQ(error(), "m.mat: variable 'mB' has 2 rows; must have 3 as 'q'");
    dims[0] = 3;
    dims[1] = 2;
    write_with(Mat_VarCreate("mB", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values, 0));
    EXPECT_EQ(error(), "m.mat: variable 'mB' is 3 x 2; must be samples x 3");
    std::size_t three[3] = {1, 2, 3};
    write_with(Mat_VarCreate("mB", MAT_C_DOUBLE, MAT_T_DOUBLE, 3, three, values, 0));
    EXPECT_EQ(error(), "m.mat: variable 'mB' is not a matrix; must have 2 dimensions");
}

TEST_F(ReadMeasurementsMat, RefusesAnotherClass) {
    std::string text = "abc";
    std::size_t dims[2] = {1, 3};
    write_with(Mat_VarCreate("mB", MAT_C_CHAR, MAT_T_UINT8, 2, dims, text.data(), 0));
    EXPECT_EQ(error(), "m.mat: variable 'mB' is not numeric; must be a matrix of class double");
}

TEST_F(ReadMeasurementsMat, RefusesComplexNumbers) {
    double values[9] = {};
    mat_complex_split_t parts{values, values};
    std::size_t dims[2] = {3, 3};
    write_with(Mat_VarCreate("mB", MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, &parts, MAT_F_COMPLEX));
    EXPECT_EQ(error(), "m.mat: variable 'mB' is complex; must be real");
}

TEST_F(ReadMeasurementsMat, RefusesSparseMatrices) {
    double values[1] = {1};
    mat_uint32_t rows[1] = {0};
    mat_uint32_t columns[4] = {0, 1, 1, 1};
    mat_sparse_t sparse{};
    sparse.nzmax = sparse.nir = sparse.ndata = 1;
    sparse.njc = 4;
    sparse.ir = rows;
    sparse.jc = columns;
    sparse.data = values;
    std::size_t dims[2] = {3, 3};
    write_with(
        Mat_VarCreate("mB", MAT_C_SPARSE, MAT_T_DOUBLE, 2, dims, &sparse, MAT_F_DONT_COPY_DATA));
    EXPECT_EQ(error(), "m.mat: variable 'mB' is sparse; must be a full matrix");
}

TEST_F(ReadMeasurementsMat, RefusesNumbersThatAreNotFinite) {
    auto q = good_q;
    q[1] = std::numeric_limits<double>::quiet_NaN();
    write(q);
    EXPECT_EQ(
        error(),
        "m.mat: variable 'q' has a value in row 2 that is not finite; must be finite numbers");
}

TEST_F(ReadMeasurementsMat, ARowOfNaNIsATargetThatWasNotSeen) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
        write(good_q, compression, MAT_FT_MAT5, {1, 2, nan, 4, 5, nan, 7, 8, nan});
        const Measurements measurements = read();
        EXPECT_TRUE(
            (measurements.is_seen == Seen{{true, true}, {false, true}, {true, true}}).all());
        EXPECT_TRUE(measurements.observations.allFinite());
        EXPECT_NEAR(measurements.observations(0, 0), 1e-3, 1e-15);
        EXPECT_NEAR(measurements.observations(1, 3), 13e-3, 1e-15);
        EXPECT_TRUE(read_configurations(path_, campaign_).is_seen.all());
    }
}

TEST_F(ReadMeasurementsMat, RefusesATargetOrSampleThatIsHalfMissing) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    write(good_q, MAT_COMPRESSION_NONE, MAT_FT_MAT5, {1, 2, 3, 4, nan, 6, 7, nan, 9});
    EXPECT_EQ(error(),
              "m.mat: variable 'mA' has a value in row 2 that is not finite; must be finite "
              "numbers, or NaN in all 3 columns if nothing was seen");
    const double inf = std::numeric_limits<double>::infinity();
    write(good_q, MAT_COMPRESSION_NONE, MAT_FT_MAT5, {1, 2, inf, 4, 5, inf, 7, 8, inf});
    EXPECT_EQ(error().substr(0, 63),
              "m.mat: variable 'mA' has a value in row 3 that is not finite; m");

    mat_t* const file = Mat_CreateVer(path_.c_str(), nullptr, MAT_FT_MAT5);
    add(file, "q", good_q, MAT_COMPRESSION_NONE);
    for (const char* name : {"mA", "mB"}) {
        add(file, name, {1, nan, 3, 4, nan, 6, 7, nan, 9}, MAT_COMPRESSION_NONE);
    }
    Mat_Close(file);
    EXPECT_EQ(error(),
              "m.mat: row 2 shows no target, all points are NaN; must show one at least, or be "
              "left out");
}

TEST_F(ReadMeasurementsMat, RefusesAnglesThatLookLikeDegrees) {
    campaign_.mat.angle_unit = 1;
    write(good_q);
    EXPECT_EQ(error(),
              "m.mat: variable 'q', row 1: q2 = 30 rad is more than four turns beyond its limits "
              "(-1 to 1.5 rad) and looks like degrees; state degrees as such");
}

TEST_F(ReadMeasurementsMat, RefusesACampaignWithoutMapping) {
    write(good_q);
    campaign_.mat = MatMapping();
    EXPECT_EQ(error(),
              "m.mat: the campaign maps 0 variables to points; must map 2 under "
              "measurements.mat.points");
}

TEST_F(ReadMeasurementsMat, RefusesWhatIsNoMatlabFile) {
    EXPECT_EQ(error(), "m.mat: cannot be read: No such file or directory");
    folder_.write("m.mat", "");
    EXPECT_EQ(error(), "m.mat: is empty; must be a MATLAB file");
    folder_.write("m.mat", "config,sample\n");
    EXPECT_EQ(error(), no_matlab_file);
}

TEST_F(ReadMeasurementsMat, RefusesTheFormatOfMatlab4) {
    write(good_q, MAT_COMPRESSION_NONE, MAT_FT_MAT4);
    EXPECT_EQ(error(), no_matlab_file);
}

TEST_F(ReadMeasurementsMat, RefusesAFileCutShortAnywhereAndPrintsNothing) {
    for (const auto compression : {MAT_COMPRESSION_NONE, MAT_COMPRESSION_ZLIB}) {
        write(good_q, compression);
        const std::string whole = read_file(path_);
        ::testing::internal::CaptureStderr();
        for (std::size_t size = 0; size < whole.size(); ++size) {
            folder_.write("m.mat", whole.substr(0, size));
            EXPECT_NE(error(), "no error") << size << " of " << whole.size() << " bytes";
        }
        EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
    }
}

TEST_F(ReadMeasurementsMat, SurvivesDamagedBytes) {
    write(good_q, MAT_COMPRESSION_ZLIB);
    const std::string whole = read_file(path_);
    for (std::size_t byte = 0; byte < whole.size(); ++byte) {
        for (const unsigned flip : {0x01U, 0x80U, 0xFFU}) {
            std::string damaged = whole;
            damaged[byte] = static_cast<char>(static_cast<unsigned char>(damaged[byte]) ^ flip);
            folder_.write("m.mat", damaged);
            error();  // refused, or the damage does not matter
        }
    }
}

}  // namespace
}  // namespace posewise::io
