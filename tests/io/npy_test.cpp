#include "../../src/io/format/npy.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "../../src/io/measurements/matrix_file.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::input_error_of;

/// What NumPy wrote, see tests/golden/numpy_arrays.py.
std::string golden(const std::string& name) {
    return source_folder() + "/tests/fuzz/corpus/npy/" + name;
}

RowMatrixXd zero_to(Index rows, Index columns) {
    RowMatrixXd matrix(rows, columns);
    std::iota(matrix.data(), matrix.data() + matrix.size(), 0.0);
    return matrix;
}

class Npy : public ::testing::Test {
  protected:
    /// A file of version 1 with that header and that many zeros.
    std::string error_of(std::string header, std::size_t bytes) const {
        std::string text("\x93NUMPY\1\0", 8);
        text += {static_cast<char>(header.size() % 256), static_cast<char>(header.size() / 256)};
        const std::string path = folder_.write("a.npy", text + header + std::string(bytes, '\0'));
        return input_error_of([&] { read_matrix(path); });
    }

    testing::TemporaryFolder folder_;
};

TEST_F(Npy, ReadsWhateverNumPyWrites) {
    for (const std::string name :
         {"little_f8.npy", "big_f8.npy", "little_f4.npy", "big_f4.npy", "little_i8.npy",
          "big_i8.npy", "little_i4.npy", "big_i2.npy", "i1.npy", "little_u8.npy", "big_u4.npy",
          "little_u2.npy", "u1.npy", "fortran.npy", "version_2.npy", "version_3.npy", "stored.npz",
          "deflated.npz"}) {
        const StoredMatrix matrix = read_matrix(golden(name));
        EXPECT_EQ(matrix.values, zero_to(6, 4)) << name;
        EXPECT_EQ(matrix.rows_per_block, 3) << name;
    }
    for (const std::string name : {"matrix.npy", "fortran_matrix.npy"}) {
        const StoredMatrix matrix = read_matrix(golden(name));
        EXPECT_EQ(matrix.values, zero_to(6, 4)) << name;
        EXPECT_EQ(matrix.rows_per_block, 0) << name;
    }
}

TEST_F(Npy, TakesANamedVariable) {
    for (const std::string name : {"stored.npz", "deflated.npz"}) {
        EXPECT_EQ(read_matrix(golden(name), "other").values, RowMatrixXd::Ones(2, 2));
        EXPECT_NE(input_error_of([&] { read_matrix(golden(name), "othr"); }).find("'other'?"),
                  std::string::npos);
    }
}

TEST_F(Npy, ReadsWhatItWrote) {
    RowMatrixXd matrix = zero_to(6, 4) / 7;
    matrix(2, 3) = -1e-300;
    for (const Index rows : {0, 1, 3}) {
        const std::string text = npy_text(matrix, rows);
        EXPECT_EQ(text.find('\n') % 64, 63U);
        const NpyArray array = parse_npy(text, "a.npy");
        EXPECT_EQ(array.matrix, matrix);
        EXPECT_EQ(array.rows_per_pose, rows);
        const NpyArray zipped = read_npz(folder_.write("a.npz", npz_text("J", text)), "J");
        EXPECT_EQ(zipped.matrix, matrix);
        EXPECT_EQ(zipped.rows_per_pose, rows);
    }
}

TEST_F(Npy, RefusesWhatIsNoMatrixOfRealNumbers) {
    const auto error = [](const std::string& name) {
        const std::string whole = input_error_of([&] { read_matrix(golden(name)); });
        return whole.substr(whole.find(": ") + 2);
    };
    const std::string numbers =
        "; must be real numbers (float64, float32 or integers), as numpy.asarray(a, dtype=float) "
        "makes them";
    const std::string shape =
        "; must be rows x parameters, or poses x rows x parameters, none of them 0";
    EXPECT_EQ(error("object.npy"), "has elements of dtype '|O'" + numbers);
    EXPECT_EQ(error("complex.npy"), "has elements of dtype '<c16'" + numbers);
    EXPECT_EQ(error("fields.npy"), "has elements of several fields" + numbers);
    EXPECT_EQ(error("vector.npy"), "is a vector of 3" + shape);
    EXPECT_EQ(error("scalar.npy"), "is one number" + shape);
    EXPECT_EQ(error("empty.npy"), "is 0 x 3 x 4" + shape);
    EXPECT_EQ(error("nan.npy"), "has nan at [1, 1]; must be finite numbers");
}

TEST_F(Npy, BelievesNoHeaderThatPromisesMoreThanThereIs) {
    const auto of_shape = [&](const std::string& shape, std::size_t bytes) {
        return error_of("{'descr': '<f8', 'fortran_order': False, 'shape': " + shape + ", }\n",
                        bytes);
    };
    EXPECT_EQ(of_shape("(1000000000000000000, 3)", 48),
              "a.npy: is 1000000000000000000 x 3 of 8 B by its header, but holds 48 B of them; is "
              "cut short, or its header is damaged");
    for (const std::string shape :
         {"(4294967296, 4294967296, 4294967296)", "(18446744073709551615, 2)", "(2, 4)"}) {
        EXPECT_NE(of_shape(shape, 48).find("is cut short, or its header is damaged"),
                  std::string::npos)
            << shape;
    }
    EXPECT_NE(of_shape("(2, 2)", 48).find("must end with its last number"), std::string::npos);
    EXPECT_NE(of_shape("(2, 3)", 47).find("is cut short"), std::string::npos);
    const std::string damaged = "a.npy: has a damaged header; must be as numpy.save() writes it";
    for (const std::string shape :
         {"(-2, 3)", "(99999999999999999999, 3)", "(2, 3", "2", "(2 3)"}) {
        EXPECT_EQ(of_shape(shape, 48), damaged) << shape;
    }
    EXPECT_EQ(error_of("{'descr': '<f8'}", 48), damaged);
    EXPECT_EQ(error_of("", 48), damaged);
}

/// Every beginning of a file is refused in one line. Of a zip file's last six bytes, which are
/// zero, minizip takes those that are missing for zeros.
TEST_F(Npy, RefusesFilesThatAreCutShort) {
    const std::string npy = npy_text(zero_to(6, 4), 3);
    for (const std::string& whole : {npy, npz_text("J", npy)}) {
        const std::string name = whole == npy ? "a.npy" : "a.npz";
        for (std::size_t size = 0; size < whole.size() - 6; size += 5) {
            const std::string path = folder_.write(name, whole.substr(0, size));
            EXPECT_EQ(input_error_of([&] { read_matrix(path); }).rfind(name + ": ", 0), 0U) << size;
        }
    }
}

/// Zeros are packed a thousandfold: a small file would fill the memory.
TEST_F(Npy, RefusesZerosThatArePackedAThousandfold) {
    std::string text = npz_text("J", npy_text(zero_to(6, 4), 3));
    const std::size_t directory = text.find("PK\1\2");
    text[directory + 27] = 0x40;  // the size unpacked, its highest byte
    const std::string path = folder_.write("a.npz", text);
    EXPECT_NE(input_error_of([&] { read_matrix(path); }).find("packed at most fiftyfold"),
              std::string::npos);
}

TEST_F(Npy, NoticesADamagedZipFile) {
    std::string text = npz_text("J", npy_text(zero_to(6, 4), 3));
    text[text.find("PK\1\2") - 3] ^= 1;  // the last number
    const std::string path = folder_.write("a.npz", text);
    EXPECT_EQ(input_error_of([&] { read_matrix(path); }),
              "a.npz: is damaged; must be a whole file as numpy.savez() writes it");
}

}  // namespace
}  // namespace posewise::io
