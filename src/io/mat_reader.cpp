#include "mat_reader.hpp"

#include <matio.h>

#include <cstring>
#include <filesystem>

#include "posewise/core/errors.hpp"
#include "posewise/io/atomic_file.hpp"
#include "text.hpp"

namespace posewise::io {
namespace {

/// libmatio reports damage only through its log: as a line of text, and as a return value for part
/// of it. Here the lines are counted, and nothing is printed.
thread_local int damage_count = 0;
void count_damage(int /*level*/, char* /*message*/) { ++damage_count; }

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

InputError variable_error(const std::string& path, const std::string& name,
                          const std::string& problem) {
    return input_error_at({path}, "variable '" + name + "' " + problem);
}

std::vector<std::string> variable_names(mat_t* file) {
    std::size_t count = 0;
    char** const names = Mat_GetDir(file, &count);
    std::vector<std::string> list;
    for (std::size_t i = 0; names != nullptr && i < count; ++i) {
        if (names[i] != nullptr) list.emplace_back(names[i]);
    }
    return list;
}

/// What must be said of a variable that is not a plain real matrix of doubles; empty: it is one.
std::string find_misfit(const matvar_t& variable) {
    if (variable.class_type == MAT_C_SPARSE) return "is sparse; must be a full matrix";
    if (variable.class_type != MAT_C_DOUBLE || variable.isLogical != 0) {
        return "is not numeric; must be a matrix of class double";
    }
    if (variable.isComplex != 0) return "is complex; must be real";
    if (variable.rank != 2 || variable.dims == nullptr)
        return "is not a matrix; must have 2 dimensions";
    return "";
}

}  // namespace

MatReader::MatReader(const std::string& path) : path_(path), byte_count_(read_file(path).size()) {
    if (byte_count_ == 0) throw input_error_at({path}, "is empty; must be a MATLAB file");
    Mat_LogInitFunc("posewise", count_damage);
    file_ = Mat_Open(path.c_str(), MAT_ACC_RDONLY);
    if (file_ == nullptr) {
        throw input_error_at({path},
                             "is not a MATLAB file, or a damaged one; must be a .mat file "
                             "of version 4 to 7.3");
    }
}

MatReader::~MatReader() { Mat_Close(file_); }

MatrixXd MatReader::read(const std::string& name, Index columns) const {
    damage_count = 0;
    const Variable variable(Mat_VarReadInfo(file_, name.c_str()), Mat_VarFree);
    if (variable == nullptr) {
        const bool is_damaged = damage_count > 0;
        throw variable_error(path_, name,
                             is_damaged
                                 ? "cannot be read: the file is damaged or cut short"
                                 : "is not in the file; " + suggest(name, variable_names(file_)));
    }
    if (const std::string misfit = find_misfit(*variable); !misfit.empty()) {
        throw variable_error(path_, name, misfit);
    }
    const std::size_t rows = variable->dims[0];
    const std::size_t width = variable->dims[1];
    if (rows == 0 || width != static_cast<std::size_t>(columns)) {
        throw variable_error(path_, name,
                             "is " + std::to_string(rows) + " x " + std::to_string(width) +
                                 "; must be samples x " + std::to_string(columns));
    }
    // Compression gains at most a factor of about 1030, so a larger size is damage.
    const bool is_plausible = rows <= 2000 * byte_count_ / width;
    if (!is_plausible || Mat_VarReadDataAll(file_, variable.get()) != 0 || damage_count > 0 ||
        variable->data == nullptr || variable->nbytes != rows * width * sizeof(double)) {
        throw variable_error(path_, name, "cannot be read: the file is damaged or cut short");
    }
    MatrixXd values(static_cast<Index>(rows), columns);
    std::memcpy(values.data(), variable->data, variable->nbytes);
    for (Index row = 0; row < values.rows(); ++row) {
        if (!values.row(row).allFinite()) {
            throw variable_error(path_, name,
                                 "has a value in row " + std::to_string(row + 1) +
                                     " that is not finite; must be finite numbers");
        }
    }
    return values;
}

}  // namespace posewise::io
