#include "matrix_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/mat_reader.hpp"
#include "io/format/npy.hpp"
#include "io/format/text.hpp"

namespace posewise::detail {
namespace {

bool is_header(const CsvReader& csv) {
    return std::all_of(csv.fields().begin(), csv.fields().end(), [](std::string_view field) {
        return parse_number(field).problem == "is not a number";
    });
}

/// Appends the numbers of the row at hand; `width` is that of the first row, 0 before.
void append_row(const CsvReader& csv, std::size_t width, std::vector<double>& values) {
    const std::size_t count = csv.fields().size();
    if (width > 0 && count != width) {
        throw input_error_at(
            csv.locate(std::min(count, width)),
            fmt::format("row has {} fields; must have {} as the first row", count, width));
    }
    for (std::size_t field = 0; field < count; ++field) {
        const ParsedNumber number = parse_number(csv.fields()[field]);
        if (!number.ok()) {
            throw input_error_at(csv.locate(field),
                                 fmt::format("{} {}; must be a finite number with a decimal "
                                             "point",
                                             quote(csv.fields()[field]), number.problem));
        }
        values.push_back(number.value);
    }
}

StoredMatrix read_text_matrix(const std::string& path) {
    CsvReader csv(path, read_file(path), CsvStyle::List);
    StoredMatrix matrix;
    std::vector<double> values;
    std::size_t width = 0;
    bool is_first = true;
    while (csv.next_row()) {
        if (is_first && is_header(csv)) {
            matrix.names.assign(csv.fields().begin(), csv.fields().end());
        } else {
            append_row(csv, width, values);
        }
        width = csv.fields().size();
        is_first = false;
    }
    if (values.empty()) throw input_error_at({path}, "has no numbers; must have at least one row");
    const auto columns = static_cast<Index>(width);
    matrix.values = Eigen::Map<const RowMatrixXd>(
        values.data(), static_cast<Index>(values.size()) / columns, columns);
    return matrix;
}

StoredMatrix stored(NpyArray array) { return {std::move(array.matrix), array.rows_per_pose}; }

}  // namespace

StoredMatrix read_matrix(const std::string& path, const std::string& variable) {
    if (path.ends_with(".npy")) return stored(parse_npy(read_file(path), path));
    if (path.ends_with(".npz")) return stored(read_npz(path, variable));
    if (!path.ends_with(".mat") && !path.ends_with(".MAT")) return read_text_matrix(path);
    const MatReader file(path);
    return {variable.empty() ? file.read_first() : file.read(variable)};
}

}  // namespace posewise::detail
