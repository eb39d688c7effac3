#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/errors.hpp"

namespace posewise::detail {

/// How lines are taken apart.
enum class CsvStyle {
    Table,  ///< with commas, semicolons or tabs
    /// As programs list points: blanks separate where none of these does, any number of them as
    /// one; lines that begin with `//` or `#` are comments wherever they stand.
    List,
};

/// Rows of separated fields, one line each. The separator (comma, semicolon or tab) is taken from
/// the first row; blank lines are skipped, and before the first row lines that begin with `#`; a
/// byte order mark and carriage returns at the end of lines do not matter; fields may stand in
/// double quotes, in which two of them are one.
class CsvReader {
  public:
    explicit CsvReader(const std::string& path);
    /// Of what was read from that file already.
    CsvReader(std::string path, std::string content, CsvStyle style);

    /// Moves to the next row; false at the end.
    bool next_row();

    /// Fields of the row, valid until the next, without blanks and quotes around them.
    const std::vector<std::string_view>& fields() const { return fields_; }
    long line() const { return line_; }
    /// Where a field of the row begins; field = fields().size() is the end of the row.
    FileLocation locate(std::size_t field) const;

  private:
    void check_row() const;
    bool is_comment(std::string_view text) const;
    char find_separator() const;
    void split();
    void split_at_blanks();
    std::size_t closing_quote(std::size_t opening) const;
    std::size_t field_end(std::size_t begin) const;
    std::string_view unquote(std::string_view field);

    std::string path_;
    std::string content_;
    CsvStyle style_;
    std::size_t next_ = 0;  // where the next line begins
    long line_ = 0;
    char separator_ = '\0';  // not known before the first row
    std::string_view row_;
    std::vector<std::string_view> fields_;
};

/// Text as a field: in quotes if it must be, those inside doubled.
std::string csv_field(std::string_view text);

}  // namespace posewise::detail
