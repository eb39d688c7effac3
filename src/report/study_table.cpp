#include "study_table.hpp"

#include <algorithm>

#include "../core/format.hpp"

namespace posewise::detail {
namespace {

std::string cell(const std::optional<double>& metres) { return metres ? format_mm(*metres) : "-"; }

std::string unidentified_cell(const std::vector<StudyCase>& cases) {
    if (cases.empty()) return "-";
    return std::to_string(
        std::count_if(cases.begin(), cases.end(),
                      [](const StudyCase& study_case) { return !study_case.identified; }));
}

}  // namespace

Table study_table(const Study& study) {
    Table table;
    table.header = {"poses"};
    for (const Criterion criterion : study.criteria) {
        table.header.push_back(std::string(criterion_name(criterion)) + "/mm");
    }
    for (const char* name : {"random 10 %/mm", "50 %/mm", "90 %/mm", "subsets", "unidentified"}) {
        table.header.emplace_back(name);
    }
    for (const StudyRow& row : study.rows) {
        std::vector<std::string> cells{std::to_string(row.pose_count)};
        for (const StudyCase& optimal : row.optimal) {
            cells.push_back(cell(held_out_quantile({optimal}, 0.5)));
        }
        for (const double p : {0.1, 0.5, 0.9})
            cells.push_back(cell(held_out_quantile(row.random, p)));
        cells.push_back(std::to_string(row.random.size()));
        cells.push_back(unidentified_cell(row.random));
        table.rows.push_back(std::move(cells));
    }
    return table;
}

}  // namespace posewise::detail
