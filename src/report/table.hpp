#pragma once

#include <string>
#include <vector>

namespace posewise::detail {

/// A table of text, one string a cell. Rows shorter than the header are padded with empty cells.
struct Table {
    std::vector<std::string> header;  ///< with the unit, e.g. "RMS/mm"
    std::vector<std::vector<std::string>> rows;
};

/// Aligned text: two spaces between columns, a rule below the header, a newline after every row.
/// A column that holds only numbers, "-" and empty cells is right-aligned, any other left-aligned.
/// Text in the last column goes on below where the row is longer than 100 characters.
std::string format_table(const Table& table);

/// The table under its title, after an empty line.
std::string format_section(const std::string& title, const Table& table);

}  // namespace posewise::detail
