#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include "core/names.hpp"
#include "core/statistics.hpp"
#include "posewise/task/study.hpp"
#include "study_cases.hpp"

namespace posewise {

std::optional<Advantage> detail::geometric_mean(const VisitNumbers& logarithms) {
    double count = 0, sum = 0, squares = 0;
    logarithms([&](double x) {
        ++count;
        sum += x;
    });
    const double mean = sum / count;
    if (std::isnan(mean)) return std::nullopt;
    const double freedom = count - 1;
    if (freedom < 1) return Advantage{std::exp(mean), std::exp(mean), std::exp(mean)};
    logarithms([&](double x) { squares += (x - mean) * (x - mean); });
    const double width = student_quantile(0.975, freedom) * std::sqrt(squares / freedom / count);
    return Advantage{std::exp(mean), std::exp(mean - width), std::exp(mean + width)};
}

StudyCases::StudyCases(std::vector<StudyCase> cases) : size_(cases.size()) {
    const auto shared = std::make_shared<const std::vector<StudyCase>>(std::move(cases));
    read_ = [shared](std::size_t number) { return (*shared)[number]; };
}

Index split_count(const StudyRow& row, std::size_t criterion_count) {
    return static_cast<Index>(row.optimal.size() / criterion_count);
}

void keep_common(std::vector<Study>& studies) {
    using Place = std::pair<Index, Index>;  // pose count and split
    std::map<Place, std::size_t> having;
    for (const Study& study : studies) {
        if (study.is_simulated) return;  // robots are drawn one by one, all pose counts of each
        std::set<Place> places;
        for (const StudyRow& row : study.rows) {
            for (const StudyCase& one : row.optimal) places.insert({row.pose_count, one.split});
        }
        for (const Place& place : places) ++having[place];
    }
    for (Study& study : studies) {
        for (StudyRow& row : study.rows) {
            for (StudyCases* const cases : {&row.optimal, &row.random}) {
                std::vector<StudyCase> common;
                for (const StudyCase& one : *cases) {
                    if (having[{row.pose_count, one.split}] == studies.size())
                        common.push_back(one);
                }
                *cases = StudyCases(std::move(common));
            }
        }
        std::erase_if(study.rows, [](const StudyRow& row) { return row.optimal.empty(); });
    }
}

StudyCases planned_cases(const StudyRow& row, std::size_t criterion, std::size_t criterion_count) {
    const std::size_t each = row.optimal.size() / criterion_count;
    return {each, [all = row.optimal, first = criterion * each](std::size_t number) {
                return all[first + number];
            }};
}

std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion) {
    return planned_advantage(study, row, criterion, row);
}

std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion, const StudyRow& other_row) {
    if (study.splits == 0) return std::nullopt;
    const StudyCases planned = planned_cases(row, criterion, study.criteria.size());
    // Each split has as many planned subsets, and every so many-th random one.
    const std::size_t others = other_row.optimal.size() / study.criteria.size();
    Index left_out = 0;
    auto advantage = detail::geometric_mean([&](const std::function<void(double)>& visitor) {
        left_out = 0;
        for (std::size_t split = 0; split < std::min(planned.size(), others); ++split) {
            std::vector<StudyCase> random;
            for (std::size_t i = split; i < other_row.random.size(); i += others) {
                random.push_back(other_row.random[i]);
            }
            const auto median = held_out_quantile(std::move(random), 0.5);
            const auto found = held_out_quantile({planned[split]}, 0.5);
            if (found && !median) {
                ++left_out;
                continue;
            }
            visitor(found ? std::log(*found / *median) : std::numeric_limits<double>::quiet_NaN());
        }
    });
    if (advantage) advantage->left_out = left_out;
    return advantage;
}

Verdict verdict_of(const Advantage& advantage) {
    if (advantage.is_of_one_split()) return Verdict::WithinChance;
    if (advantage.upper < 1) return Verdict::Better;
    return advantage.lower > 1 ? Verdict::Loses : Verdict::WithinChance;
}

std::string_view verdict_name(Verdict verdict) {
    static constexpr detail::Names<Verdict, 3> names{{{Verdict::Better, "better"},
                                                      {Verdict::Loses, "loses"},
                                                      {Verdict::WithinChance, "within chance"}}};
    return detail::name_of(names, verdict);
}

std::optional<double> held_out_quantile(const StudyCases& cases, double p) {
    constexpr double worst = std::numeric_limits<double>::infinity();
    const auto error = detail::quantile_of_many(
        [&](const std::function<void(double)>& visitor) {
            for (const StudyCase& study_case : cases) {
                if (!study_case.identified) {
                    visitor(worst);
                } else if (study_case.held_out.point_count > 0) {
                    visitor(study_case.held_out.rms);
                }
            }
        },
        std::clamp(p, 0.0, 1.0));
    return error == worst ? std::nullopt : error;
}

std::optional<double> median_expected(const StudyCases& cases) {
    return detail::quantile_of_many(
        [&](const std::function<void(double)>& visitor) {
            for (const StudyCase& study_case : cases) {
                if (study_case.identified) visitor(study_case.expected);
            }
        },
        0.5);
}

Index count_unidentified(const StudyCases& cases) {
    return std::count_if(cases.begin(), cases.end(),
                         [](const StudyCase& study_case) { return !study_case.identified; });
}

}  // namespace posewise
