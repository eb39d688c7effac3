#include "table.hpp"

#include <algorithm>
#include <cstdlib>

#include "core/text.hpp"

namespace posewise::detail {
namespace {

bool is_number(const std::string& cell) {
    if (cell.empty() || cell == "-") return true;
    char* end = nullptr;
    std::strtod(cell.c_str(), &end);
    return end == cell.c_str() + cell.size();
}

struct Column {
    std::size_t width = 0;
    bool right_aligned = true;
};

const std::string& cell_at(const std::vector<std::string>& row, std::size_t column) {
    static const std::string empty;
    return column < row.size() ? row[column] : empty;
}

std::vector<Column> measure(const Table& table) {
    std::vector<Column> columns(table.header.size());
    for (std::size_t i = 0; i < columns.size(); ++i) {
        columns[i].width = table.header[i].size();
        for (const auto& row : table.rows) {
            columns[i].width = std::max(columns[i].width, cell_at(row, i).size());
            columns[i].right_aligned = columns[i].right_aligned && is_number(cell_at(row, i));
        }
    }
    return columns;
}

/// Makes the last column, if it is text, as narrow as a page asks for, where that leaves it room.
void fit_to_page(std::vector<Column>& columns) {
    constexpr std::size_t page = 100;
    constexpr std::size_t least = 24;
    std::size_t before = 0;
    for (std::size_t i = 0; i + 1 < columns.size(); ++i) before += columns[i].width + 2;
    Column& last = columns.back();
    if (last.right_aligned || before + least > page) return;
    last.width = std::min(last.width, page - before);
}

std::string format_row(const std::vector<std::string>& row, const std::vector<Column>& columns) {
    std::string line;
    for (std::size_t i = 0; i + 1 < columns.size(); ++i) {
        const std::string& cell = cell_at(row, i);
        const std::string padding(columns[i].width - cell.size(), ' ');
        line += (columns[i].right_aligned ? padding + cell : cell + padding) + "  ";
    }
    const std::size_t indent = line.size();
    const std::size_t last = columns.size() - 1;
    std::string text;
    for (const std::string& part : wrap(cell_at(row, last), columns[last].width)) {
        if (columns[last].right_aligned) line.append(columns[last].width - part.size(), ' ');
        line += part;
        line.erase(line.find_last_not_of(' ') + 1);  // no trailing blanks
        text += line + '\n';
        line.assign(indent, ' ');
    }
    return text;
}

}  // namespace

std::string format_table(const Table& stated) {
    Table table = stated;
    for (auto& row : table.rows) {
        for (std::string& cell : row) cell = escape_controls(cell);
    }
    auto columns = measure(table);
    fit_to_page(columns);
    std::vector<std::string> rule;
    for (const Column& column : columns) rule.emplace_back(column.width, '-');
    std::string text = format_row(table.header, columns) + format_row(rule, columns);
    for (const auto& row : table.rows) text += format_row(row, columns);
    return text;
}

std::string format_section(const std::string& title, const Table& table) {
    return '\n' + title + "\n\n" + format_table(table);
}

}  // namespace posewise::detail
