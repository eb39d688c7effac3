#include "text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace posewise::io {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// Levenshtein's distance: insertions, deletions and replacements that turn one into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> row(b.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::size_t diagonal = row[0];
        row[0] = i + 1;
        for (std::size_t j = 0; j < b.size(); ++j) {
            const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
            diagonal = row[j + 1];
            row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
        }
    }
    return row.back();
}

}  // namespace

std::string_view trim(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return text.substr(0, 0);
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

bool is_identifier(std::string_view text) {
    return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [](char c) {
        return is_letter(c) || is_digit(c);
    });
}

std::string list_words(const std::vector<std::string>& words) {
    std::string list;
    for (std::size_t i = 0; i < words.size(); ++i) {
        if (i > 0) list += i + 1 == words.size() ? " or " : ", ";
        list += words[i];
    }
    return list;
}

std::string suggest(std::string_view unknown, const std::vector<std::string>& known) {
    const std::string_view compared = unknown.substr(0, 100);
    std::size_t least = std::max<std::size_t>(2, compared.size() / 3) + 1;
    const std::string* nearest = nullptr;
    for (const std::string& name : known) {
        const std::size_t distance = edit_distance(compared, name);
        if (distance < least && distance < name.size()) {
            least = distance;
            nearest = &name;
        }
    }
    if (nearest != nullptr) return "did you mean '" + *nearest + "'?";
    if (known.empty()) return "none is known here";
    return "must be " + list_words(known);
}

ParsedNumber parse_number(std::string_view text) {
    text = trim(text);
    if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
    ParsedNumber number;
    const auto [end, error] = std::from_chars(text.begin(), text.end(), number.value);
    if (error == std::errc::invalid_argument || end != text.end()) {
        number.problem = "is not a number";
    } else if (error == std::errc::result_out_of_range) {
        number.problem = "is beyond the range of numbers";
    } else if (!std::isfinite(number.value)) {
        number.problem = "is not finite";
    }
    return number;
}

}  // namespace posewise::io
