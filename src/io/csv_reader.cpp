#include "csv_reader.hpp"

#include <algorithm>

#include "atomic_file.hpp"
#include "text.hpp"

namespace posewise::detail {
namespace {

char find_separator(std::string_view header) {
    char separator = ',';
    for (const char candidate : {';', '\t'}) {
        if (std::count(header.begin(), header.end(), candidate) >
            std::count(header.begin(), header.end(), separator)) {
            separator = candidate;
        }
    }
    return separator;
}

/// Without blanks other than tabs, which may separate.
std::string_view trim_row(std::string_view row) {
    while (!row.empty() && row.back() == '\r') row.remove_suffix(1);
    return row;
}

}  // namespace

CsvReader::CsvReader(const std::string& path) : path_(path), content_(read_file(path)) {
    if (content_.starts_with("\xEF\xBB\xBF")) content_.erase(0, 3);
}

bool CsvReader::next_row() {
    while (next_ < content_.size()) {
        const std::size_t end = std::min(content_.find('\n', next_), content_.size());
        row_ = trim_row(std::string_view(content_).substr(next_, end - next_));
        next_ = end + 1;
        ++line_;
        const std::string_view text = trim(row_);
        if (text.empty() || text.starts_with('#')) continue;
        if (separator_ == '\0') separator_ = find_separator(row_);
        split();
        return true;
    }
    return false;
}

std::size_t CsvReader::field_end(std::size_t begin) const {
    const std::size_t first = row_.find_first_not_of(' ', begin);
    if (first != std::string_view::npos && row_[first] == '"') {
        const std::size_t closing = row_.find('"', first + 1);
        if (closing == std::string_view::npos) {
            throw input_error_at({path_, line_, static_cast<long>(first) + 1},
                                 "a quotation mark is not closed in its line");
        }
        begin = closing;
    }
    return std::min(row_.find(separator_, begin), row_.size());
}

void CsvReader::split() {
    fields_.clear();
    for (std::size_t begin = 0; begin <= row_.size();) {
        const std::size_t end = field_end(begin);
        std::string_view field = trim(row_.substr(begin, end - begin));
        if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
            field = field.substr(1, field.size() - 2);
        }
        fields_.push_back(field);
        begin = end + 1;
    }
}

FileLocation CsvReader::locate(std::size_t field) const {
    // Fields are views of the row, so their place in it is known without having been stored.
    const std::ptrdiff_t offset = field < fields_.size() ? fields_[field].data() - row_.data()
                                                         : static_cast<std::ptrdiff_t>(row_.size());
    return {path_, line_, static_cast<long>(std::max<std::ptrdiff_t>(offset, 0)) + 1};
}

std::string csv_field(std::string_view text) {
    std::string field(text);
    std::replace(field.begin(), field.end(), '"', '\'');
    std::replace(field.begin(), field.end(), '\n', ' ');
    return field.find_first_of(",;\t#") == std::string::npos && trim(field) == field
               ? field
               : '"' + field + '"';
}

}  // namespace posewise::detail
