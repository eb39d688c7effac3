#include "csv_reader.hpp"

#include <algorithm>

#include "atomic_file.hpp"
#include "file_kind.hpp"
#include "text.hpp"

namespace posewise::detail {
namespace {

/// Without blanks other than tabs, which may separate.
std::string_view trim_row(std::string_view row) {
    while (!row.empty() && row.back() == '\r') row.remove_suffix(1);
    return row;
}

}  // namespace

CsvReader::CsvReader(const std::string& path) : CsvReader(path, read_file(path), CsvStyle::Table) {}

CsvReader::CsvReader(std::string path, std::string content, CsvStyle style)
    : path_(std::move(path)), content_(std::move(content)), style_(style) {
    if (content_.starts_with("\xEF\xBB\xBF")) content_.erase(0, 3);
    check_file_kind(content_, path_, FileKind::Table, "a table (CSV)");
    if (content_.starts_with("\xFF\xFE") || content_.starts_with("\xFE\xFF")) {
        throw input_error_at({path_}, "is UTF-16; must be UTF-8 (or plain ASCII)");
    }
    const bool has_returns = content_.find('\r') < content_.find_last_not_of('\r');
    if (has_returns && content_.find('\n') == std::string::npos) {
        throw input_error_at({path_}, "has line ends of CR only; must be of LF or CR LF");
    }
}

bool CsvReader::is_comment(std::string_view text) const {
    if (style_ == CsvStyle::Table) return separator_ == '\0' && text.starts_with('#');
    return text.starts_with('#') || text.starts_with("//");
}

char CsvReader::find_separator() const {
    const auto count = [this](char c) { return std::count(row_.begin(), row_.end(), c); };
    char separator = ',';
    for (const char candidate : {';', '\t'}) {
        if (count(candidate) > count(separator)) separator = candidate;
    }
    return style_ == CsvStyle::List && count(separator) == 0 ? ' ' : separator;
}

bool CsvReader::next_row() {
    while (next_ < content_.size()) {
        const std::size_t end = std::min(content_.find('\n', next_), content_.size());
        row_ = trim_row(std::string_view(content_).substr(next_, end - next_));
        next_ = end + 1;
        ++line_;
        const std::string_view text = trim(row_);
        if (text.empty() || is_comment(text)) continue;
        check_row();
        if (separator_ == '\0') separator_ = find_separator();
        if (separator_ == ' ') {
            split_at_blanks();
        } else {
            split();
        }
        return true;
    }
    return false;
}

void CsvReader::check_row() const {
    const auto error = [&](std::size_t at, const std::string& problem) {
        return input_error_at({path_, line_, static_cast<long>(at) + 1}, problem);
    };
    const std::size_t at = find_not_utf8(row_);
    if (at != std::string_view::npos) {
        throw error(at, "is not UTF-8 text here; must be UTF-8 (or plain ASCII)");
    }
    if (trim(row_).starts_with('#')) {
        throw error(0,
                    "the row begins with '#', which is a comment only before the header; must "
                    "be left out, or have its first cell in quotes");
    }
}

/// Where the quotation mark is closed; two of them are one of the text.
std::size_t CsvReader::closing_quote(std::size_t opening) const {
    std::size_t closing = row_.find('"', opening + 1);
    while (closing != std::string_view::npos && row_.substr(closing + 1).starts_with('"')) {
        closing = row_.find('"', closing + 2);
    }
    if (closing == std::string_view::npos) {
        throw input_error_at({path_, line_, static_cast<long>(opening) + 1},
                             "a quotation mark is not closed in its line");
    }
    return closing;
}

std::size_t CsvReader::field_end(std::size_t begin) const {
    const char* const blanks = separator_ == '\t' ? " " : " \t";
    const std::size_t first = row_.find_first_not_of(blanks, begin);
    if (first != std::string_view::npos && row_[first] == '"') {
        begin = closing_quote(first) + 1;
        const std::size_t end = std::min(row_.find(separator_, begin), row_.size());
        if (trim(row_.substr(begin, end - begin)).empty()) return end;
        throw input_error_at({path_, line_, static_cast<long>(begin)},
                             "a quotation mark is closed before the cell ends; must be doubled "
                             "inside quotes");
    }
    return std::min(row_.find(separator_, begin), row_.size());
}

/// Without the quotes around it; doubled ones inside become one, in place.
std::string_view CsvReader::unquote(std::string_view field) {
    field = field.substr(1, field.size() - 2);
    if (field.find('"') == std::string_view::npos) return field;
    const auto begin = static_cast<std::size_t>(field.data() - content_.data());
    std::size_t size = 0;
    for (std::size_t k = 0; k < field.size(); ++k) {
        if (field[k] == '"' && k + 1 < field.size()) ++k;
        content_[begin + size++] = field[k];
    }
    return field.substr(0, size);
}

void CsvReader::split() {
    fields_.clear();
    for (std::size_t begin = 0; begin <= row_.size();) {
        const std::size_t end = field_end(begin);
        std::string_view field = trim(row_.substr(begin, end - begin));
        if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
            field = unquote(field);
        }
        fields_.push_back(field);
        begin = end + 1;
    }
}

/// What stands in quotes is one field, blanks and all.
void CsvReader::split_at_blanks() {
    constexpr const char* blanks = " \t";
    fields_.clear();
    for (std::size_t begin = row_.find_first_not_of(blanks); begin != std::string_view::npos;) {
        const bool is_quoted = row_[begin] == '"';
        const std::size_t from = is_quoted ? closing_quote(begin) + 1 : begin;
        const std::size_t end = std::min(row_.find_first_of(blanks, from), row_.size());
        const std::string_view field = row_.substr(begin, end - begin);
        fields_.push_back(is_quoted && end == from ? unquote(field) : field);
        begin = row_.find_first_not_of(blanks, end);
    }
}

FileLocation CsvReader::locate(std::size_t field) const {
    // Fields are views of the row, so their place in it is known without having been stored.
    const std::ptrdiff_t offset = field < fields_.size() ? fields_[field].data() - row_.data()
                                                         : static_cast<std::ptrdiff_t>(row_.size());
    return {path_, line_, static_cast<long>(std::max<std::ptrdiff_t>(offset, 0)) + 1};
}

std::string csv_field(std::string_view text) {
    const bool is_plain = text.find_first_of(",;\t#\"\r\n") == std::string_view::npos;
    if (is_plain && trim(text) == text) return std::string(text);
    std::string field = "\"";
    for (const char c : text) {
        if (c == '"') field += '"';
        field += c == '\n' || c == '\r' ? ' ' : c;
    }
    return field + '"';
}

}  // namespace posewise::detail
