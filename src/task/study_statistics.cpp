#include <algorithm>
#include <cmath>
#include <limits>

#include "../core/statistics.hpp"
#include "posewise/task/study.hpp"
#include "study_cases.hpp"

namespace posewise {

Advantage detail::geometric_mean(const std::vector<double>& logarithms) {
    const Eigen::Map<const VectorXd> values(logarithms.data(),
                                            static_cast<Index>(logarithms.size()));
    const double mean = values.mean();
    const double freedom = static_cast<double>(values.size()) - 1;
    if (freedom < 1) return Advantage{std::exp(mean), std::exp(mean), std::exp(mean)};
    const double deviation = std::sqrt((values.array() - mean).square().sum() / freedom /
                                       static_cast<double>(values.size()));
    const double width = student_quantile(0.975, freedom) * deviation;
    return Advantage{std::exp(mean), std::exp(mean - width), std::exp(mean + width)};
}

std::vector<StudyCase> planned_cases(const StudyRow& row, std::size_t criterion,
                                     std::size_t criterion_count) {
    const auto each = static_cast<std::ptrdiff_t>(row.optimal.size() / criterion_count);
    const auto begin = row.optimal.begin() + each * static_cast<std::ptrdiff_t>(criterion);
    return {begin, begin + each};
}

std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion) {
    return planned_advantage(study, row, criterion, row);
}

std::optional<Advantage> planned_advantage(const Study& study, const StudyRow& row,
                                           std::size_t criterion, const StudyRow& other_row) {
    if (study.splits == 0) return std::nullopt;
    std::vector<std::vector<StudyCase>> random(static_cast<std::size_t>(study.splits));
    for (const StudyCase& other : other_row.random) {
        random[static_cast<std::size_t>(other.split)].push_back(other);
    }
    std::vector<double> logarithms;
    for (const StudyCase& planned : planned_cases(row, criterion, study.criteria.size())) {
        const auto median = held_out_quantile(random[static_cast<std::size_t>(planned.split)], 0.5);
        const auto found = held_out_quantile({planned}, 0.5);
        if (!median || !found) return std::nullopt;
        logarithms.push_back(std::log(*found / *median));
    }
    return detail::geometric_mean(logarithms);
}

Verdict verdict_of(const Advantage& advantage) {
    if (advantage.upper < 1) return Verdict::Better;
    return advantage.lower > 1 ? Verdict::Loses : Verdict::WithinChance;
}

std::string_view verdict_name(Verdict verdict) {
    switch (verdict) {
        case Verdict::Better:
            return "better";
        case Verdict::Loses:
            return "loses";
        case Verdict::WithinChance:
            break;
    }
    return "within chance";
}

std::optional<double> held_out_quantile(const std::vector<StudyCase>& cases, double p) {
    constexpr double worst = std::numeric_limits<double>::infinity();
    std::vector<double> errors;
    for (const StudyCase& study_case : cases) {
        if (!study_case.identified) {
            errors.push_back(worst);
        } else if (study_case.held_out.point_count > 0) {
            errors.push_back(study_case.held_out.distance_rms);
        }
    }
    if (errors.empty()) return std::nullopt;
    const double error =
        quantile(Eigen::Map<const VectorXd>(errors.data(), static_cast<Index>(errors.size())),
                 std::clamp(p, 0.0, 1.0), detail::QuantileRule::Linear);
    if (error == worst) return std::nullopt;
    return error;
}

std::optional<double> median_expected(const std::vector<StudyCase>& cases) {
    std::vector<double> expected;
    for (const StudyCase& study_case : cases) {
        if (study_case.identified) expected.push_back(study_case.expected);
    }
    if (expected.empty()) return std::nullopt;
    const Eigen::Map<const VectorXd> values(expected.data(), static_cast<Index>(expected.size()));
    return quantile(values, 0.5, detail::QuantileRule::Linear);
}

Index count_unidentified(const std::vector<StudyCase>& cases) {
    return std::count_if(cases.begin(), cases.end(),
                         [](const StudyCase& study_case) { return !study_case.identified; });
}

}  // namespace posewise
