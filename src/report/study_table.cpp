#include "study_table.hpp"

#include <algorithm>

#include "core/format.hpp"

namespace posewise::detail {
namespace {

/// All units of errors are a thousandth of those of the library.
std::string cell(const std::optional<double>& error) { return error ? format_mm(*error) : "-"; }

std::string unit_of(const Study& study) { return '/' + std::string(study.units->error); }

std::string unidentified_cell(const StudyCases& cases) {
    return cases.empty() ? "-" : std::to_string(count_unidentified(cases));
}

std::string ratio_cell(const std::optional<Advantage>& advantage) {
    return advantage ? format_fixed(advantage->ratio, 2) : "-";
}

std::string interval_cell(const std::optional<Advantage>& advantage) {
    if (!advantage || advantage->is_of_one_split()) return "-";
    return format_fixed(advantage->lower, 2) + ".." + format_fixed(advantage->upper, 2);
}

void add_advantage(const std::optional<Advantage>& advantage, std::vector<std::string>& cells) {
    cells.push_back(ratio_cell(advantage));
    cells.push_back(interval_cell(advantage));
}

std::string split_cell(const Study& study, const StudyRow& row) {
    return std::to_string(split_count(row, study.criteria.size()));
}

/// Some pose counts have fewer splits than were asked for.
bool is_partial(const Study& study) {
    return study.splits > 0 && std::ranges::any_of(study.rows, [&](const StudyRow& row) {
               return split_count(row, study.criteria.size()) < study.splits;
           });
}

std::vector<std::string> model_cells(const Study& study, const StudyRow& row,
                                     const StudyRow& first) {
    std::vector<std::string> cells{std::to_string(row.pose_count), study.model,
                                   cell(held_out_quantile(row.random, 0.5))};
    for (std::size_t c = 0; c < study.criteria.size(); ++c) {
        const auto planned = planned_cases(row, c, study.criteria.size());
        cells.push_back(cell(held_out_quantile(planned, 0.5)));
        if (study.splits == 0) continue;
        add_advantage(planned_advantage(study, row, c), cells);
        cells.push_back(ratio_cell(planned_advantage(study, row, c, first)));
    }
    cells.push_back(unidentified_cell(row.random));
    if (is_partial(study)) cells.push_back(split_cell(study, row));
    return cells;
}

}  // namespace

Table study_table(const Study& study) {
    Table table;
    table.header = {"poses"};
    for (const Criterion criterion : study.criteria) {
        table.header.push_back(std::string(criterion_name(criterion)) + unit_of(study));
        if (study.splits == 0) continue;
        table.header.emplace_back("expected");
        table.header.push_back(std::string(criterion_name(criterion)) + "/random");
        table.header.emplace_back("95 %");
    }
    for (const char* name : {"random 10 %", "50 %", "90 %"}) {
        table.header.push_back(name + unit_of(study));
    }
    table.header.insert(table.header.end(), {"subsets", "unidentified"});
    if (is_partial(study)) table.header.emplace_back("splits");
    for (const StudyRow& row : study.rows) {
        std::vector<std::string> cells{std::to_string(row.pose_count)};
        for (std::size_t c = 0; c < study.criteria.size(); ++c) {
            const auto planned = planned_cases(row, c, study.criteria.size());
            cells.push_back(cell(held_out_quantile(planned, 0.5)));
            if (study.splits > 0) cells.push_back(cell(median_expected(planned)));
            if (study.splits > 0) add_advantage(planned_advantage(study, row, c), cells);
        }
        for (const double p : {0.1, 0.5, 0.9})
            cells.push_back(cell(held_out_quantile(row.random, p)));
        cells.push_back(std::to_string(row.random.size()));
        cells.push_back(unidentified_cell(row.random));
        if (is_partial(study)) cells.push_back(split_cell(study, row));
        table.rows.push_back(std::move(cells));
    }
    return table;
}

Table models_table(const std::vector<Study>& studies) {
    const Study& first = studies.front();
    Table table;
    table.header = {"poses", first.is_simulated ? "variation" : "model", "random" + unit_of(first)};
    for (const Criterion criterion : first.criteria) {
        const std::string name(criterion_name(criterion));
        table.header.push_back(name + unit_of(first));
        if (first.splits == 0) continue;
        table.header.insert(table.header.end(),
                            {name + "/random", "95 %",
                             name + "/random " + (first.is_simulated ? "of first" : first.model)});
    }
    table.header.emplace_back("unidentified");
    if (is_partial(first)) table.header.emplace_back("splits");
    for (std::size_t i = 0; i < first.rows.size(); ++i) {
        for (const Study& study : studies) {
            table.rows.push_back(model_cells(study, study.rows[i], first.rows[i]));
        }
    }
    return table;
}

}  // namespace posewise::detail
