#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

namespace posewise::detail {
namespace {

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

bool is_continuation(char c) { return (static_cast<unsigned char>(c) & 0xC0) == 0x80; }

/// Whether a terminal shows it where it stands: no control character, none that turns the order of
/// others round, no line end, no byte that is no UTF-8.
bool is_shown(std::string_view character) {
    const auto byte = static_cast<unsigned char>(character[0]);
    if (character.size() == 1) return byte >= 0x20 && byte < 0x7f;
    if (character.size() == 2 && byte == 0xC2) return character[1] >= '\xA0';
    using namespace std::string_view_literals;
    constexpr std::array hidden{
        "\xD8\x9C"sv,     "\xE2\x80\x8E"sv, "\xE2\x80\x8F"sv, "\xE2\x80\xA8"sv, "\xE2\x80\xA9"sv,
        "\xE2\x80\xAA"sv, "\xE2\x80\xAB"sv, "\xE2\x80\xAC"sv, "\xE2\x80\xAD"sv, "\xE2\x80\xAE"sv,
        "\xE2\x81\xA6"sv, "\xE2\x81\xA7"sv, "\xE2\x81\xA8"sv, "\xE2\x81\xA9"sv};
    return std::ranges::find(hidden, character) == hidden.end();
}

/// The longest beginning of at most `most` bytes that ends with a whole character.
std::string_view cut(std::string_view text, std::size_t most) {
    if (text.size() <= most) return text;
    std::size_t end = most;
    while (end > 0 && most - end < 4 && is_continuation(text[end])) --end;
    return text.substr(0, is_continuation(text[end]) ? most : end);
}

}  // namespace

std::string escape_controls(std::string_view text) {
    constexpr const char* digits = "0123456789abcdef";
    std::string escaped;
    while (!text.empty()) {
        const std::string_view character = text.substr(0, character_length(text));
        text.remove_prefix(character.size());
        if (is_shown(character)) {
            escaped += character;
            continue;
        }
        for (const char c : character) {
            const auto byte = static_cast<unsigned char>(c);
            escaped += {'\\', 'x', digits[byte / 16], digits[byte % 16]};
        }
    }
    return escaped;
}

std::string quote(std::string_view text) {
    constexpr std::size_t most = 60;
    const std::string_view shown = cut(text, most);
    return '\'' + escape_controls(shown) + (shown.size() < text.size() ? "...'" : "'");
}

std::size_t character_length(std::string_view text) {
    const auto byte_at = [text](std::size_t k) {
        return k < text.size() ? static_cast<unsigned char>(text[k]) : 0U;
    };
    const unsigned first = byte_at(0);
    if (first < 0xC2 || first > 0xF4) return 1;
    const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
    // The second byte tells overlong forms, surrogates and what is beyond U+10FFFF.
    const unsigned least = first == 0xE0 ? 0xA0 : first == 0xF0 ? 0x90 : 0x80;
    const unsigned most = first == 0xED ? 0x9F : first == 0xF4 ? 0x8F : 0xBF;
    bool is_good = byte_at(1) >= least && byte_at(1) <= most;
    for (std::size_t k = 2; k < length; ++k) {
        is_good = is_good && byte_at(k) >= 0x80 && byte_at(k) <= 0xBF;
    }
    return is_good ? length : 1;
}

std::string count_of(Index count, const std::string& noun) {
    return std::to_string(count) + ' ' + noun + (count == 1 ? "" : "s");
}

std::string these(Index count, const std::string& noun) {
    return count == 1 ? "this " + noun : "these " + count_of(count, noun);
}

std::vector<std::string> wrap(const std::string& text, std::size_t width) {
    std::vector<std::string> lines{text};
    while (lines.back().size() > width) {
        std::string& line = lines.back();
        std::size_t blank = line.rfind(' ', width);
        if (blank == std::string::npos || blank == 0) blank = line.find(' ', width);
        if (blank == std::string::npos) break;
        std::string rest = line.substr(blank + 1);
        line.resize(blank);
        lines.push_back(std::move(rest));
    }
    return lines;
}

std::string list_words(const std::vector<std::string>& words) {
    constexpr std::size_t most = 30;
    const std::size_t shown = std::min(words.size(), most);
    std::string list;
    for (std::size_t i = 0; i < shown; ++i) {
        if (i > 0) list += i + 1 == words.size() ? " or " : ", ";
        list += words[i];
    }
    return shown < words.size() ? list + ", ..." : list;
}

std::string describe_combination(const VectorXd& coefficients,
                                 const std::vector<std::string>& names) {
    constexpr std::size_t most = 4;
    std::vector<Index> order(static_cast<std::size_t>(coefficients.size()));
    std::iota(order.begin(), order.end(), Index{0});
    // Equal to rounding: by place, so that the text is the same on every machine.
    const auto size = [&](Index i) { return std::round(1e6 * std::abs(coefficients[i])); };
    std::stable_sort(order.begin(), order.end(),
                     [&](Index a, Index b) { return size(a) > size(b); });
    const double largest = coefficients[order.front()];
    const double factor = (largest < 0 ? -1 : 1) / coefficients.norm();
    std::string text;
    for (std::size_t k = 0; k < std::min(most, order.size()); ++k) {
        const Index i = order[k];
        if (std::abs(coefficients[i]) < 0.1 * std::abs(largest)) break;
        const double share = factor * coefficients[i];
        const char* const sign = share < 0 ? " - " : k > 0 ? " + " : "";
        text += fmt::format("{}{:.2g} ", sign, std::abs(share));
        text +=
            names.empty() ? fmt::format("column {}", i + 1) : names[static_cast<std::size_t>(i)];
    }
    return text;
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
    if (nearest != nullptr) return "did you mean " + quote(*nearest) + "?";
    if (known.empty()) return "none is known here";
    return "must be " + list_words(known);
}

}  // namespace posewise::detail
