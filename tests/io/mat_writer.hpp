#pragma once

#include <matio.h>

#include <vector>

namespace posewise::testing {

/// Adds a rows x columns matrix to a MATLAB file; `values` stand column by column, as MATLAB has
/// them.
inline void add_matrix(mat_t* file, const char* name, std::size_t rows, std::size_t columns,
                       std::vector<double> values,
                       matio_compression compression = MAT_COMPRESSION_NONE) {
    std::size_t dims[2] = {rows, columns};
    matvar_t* const variable =
        Mat_VarCreate(name, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, values.data(), 0);
    Mat_VarWrite(file, variable, compression);
    Mat_VarFree(variable);
}

}  // namespace posewise::testing
