#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/text.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/npy.hpp"
#include "io/format/text.hpp"
#include "matrix_file.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"

namespace posewise::io {
namespace {

using detail::StoredMatrix;

/// The smallest period of the rows, by that comparison: at most 100, and at least four times there;
/// 0: none.
template <class IsLike>
Index period_of(Index rows, const IsLike& is_like) {
    constexpr Index least_count = 4;
    constexpr Index longest = 100;
    for (Index period = 1; period <= std::min(longest, rows / least_count); ++period) {
        if (rows % period != 0) continue;
        Index row = period;
        while (row < rows && is_like(row, row - period)) ++row;
        if (row == rows) return period;
    }
    return 0;
}

/// Whether there are more numbers than a table of a few levels of each factor has.
bool is_of_many_numbers(const RowMatrixXd& matrix) {
    std::vector<double> values(matrix.data(), matrix.data() + matrix.size());
    std::sort(values.begin(), values.end());
    return std::unique(values.begin(), values.end()) - values.begin() > matrix.rows();
}

/// Rows of one pose after another mostly have their zeros at the same places, as each coordinate of
/// a base has.
std::string doubt_by_zeros(const RowMatrixXd& matrix, Index rows_per_block) {
    const Index period = period_of(matrix.rows(), [&](Index one, Index other) {
        return ((matrix.row(one).array() == 0) == (matrix.row(other).array() == 0)).all();
    });
    if (period <= 1 || rows_per_block % period == 0 || !is_of_many_numbers(matrix)) return "";
    return fmt::format(
        "the zeros of the matrix come again every {} rows, but one candidate has {} (--rows); is "
        "it "
        "{}?",
        period, rows_per_block, period);
}

/// A column that only numbers or names the rows would be taken for a parameter.
std::vector<std::string> doubt_by_names(const StoredMatrix& matrix, Index rows_per_block) {
    constexpr std::array of_pose{"config", "configuration", "pose", "candidate", "id"};
    constexpr std::array of_row{"row", "index", "unnamed: 0", ""};
    std::vector<std::string> doubts;
    for (std::size_t k = 0; k < matrix.names.size(); ++k) {
        std::string name = matrix.names[k];
        std::ranges::transform(name, name.begin(),
                               [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        const bool is_of_pose = std::ranges::find(of_pose, name) != of_pose.end();
        if (!is_of_pose && std::ranges::find(of_row, name) == of_row.end()) continue;
        std::string doubt = fmt::format(
            "column {} is called {} and is taken for a parameter; leave it out of the file if it "
            "names the rows",
            k + 1, detail::quote(matrix.names[k]));
        const auto column = matrix.values.col(static_cast<Index>(k));
        Index run = 1;
        while (run < column.size() && column[run] == column[0]) ++run;
        if (is_of_pose && run != rows_per_block) {
            doubt += fmt::format("; its first value has {}, but a candidate {} (--rows)",
                                 detail::count_of(run, "row"), rows_per_block);
        }
        doubts.push_back(std::move(doubt));
    }
    return doubts;
}

/// Rows of every block; throws if they differ.
Index height_of(const std::string& path, const Blocks& blocks) {
    if (blocks.count() == 0) throw input_error_at({path}, "there are no blocks to write");
    const Index height = blocks[0].rows();
    for (Index i = 1; i < blocks.count(); ++i) {
        if (blocks[i].rows() == height) continue;
        throw input_error_at(
            {path}, fmt::format("candidate {} has {} rows, candidate 0 {}; must have equally many "
                                "to be written",
                                i, blocks[i].rows(), height));
    }
    return height;
}

void append_line(std::string& text, const RowMatrixXd::ConstRowXpr& row) {
    for (Index k = 0; k < row.size(); ++k) {
        fmt::format_to(std::back_inserter(text), "{}{}", k > 0 ? "," : "", row[k]);
    }
    text += '\n';
}

Index index_of(const std::string& path, double value, Index candidate_count) {
    if (value >= 0 && value < static_cast<double>(candidate_count) && value == std::floor(value)) {
        return static_cast<Index>(value);
    }
    throw input_error_at({path}, fmt::format("names candidate {}; must be from 0 to {}, the "
                                             "candidates in their order",
                                             value, candidate_count - 1));
}

}  // namespace

BlocksFile read_blocks(const std::string& path, Index rows_per_block, const std::string& variable) {
    StoredMatrix matrix = detail::read_matrix(path, variable);
    const Index stored = matrix.rows_per_block;
    const Index rows = rows_per_block == 0 ? stored : rows_per_block;
    const std::string shape =
        fmt::format("{}{} x {}", matrix.values.rows() / std::max<Index>(stored, 1),
                    stored > 0 ? fmt::format(" x {}", stored) : "", matrix.values.cols());
    if (rows == 0) {
        throw input_error_at(
            {path}, fmt::format("is {} and does not say how many rows a candidate has; --rows must "
                                "state it, or an array be candidates x rows x parameters",
                                shape));
    }
    if (stored > 0 && stored != rows) {
        throw input_error_at({path}, fmt::format("is {}, so a candidate has {}; --rows is {}, must "
                                                 "be that or left out",
                                                 shape, detail::count_of(stored, "row"), rows));
    }
    BlocksFile file;
    file.rows_per_block = rows;
    try {
        file.blocks = make_equal_blocks(matrix.values, rows);
    } catch (const InputError& error) {
        throw input_error_at({path}, error.what());
    }
    file.doubts = doubt_by_names(matrix, rows);
    const std::string doubt = stored > 0 ? "" : doubt_by_zeros(matrix.values, rows);
    if (!doubt.empty()) file.doubts.push_back(doubt);
    file.names = std::move(matrix.names);
    return file;
}

void write_blocks(const std::string& path, const Blocks& blocks,
                  const std::vector<std::string>& names) {
    const Index height = height_of(path, blocks);
    if (path.ends_with(".npy")) {
        return detail::write_file(path, detail::npy_text(blocks.matrix, height));
    }
    if (path.ends_with(".npz")) {
        return detail::write_file(
            path, detail::npz_text("blocks", detail::npy_text(blocks.matrix, height)));
    }
    if (!path.ends_with(".csv")) throw input_error_at({path}, "must end in .npy, .npz or .csv");
    std::string text;
    for (std::size_t k = 0; k < names.size(); ++k) {
        text += (k > 0 ? "," : "") + detail::csv_field(names[k]);
    }
    if (!names.empty()) text += '\n';
    for (Index row = 0; row < blocks.matrix.rows(); ++row)
        append_line(text, blocks.matrix.row(row));
    detail::write_file(path, text);
}

std::vector<Index> read_subset(const std::string& path, Index candidate_count) {
    std::vector<Index> subset;
    if (path.ends_with(".json")) {
        for (const PlannedPose& pose : read_plan(path).poses) {
            const auto id = detail::parse_number(pose.id);
            if (!id.ok()) {
                throw input_error_at({path},
                                     "is a plan of a robot's poses; must be one of plain "
                                     "blocks, whose ids are numbers");
            }
            const Index index = index_of(path, id.value, candidate_count);
            subset.insert(subset.end(), static_cast<std::size_t>(pose.times), index);
        }
        return subset;
    }
    const RowMatrixXd values = detail::read_matrix(path).values;
    for (Index k = 0; k < values.size(); ++k) {
        subset.push_back(index_of(path, values.data()[k], candidate_count));
    }
    return subset;
}

}  // namespace posewise::io
