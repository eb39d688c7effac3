#include "target_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>

#include "io/format/text.hpp"

namespace posewise::detail {
namespace {

bool is_blank(char letter) { return std::isspace(static_cast<unsigned char>(letter)) != 0; }

}  // namespace

const ProgramKind* target_kind_of(io::ProgramFormat format) {
    switch (format) {
        case io::ProgramFormat::Fanuc:
            return &fanuc_program();
        case io::ProgramFormat::Kuka:
            return &kuka_program();
        case io::ProgramFormat::Abb:
            return &abb_program();
        case io::ProgramFormat::Ur:
            return &ur_program();
        default:
            return nullptr;
    }
}

std::string masked(const std::string& content, char comment) {
    std::string text = content;
    char within = 0;
    for (char& letter : text) {
        if (letter == '\n') {
            within = 0;
        } else if (within == 0) {
            if (letter == comment || letter == '"') within = letter;
            if (within != 0) letter = ' ';
        } else {
            if (letter == within && within == '"') within = 0;
            letter = ' ';
        }
    }
    return text;
}

void Cursor::skip_blanks() {
    while (!is_at_end() && is_blank(text_[at_])) ++at_;
}

bool Cursor::take(char letter) {
    skip_blanks();
    if (is_at_end() || text_[at_] != letter) return false;
    ++at_;
    return true;
}

std::string_view Cursor::word() {
    skip_blanks();
    const std::size_t begin = at_;
    while (!is_at_end() && is_word_letter(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
}

std::optional<io::TextSpan> Cursor::number() {
    skip_blanks();
    const std::size_t end = std::min(text_.find_first_not_of("+-.0123456789eE", at_), text_.size());
    const io::TextSpan span{at_, end};
    if (!parse_number(text_.substr(at_, end - at_)).ok()) return std::nullopt;
    at_ = end;
    return span;
}

std::optional<std::vector<io::TextSpan>> Cursor::numbers(std::size_t count, char close) {
    std::vector<io::TextSpan> spans;
    while (spans.size() < count) {
        if (!spans.empty() && !take(',')) return std::nullopt;
        const auto span = number();
        if (!span) return std::nullopt;
        spans.push_back(*span);
    }
    if (!take(close)) return std::nullopt;
    return spans;
}

int decimals_of(std::string_view text, int least) {
    const std::size_t point = text.find('.');
    const bool is_plain = text.find_first_of("eE") == std::string_view::npos;
    if (point == std::string_view::npos || !is_plain) return least;
    constexpr std::size_t most = 12;  // a double holds no more of a turn
    return std::max(least, static_cast<int>(std::min(most, text.size() - point - 1)));
}

std::string number_text(std::string_view text, int least, double number) {
    const int decimals = decimals_of(text, least);
    std::string replaced = fmt::format("{:.{}f}", number, decimals);
    const bool is_zero = replaced.find_first_not_of("-0.") == std::string::npos;
    if (is_zero && replaced[0] == '-') replaced.erase(0, 1);
    const double change = parse_number(replaced).value - parse_number(text).value;
    const bool is_same = std::abs(change) < 0.501 * std::pow(10.0, -decimals);
    return is_same ? std::string(text) : replaced;
}

double number_at(const std::string& content, const io::TextSpan& span) {
    return parse_number(std::string_view(content).substr(span.begin, span.end - span.begin)).value;
}

}  // namespace posewise::detail
