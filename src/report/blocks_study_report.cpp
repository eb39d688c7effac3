#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/report/reports.hpp"
#include "table.hpp"

namespace posewise {
namespace {

using detail::format_fixed;
using detail::format_short;

constexpr int percent_decimals = 2;

std::string efficiency_text(double efficiency) {
    return format_fixed(100 * efficiency, percent_decimals);
}

detail::Table chosen_table(const BlocksStudy& study, int digits) {
    detail::Table table{{"poses", "criterion", "value", "bound", "efficiency/%", "random 5 %",
                         "50 %", "95 %", "their efficiency/% 5 %", "50 %", "95 %"},
                        {}};
    for (const BlocksStudyRow& row : study.rows) {
        const Choice& chosen = row.chosen;
        std::vector<std::string> cells{
            std::to_string(row.pose_count), std::string(criterion_name(row.criterion)),
            format_short(chosen.value, digits), format_short(chosen.bound, digits),
            efficiency_text(chosen.efficiency)};
        const RandomBand& random = row.random;
        if (random.subsets > 0) {
            for (const SubsetValue& one : {random.p5, random.p50, random.p95}) {
                cells.push_back(format_short(one.value, digits));
            }
            for (const SubsetValue& one : {random.p5, random.p50, random.p95}) {
                cells.push_back(efficiency_text(one.efficiency));
            }
        }
        table.rows.push_back(std::move(cells));
    }
    return table;
}

detail::Table own_table(const BlocksStudy& study, int digits) {
    detail::Table table{{"poses", "criterion", "value", "bound", "efficiency/%", "subset"}, {}};
    for (const BlocksStudyRow& row : study.rows) {
        for (const auto& [number, found] : row.own) {
            table.rows.push_back(
                {std::to_string(row.pose_count), std::string(criterion_name(row.criterion)),
                 format_short(found.value, digits), format_short(row.chosen.bound, digits),
                 efficiency_text(found.efficiency),
                 detail::escape_controls(study.subsets[number].name)});
        }
    }
    return table;
}

/// "3 5 7", as a field.
std::string join(const std::vector<Index>& poses) {
    std::string text;
    for (const Index pose : poses) text += (text.empty() ? "" : " ") + std::to_string(pose);
    return text;
}

/// As a CSV field.
std::string quote_field(const std::string& text) {
    if (text.find_first_of(",;\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

/// "by d, 20 of 200 candidates reach 98.21 % of the most that 20 can tell".
std::string sum_up(const BlocksStudy& study, const BlocksStudyRow& row) {
    const Criterion criterion = row.criterion;
    if (row.chosen.poses.empty()) {
        return fmt::format("{} of {} candidates do not identify the parameters", row.pose_count,
                           study.candidate_count);
    }
    std::string text =
        fmt::format("by {}, {} of {} candidates reach {} % of the largest value that is possible",
                    criterion_name(criterion), row.pose_count, study.candidate_count,
                    efficiency_text(row.chosen.efficiency));
    if (row.random.subsets > 0) {
        text += fmt::format("; half of {} random ones reach {} %", row.random.subsets,
                            efficiency_text(row.random.p50.efficiency));
    }
    return text;
}

/// The least count whose choice tells as much as half of the random subsets with the most poses.
std::string describe_saving(const BlocksStudy& study) {
    const auto is_first = [&](const BlocksStudyRow& row) {
        return row.criterion == study.criteria.front();
    };
    const auto last = std::find_if(study.rows.rbegin(), study.rows.rend(), is_first);
    if (last->random.subsets == 0) return "";
    const auto least = std::ranges::find_if(study.rows, [&](const BlocksStudyRow& row) {
        return is_first(row) && row.chosen.value >= last->random.p50.value;
    });
    if (least == study.rows.end() || least->pose_count >= last->pose_count) return "";
    return fmt::format("{} chosen ones tell as much as half of the random subsets of {}",
                       least->pose_count, last->pose_count);
}

std::string describe_own(const BlocksStudy& study) {
    std::string text;
    for (const BlocksStudyRow& row : study.rows) {
        for (const auto& [number, found] : row.own) {
            text += fmt::format("{}{}: {} % by {}", text.empty() ? "" : "; ",
                                detail::escape_controls(study.subsets[number].name),
                                efficiency_text(found.efficiency), criterion_name(row.criterion));
        }
    }
    return text;
}

}  // namespace

std::vector<Answer> answer(const BlocksStudy& study) {
    if (study.rows.empty()) return {};
    const auto last = std::find_if(
        study.rows.rbegin(), study.rows.rend(),
        [&](const BlocksStudyRow& row) { return row.criterion == study.criteria.front(); });
    std::vector<Answer> answers{{"value", "How much they tell", sum_up(study, *last)}};
    const auto add = [&](const char* key, const char* question, const std::string& text) {
        if (!text.empty()) answers.push_back({key, question, text});
    };
    add("saving", "What choosing saves", describe_saving(study));
    add("own", "Own subsets", describe_own(study));
    return answers;
}

std::string format(const BlocksStudy& study, int digits) {
    std::string text = format_table(chosen_table(study, digits));
    const detail::Table own = own_table(study, digits);
    if (!own.rows.empty()) text += format_section("Own subsets", own);
    if (!study.rows.empty() && study.rows.front().random.subsets > 0) {
        text += fmt::format(
            "\nEfficiency: share of the best possible information, against the proven bound. "
            "Random: {}\nfor each number of poses, the same ones for all criteria.\n",
            detail::count_of(study.rows.front().random.subsets, "subset"));
    }
    return text;
}

std::string describe_early_end(const BlocksStudy& study) {
    if (study.ending == Ending::Converged) return "";
    if (study.rows.empty()) {
        throw InputError("stopped before any pose count was finished; must have longer");
    }
    return "stopped early; the pose counts that are finished are shown";
}

void write_study_csv(const BlocksStudy& study, const WriteText& write) {
    std::string text = "poses,criterion,chosen_by,value,bound,efficiency,candidates\n";
    for (const BlocksStudyRow& row : study.rows) {
        const auto add = [&](const std::string& by, const SubsetValue& found,
                             const std::vector<Index>& poses) {
            const auto number = [](double value) {
                return std::isfinite(value) ? fmt::format("{}", value) : "";
            };
            text += fmt::format("{},{},{},{},{},{},{}\n", row.pose_count,
                                criterion_name(row.criterion), quote_field(by), number(found.value),
                                number(row.chosen.bound), number(found.efficiency), join(poses));
        };
        add("best", {row.chosen.value, row.chosen.efficiency}, row.chosen.poses);
        if (row.random.subsets > 0) {
            add("random 5 %", row.random.p5, {});
            add("random 50 %", row.random.p50, {});
            add("random 95 %", row.random.p95, {});
        }
        for (const auto& [number, found] : row.own) {
            add(study.subsets[number].name, found, study.subsets[number].poses);
        }
    }
    write(text);
}

}  // namespace posewise
