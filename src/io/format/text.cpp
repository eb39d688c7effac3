#include "text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace posewise::detail {
namespace {

bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }

}  // namespace

std::string_view trim(std::string_view text) {
    constexpr std::string_view blanks = " \t\r";
    const auto first = text.find_first_not_of(blanks);
    if (first == std::string_view::npos) return text.substr(0, 0);
    return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

std::size_t find_not_utf8(std::string_view text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = character_length(text.substr(at));
        if (length == 1 && static_cast<unsigned char>(text[at]) >= 0x80) return at;
        at += length;
    }
    return std::string_view::npos;
}

std::string with_article(const std::string& noun) {
    return (noun.starts_with('e') ? "an " : "a ") + noun;
}

bool is_identifier(std::string_view text) {
    return !text.empty() && is_letter(text[0]) && std::all_of(text.begin(), text.end(), [](char c) {
        return is_letter(c) || is_digit(c);
    });
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

}  // namespace posewise::detail
