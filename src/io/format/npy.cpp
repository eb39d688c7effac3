#include "npy.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "core/text.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr std::string_view magic = "\x93NUMPY";

/// What a file says of its array.
struct Header {
    std::string dtype;  ///< "<f8"; "[" of one with fields
    std::optional<bool> is_fortran{};
    std::optional<std::vector<std::uint64_t>> shape{};
};

/// The header's text, a Python dictionary: {'descr': '<f8', 'fortran_order': False, 'shape': (3,)}
class HeaderText {
  public:
    explicit HeaderText(std::string_view text) : text_(text) {}

    /// Nothing if it is no such dictionary.
    std::optional<Header> parse() {
        Header header;
        if (!take("{")) return std::nullopt;
        while (!take("}")) {
            const auto key = parse_string();
            if (!key || !take(":") || !parse_value(*key, header)) return std::nullopt;
            if (header.dtype == "[") return header;  // its fields are not wanted
            if (!take(",") && !is_next('}')) return std::nullopt;
        }
        if (header.dtype.empty() || !header.is_fortran || !header.shape) return std::nullopt;
        return header;
    }

  private:
    bool is_next(char c) {
        text_.remove_prefix(std::min(text_.find_first_not_of(" \n"), text_.size()));
        return text_.starts_with(c);
    }
    bool take(std::string_view word) {
        if (!is_next(word.front()) || !text_.starts_with(word)) return false;
        text_.remove_prefix(word.size());
        return true;
    }
    std::optional<std::string> parse_string() {
        const char mark = is_next('"') ? '"' : '\'';
        if (!take(std::string_view(&mark, 1))) return std::nullopt;
        const std::size_t end = text_.find(mark);
        if (end == std::string_view::npos) return std::nullopt;
        std::string string(text_.substr(0, end));
        text_.remove_prefix(end + 1);
        return string;
    }
    bool parse_value(const std::string& key, Header& header) {
        if (key == "descr") {
            header.dtype = is_next('[') ? "[" : parse_string().value_or("");
            return !header.dtype.empty();
        }
        if (key == "fortran_order") {
            header.is_fortran = take("True");
            return *header.is_fortran || take("False");
        }
        return key == "shape" && parse_shape(header.shape.emplace());
    }
    bool parse_shape(std::vector<std::uint64_t>& shape) {
        if (!take("(")) return false;
        while (!take(")")) {
            is_next(' ');
            std::uint64_t size = 0;
            const auto [end, error] =
                std::from_chars(text_.data(), text_.data() + text_.size(), size);
            if (error != std::errc()) return false;
            text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
            take("L");  // as Python 2 writes it
            shape.push_back(size);
            if (!take(",") && !is_next(')')) return false;
        }
        return true;
    }

    std::string_view text_;
};

using DecodeNumber = double (*)(const char* bytes, bool is_swapped);

template <class Number>
double decode(const char* bytes, bool is_swapped) {
    std::array<char, sizeof(Number)> copy{};
    std::memcpy(copy.data(), bytes, copy.size());
    if (is_swapped) std::reverse(copy.begin(), copy.end());
    return static_cast<double>(std::bit_cast<Number>(copy));
}

struct NumberType {
    std::string_view name;  ///< without byte order
    std::size_t size;
    DecodeNumber decode;
};
constexpr std::array number_types{
    NumberType{"f8", 8, decode<double>},        NumberType{"f4", 4, decode<float>},
    NumberType{"i8", 8, decode<std::int64_t>},  NumberType{"i4", 4, decode<std::int32_t>},
    NumberType{"i2", 2, decode<std::int16_t>},  NumberType{"i1", 1, decode<std::int8_t>},
    NumberType{"u8", 8, decode<std::uint64_t>}, NumberType{"u4", 4, decode<std::uint32_t>},
    NumberType{"u2", 2, decode<std::uint16_t>}, NumberType{"u1", 1, decode<std::uint8_t>},
    NumberType{"b1", 1, decode<std::uint8_t>}};

/// Null: none that is read.
const NumberType* find_type(std::string_view dtype) {
    const bool has_order = dtype.find_first_of("<>|=") == 0;
    const auto found = std::ranges::find(number_types, dtype.substr(has_order ? 1 : 0),
                                         [](const NumberType& type) { return type.name; });
    return found == number_types.end() ? nullptr : &*found;
}

/// "200 x 3 x 21".
std::string words(const std::vector<std::uint64_t>& shape) {
    return shape.empty() ? "one number" : fmt::format("{}", fmt::join(shape, " x "));
}

/// Unsigned number of that many bytes, the lowest first.
std::size_t little_endian(std::string_view bytes) {
    std::size_t number = 0;
    for (std::size_t k = bytes.size(); k-- > 0;) {
        number = 256 * number + static_cast<unsigned char>(bytes[k]);
    }
    return number;
}

/// Product of the sizes; nothing if it is above `most`.
std::optional<std::uint64_t> count_of_shape(const std::vector<std::uint64_t>& shape,
                                            std::uint64_t most) {
    std::uint64_t count = 1;
    for (const std::uint64_t size : shape) {
        if (size > most / count) return std::nullopt;
        count *= size;
    }
    return count;
}

}  // namespace

NpyArray parse_npy(std::string_view content, const std::string& path, const std::string& subject) {
    const auto error = [&](const std::string& problem) {
        return input_error_at({path}, subject + problem);
    };
    constexpr std::size_t fixed_size = 8;  // the mark and the version
    const char version = content.size() > fixed_size + 4 ? content[6] : '\0';
    if (!content.starts_with(magic) || version < 1 || version > 3) {
        throw error("is not an array of NumPy; must be as numpy.save() writes it");
    }
    const std::size_t begin = fixed_size + (version == 1 ? 2 : 4);
    const std::size_t length = little_endian(content.substr(fixed_size, begin - fixed_size));
    if (length > content.size() - begin) throw error("is cut short in its header");
    const auto header = HeaderText(content.substr(begin, length)).parse();
    if (!header) throw error("has a damaged header; must be as numpy.save() writes it");
    const NumberType* const type = find_type(header->dtype);
    if (type == nullptr) {
        throw error(fmt::format(
            "has elements of {}; must be real numbers (float64, float32 or integers), as "
            "numpy.asarray(a, dtype=float) makes them",
            header->dtype == "[" ? "several fields" : "dtype " + quote(header->dtype)));
    }
    const std::vector<std::uint64_t>& shape = *header->shape;
    if ((shape.size() != 2 && shape.size() != 3) || std::ranges::find(shape, 0U) != shape.end()) {
        throw error(fmt::format(
            "is {}; must be rows x parameters, or poses x rows x parameters, none of them 0",
            shape.size() == 1 ? fmt::format("a vector of {}", shape[0]) : words(shape)));
    }
    const std::string_view data = content.substr(begin + length);
    const auto count = count_of_shape(shape, data.size() / type->size);
    if (!count || *count * type->size != data.size()) {
        throw error(fmt::format(
            "is {} of {} B by its header, but holds {} B of them; {}", words(shape), type->size,
            data.size(),
            count ? "must end with its last number" : "is cut short, or its header is damaged"));
    }
    const bool is_stacked = shape.size() == 3;
    const auto poses = static_cast<Index>(shape[0]);
    const auto rows = static_cast<Index>(is_stacked ? shape[1] : 1);
    const auto columns = static_cast<Index>(shape.back());
    const bool is_big = header->dtype[0] == '>';
    const bool is_swapped = is_big != (std::endian::native == std::endian::big) &&
                            header->dtype[0] != '=' && header->dtype[0] != '|';
    NpyArray array{RowMatrixXd(poses * rows, columns), is_stacked ? rows : 0};
    for (Index pose = 0; pose < poses; ++pose) {
        for (Index row = 0; row < rows; ++row) {
            for (Index column = 0; column < columns; ++column) {
                const Index place = *header->is_fortran ? pose + poses * (row + rows * column)
                                                        : (pose * rows + row) * columns + column;
                const double value = type->decode(
                    data.data() + static_cast<std::size_t>(place) * type->size, is_swapped);
                if (!std::isfinite(value)) {
                    throw error(fmt::format("has {} at [{}{}, {}]; must be finite numbers", value,
                                            pose, is_stacked ? fmt::format(", {}", row) : "",
                                            column));
                }
                array.matrix(pose * rows + row, column) = value;
            }
        }
    }
    return array;
}

std::string npy_text(const RowMatrixXd& matrix, Index rows_per_pose) {
    static_assert(std::endian::native == std::endian::little);
    constexpr std::size_t alignment = 64;
    const std::string shape = rows_per_pose == 0
                                  ? fmt::format("({}, {})", matrix.rows(), matrix.cols())
                                  : fmt::format("({}, {}, {})", matrix.rows() / rows_per_pose,
                                                rows_per_pose, matrix.cols());
    std::string header =
        fmt::format("{{'descr': '<f8', 'fortran_order': False, 'shape': {}, }}", shape);
    const std::size_t before = magic.size() + 4;
    header.resize((before + header.size() + alignment) / alignment * alignment - before - 1, ' ');
    header += '\n';
    std::string text(magic);
    text += {'\1', '\0', static_cast<char>(header.size()), '\0'};
    text += header;
    const auto* const bytes = reinterpret_cast<const char*>(matrix.data());
    return text.append(bytes, static_cast<std::size_t>(matrix.size()) * sizeof(double));
}

}  // namespace posewise::detail
