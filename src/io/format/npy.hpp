#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/types.hpp"

/// Arrays of NumPy: files .npy of one, .npz (zip files) of several.
namespace posewise::detail {

/// A two- or three-dimensional array.
struct NpyArray {
    RowMatrixXd matrix;       ///< of three dimensions the first two stacked
    Index rows_per_pose = 0;  ///< second of three dimensions; 0: there are two
};

/// Finite real numbers of any size and byte order, in C or Fortran order, of a .npy file of version
/// 1 to 3. Takes no more memory than the numbers that are there, as doubles. Throws InputError for
/// anything else; `subject` ("variable 'J' ", or empty) begins what it says after the path.
NpyArray parse_npy(std::string_view content, const std::string& path,
                   const std::string& subject = "");

/// The variable of a .npz file, stored or deflated; the first if none is named. Throws InputError
/// as parse_npy(), for a damaged or encrypted file, and for one packed more than fiftyfold.
NpyArray read_npz(const std::string& path, const std::string& variable = "");

/// A .npy file of these rows: of `rows_per_pose` each in three dimensions, 0: in two.
std::string npy_text(const RowMatrixXd& matrix, Index rows_per_pose);

/// A .npz file of that one variable, not packed.
std::string npz_text(const std::string& variable, const std::string& npy);

}  // namespace posewise::detail
