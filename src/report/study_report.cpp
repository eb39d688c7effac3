#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/report/reports.hpp"
#include "study_table.hpp"

namespace posewise {
namespace {

constexpr std::string_view unknown = "not known";

/// As a CSV field: in quotes if it needs them.
std::string quote(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + '"';
}

std::string csv_line(const StudyRow& row, const StudyCase& study_case, std::string_view chosen_by,
                     std::size_t subset, const std::vector<std::string>& ids) {
    std::string found = ",,,";
    if (study_case.identified && study_case.held_out.point_count > 0) {
        const HeldOut& held_out = study_case.held_out;
        found.clear();
        for (const double error : {held_out.rms, held_out.max, held_out.p95, study_case.expected}) {
            found += (found.empty() ? "" : ",") + detail::format_short(1e3 * error, 9);
        }
    }
    std::string poses;
    for (const Index pose : study_case.poses) {
        poses += (poses.empty() ? "" : " ") + ids[static_cast<std::size_t>(pose)];
    }
    return fmt::format("{},{},{},{},{},{}\n", row.pose_count, chosen_by, subset,
                       study_case.identified ? "yes" : "no", found, quote(poses));
}

/// "12 robots"; of studies with unlike numbers "12, 7 robots".
std::string count_splits(std::span<const Study> studies, const char* what) {
    std::set<Index> counts;
    std::string list;
    for (const Study& study : studies) {
        counts.insert(study.splits);
        list += (list.empty() ? "" : ", ") + std::to_string(study.splits);
    }
    return counts.size() == 1 ? detail::count_of(*counts.begin(), what)
                              : fmt::format("{} {}s", list, what);
}

/// On what all were judged.
std::string describe_judgement(std::span<const Study> studies) {
    const Study& study = studies.front();
    if (study.is_simulated) {
        return fmt::format(
            "\nJudged at {} of the workspace, model error included; {} drawn, the same for planned "
            "and random.\nPlanned and random: medians; their ratio: the geometric mean over the "
            "robots.\n",
            detail::count_of(study.test_count, "configuration"), count_splits(studies, "robot"));
    }
    return fmt::format(
        "\nJudged on {} held out, the same ones for all subsets of a split; {}.\nPlanned and "
        "random: medians; their ratio: the geometric mean over the splits.\n",
        detail::count_of(study.test_count, "configuration"), count_splits(studies, "split"));
}

/// Whether to plan was worth it, a line for each criterion: "v, planned against random: better at
/// 8, 12; within chance at 20".
std::string describe_verdicts(const Study& study) {
    std::string text;
    for (std::size_t c = 0; c < study.criteria.size(); ++c) {
        std::map<std::string_view, std::string> counts;  // of poses
        std::string left_out;
        for (const StudyRow& row : study.rows) {
            const auto advantage = planned_advantage(study, row, c);
            std::string& list = counts[advantage ? verdict_name(verdict_of(*advantage)) : unknown];
            list += (list.empty() ? "" : ", ") + std::to_string(row.pose_count);
            if (!advantage || advantage->left_out == 0) continue;
            left_out +=
                fmt::format("{}{} of {} at {}", left_out.empty() ? "" : ", ", advantage->left_out,
                            split_count(row, study.criteria.size()), row.pose_count);
        }
        std::string line;
        for (const std::string_view verdict :
             {verdict_name(Verdict::Better), verdict_name(Verdict::WithinChance),
              verdict_name(Verdict::Loses), unknown}) {
            if (!counts.contains(verdict)) continue;
            line += fmt::format("{}{} at {}", line.empty() ? "" : "; ", verdict, counts[verdict]);
        }
        if (!left_out.empty()) {
            line += fmt::format("; {} left out, whose random subsets do not identify the model: {}",
                                study.is_simulated ? "robots" : "splits", left_out);
        }
        text +=
            fmt::format("{}{}{}, planned against random: {}\n", study.model,
                        study.model.empty() ? "" : ", ", criterion_name(study.criteria[c]), line);
    }
    return text;
}

bool compares_with_random(const Study& study) {
    return study.splits > 0 && !study.rows.empty() && !study.rows.front().random.empty();
}

/// A line for each case, each begins with `prefix`.
void write_csv_lines(const Study& study, const std::string& prefix, const WriteText& write) {
    constexpr std::size_t many = std::size_t{1} << 16;
    std::string lines;
    for (const StudyRow& row : study.rows) {
        const auto write_cases = [&](const StudyCases& cases, std::string_view chosen_by) {
            for (std::size_t i = 0; i < cases.size(); ++i) {
                lines += prefix + csv_line(row, cases[i], chosen_by, i, study.ids);
                if (lines.size() < many) continue;
                write(lines);
                lines.clear();
            }
        };
        for (std::size_t c = 0; c < study.criteria.size(); ++c) {
            write_cases(planned_cases(row, c, study.criteria.size()),
                        criterion_name(study.criteria[c]));
        }
        write_cases(row.random, "random");
    }
    write(lines);
}

std::string csv_header(const Study& study) {
    return fmt::format(
        "poses,chosen_by,subset,identified,held_out_rms_{0},held_out_max_{0},held_out_p95_{0},"
        "expected_rms_{0},configurations\n",
        study.units->error);
}

}  // namespace

std::string format(const Study& study) {
    if (study.ending == Ending::NotIdentifiable) return study.undetermined + '\n';
    std::string text = format_table(detail::study_table(study));
    if (!compares_with_random(study)) return text;
    return text + describe_judgement({&study, 1}) + describe_verdicts(study);
}

std::string format(const std::vector<Study>& studies) {
    for (const Study& study : studies) {
        if (study.ending != Ending::NotIdentifiable) continue;
        return study.model + ": " + study.undetermined + '\n';
    }
    std::string text = format_table(detail::models_table(studies));
    if (!compares_with_random(studies.front())) return text;
    text += describe_judgement(studies);
    for (const Study& study : studies) text += describe_verdicts(study);
    return text;
}

std::string describe_early_end(const Study& study) {
    if (study.ending != Ending::Interrupted && study.ending != Ending::TimeLimit) return "";
    if (study.rows.empty()) {
        throw InputError("stopped before any split was finished; must have longer");
    }
    if (study.splits == 0 || study.is_simulated) {
        return "stopped early; what is finished is shown";
    }
    return fmt::format(
        "stopped early; the splits that are finished are shown, {} of {} with {} poses",
        split_count(study.rows.back(), study.criteria.size()), study.splits,
        study.rows.back().pose_count);
}

std::string detail::describe_least_judged(const Study& study) {
    if (study.is_simulated || study.rows.empty()) return "";
    const Index most = study.rows.back().pose_count;
    const Index judged =
        study.splits > 0 ? study.test_count : static_cast<Index>(study.ids.size()) - most;
    if (judged <= 0 || judged >= least_judged) return "";  // none: no error is stated either
    const std::string count = count_of(judged, "pose");
    return study.splits > 0
               ? fmt::format("each split judges on {} only, which says little of others", count)
               : fmt::format(
                     "the accuracy with {} is judged on {} only, what they leave, which says "
                     "little of others",
                     count_of(most, "pose"), count);
}

std::string describe_few_judged(const Study& study) {
    const std::string words = detail::describe_least_judged(study);
    if (words.empty()) return "";
    return fmt::format("{}; {} must be {}, or more poses measured", words,
                       study.splits > 0 ? "`holdout`" : "the largest `pose_count`",
                       study.splits > 0 ? "larger" : "smaller");
}

void write_study_csv(const Study& study, const WriteText& write) {
    write(csv_header(study));
    write_csv_lines(study, "", write);
}

void write_study_csv(const std::vector<Study>& studies, const WriteText& write) {
    write(studies.front().is_simulated ? "variation," : "model,");
    write(csv_header(studies.front()));
    for (const Study& study : studies) write_csv_lines(study, quote(study.model) + ',', write);
}

}  // namespace posewise
