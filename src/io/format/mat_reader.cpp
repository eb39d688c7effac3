#include "mat_reader.hpp"

#include <dlfcn.h>
#include <matio.h>

#include <algorithm>
#include <climits>
#include <cmath>

#include "atomic_file.hpp"
#include "posewise/core/errors.hpp"
#include "text.hpp"

namespace posewise::detail {
namespace {

/// What is used of libmatio. It is loaded with the first MATLAB file: HDF5, curl and whatever else
/// comes along take longer to load than most commands take.
class Library {
  public:
    static const Library& loaded() {
        static const Library library;
        return library;
    }

    decltype(&Mat_LogInitFunc) set_log;
    decltype(&Mat_Open) open;
    decltype(&Mat_Close) close;
    decltype(&Mat_GetDir) names;
    decltype(&Mat_VarReadInfo) read_info;
    decltype(&Mat_VarReadData) read_data;
    decltype(&Mat_VarFree) free_variable;

  private:
    Library() : handle_(dlopen(POSEWISE_MATIO, RTLD_LAZY | RTLD_LOCAL)) {
        if (handle_ == nullptr) fail();
        find("Mat_LogInitFunc", set_log);
        find("Mat_Open", open);
        find("Mat_Close", close);
        find("Mat_GetDir", names);
        find("Mat_VarReadInfo", read_info);
        find("Mat_VarReadData", read_data);
        find("Mat_VarFree", free_variable);
    }

    template <typename Function>
    void find(const char* name, Function& function) {
        function = reinterpret_cast<Function>(dlsym(handle_, name));
        if (function == nullptr) fail();
    }

    [[noreturn]] static void fail() {
        throw InputError(std::string("MATLAB files cannot be read: ") + dlerror() +
                         "; libmatio must be installed, or the data be stated as CSV");
    }

    void* handle_;
};

/// libmatio reports damage only through its log: as a line of text, and as a return value for part
/// of it. Here the lines are counted, and nothing is printed.
thread_local int damage_count = 0;
void count_damage(int /*level*/, char* /*message*/) { ++damage_count; }

constexpr const char* damaged = "cannot be read, the file is damaged; must be a whole MATLAB file";

using Variable = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

InputError variable_error(const std::string& path, const std::string& name,
                          const std::string& problem) {
    return input_error_at({path}, "variable '" + name + "' " + problem);
}

std::vector<std::string> variable_names(mat_t* file) {
    std::size_t count = 0;
    char** const names = Library::loaded().names(file, &count);
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

/// Measured numbers are packed to a tenth at best; a matrix of one number a thousandfold.
constexpr std::size_t most_packed = 50;
/// Smaller ones are read however they are packed.
constexpr std::size_t small_byte_count = std::size_t{1} << 23;

constexpr std::size_t header_size = 128;

/// Whether the header is that of MATLAB 5 to 7 (version 1) or 7.3 (version 2). Whatever else it is
/// given the library takes for MATLAB 4, which has no mark, and asks for memory by what it finds.
bool has_header(const std::string& content, char version) {
    if (content.size() < header_size) return false;
    const std::string end = content.substr(124, 4);
    return end == std::string{'\0', version, 'I', 'M'} ||
           end == std::string{version, '\0', 'M', 'I'};
}

/// Whether a MATLAB 5 file ends where its last element does. Each begins with its type and its byte
/// count; the library fills what is missing at the end with whatever was in memory.
bool is_whole(const std::string& content) {
    constexpr std::size_t tag_size = 8;
    const bool is_big_endian = content.compare(126, 2, "MI") == 0;
    std::size_t position = header_size;
    while (position + tag_size <= content.size()) {
        std::size_t byte_count = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            const std::size_t digit = is_big_endian ? k : 3 - k;
            byte_count =
                256 * byte_count + static_cast<unsigned char>(content[position + 4 + digit]);
        }
        position += tag_size + byte_count;
    }
    return position == content.size();
}

}  // namespace

MatReader::MatReader(const std::string& path) : path_(path), file_(nullptr, nullptr) {
    const std::string content = read_file(path);
    if (content.empty()) throw input_error_at({path}, "is empty; must be a MATLAB file");
    byte_count_ = content.size();
    const bool is_version_5 = has_header(content, 1);
    if (is_version_5 && !is_whole(content)) {
        throw input_error_at({path}, "is cut short or damaged; must be a whole MATLAB file");
    }
    if (is_version_5 || has_header(content, 2)) {
        const Library& matio = Library::loaded();
        matio.set_log("posewise", count_damage);
        file_ = {matio.open(path.c_str(), MAT_ACC_RDONLY), matio.close};
    }
    if (file_ == nullptr) {
        throw input_error_at({path},
                             "is not a MATLAB file of version 5 to 7.3; must be one, as "
                             "saved with -v7");
    }
}

MatrixXd MatReader::read_first() const {
    const std::vector<std::string> names = variable_names(file_.get());
    if (names.empty()) throw input_error_at({path_}, "has no variables; must have a matrix");
    return read(names.front());
}

MatrixXd MatReader::read(const std::string& name, std::optional<Index> columns) const {
    MatrixXd values = read_unchecked(name, columns);
    for (Index row = 0; row < values.rows(); ++row) {
        if (values.row(row).allFinite()) continue;
        throw variable_error(path_, name,
                             "has a value in row " + std::to_string(row + 1) +
                                 " that is not finite; must be finite numbers");
    }
    return values;
}

MatrixXd MatReader::read_with_gaps(const std::string& name, Index columns) const {
    MatrixXd values = read_unchecked(name, columns);
    for (Index row = 0; row < values.rows(); ++row) {
        if (values.row(row).allFinite() || values.row(row).array().isNaN().all()) continue;
        throw variable_error(path_, name,
                             "has a value in row " + std::to_string(row + 1) +
                                 " that is not finite; must be finite numbers, or NaN in all " +
                                 std::to_string(columns) + " columns if nothing was seen");
    }
    return values;
}

MatrixXd MatReader::read_unchecked(const std::string& name, std::optional<Index> columns) const {
    damage_count = 0;
    const Library& matio = Library::loaded();
    const Variable variable(matio.read_info(file_.get(), name.c_str()), matio.free_variable);
    if (variable == nullptr) {
        const bool is_damaged = damage_count > 0;
        throw variable_error(
            path_, name,
            is_damaged ? damaged
                       : "is not in the file; " + suggest(name, variable_names(file_.get())));
    }
    if (const std::string misfit = find_misfit(*variable); !misfit.empty()) {
        throw variable_error(path_, name, misfit);
    }
    const std::size_t rows = variable->dims[0];
    const std::size_t width = variable->dims[1];
    const bool is_width_right = !columns || width == static_cast<std::size_t>(*columns);
    if (rows == 0 || width == 0 || width > INT_MAX || !is_width_right) {
        throw variable_error(path_, name,
                             "is " + std::to_string(rows) + " x " + std::to_string(width) +
                                 (columns ? "; must be samples x " + std::to_string(*columns)
                                          : "; must have rows and columns"));
    }
    // Compression gains at most a factor of about 1030, so a larger size is damage.
    const bool is_plausible = rows <= std::min<std::size_t>(2000 * byte_count_ / width, INT_MAX);
    if (!is_plausible) throw variable_error(path_, name, damaged);
    const std::size_t unpacked = rows * width * sizeof(double);
    if (unpacked > std::max(small_byte_count, most_packed * byte_count_)) {
        throw variable_error(path_, name,
                             "is " + std::to_string(rows) + " x " + std::to_string(width) +
                                 ", packed more than fiftyfold; must be saved unpacked (-v6)");
    }
    // What a damaged file lacks stays infinite: the library leaves it alone and does not tell.
    MatrixXd values =
        MatrixXd::Constant(static_cast<Index>(rows), static_cast<Index>(width), INFINITY);
    int start[2] = {0, 0};
    int stride[2] = {1, 1};
    int count[2] = {static_cast<int>(rows), static_cast<int>(width)};
    if (matio.read_data(file_.get(), variable.get(), values.data(), start, stride, count) != 0 ||
        damage_count > 0) {
        throw variable_error(path_, name, damaged);
    }
    return values;
}

}  // namespace posewise::detail
