#include <fmt/format.h>

#include "core/format.hpp"
#include "core/text.hpp"
#include "posewise/report/reports.hpp"
#include "sentences.hpp"
#include "table.hpp"

namespace posewise {
namespace {

detail::Table index_table(const Rating& rating, bool has_prior, int digits) {
    detail::Table table{
        {"index", has_prior ? "whitened, scaled, with the prior" : "whitened, scaled",
         "plain, mm and mrad"},
        {}};
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        table.rows.push_back({std::string(criterion_name(all_criteria[i])),
                              detail::format_short(rating.scaled.values[i], digits),
                              detail::format_short(rating.plain.values[i], digits)});
    }
    table.rows.push_back({"condition", detail::format_short(rating.scaled.condition, digits),
                          detail::format_short(rating.plain.condition, digits)});
    return table;
}

/// The direction in words: errors in mm and mrad, and how well their sum is known.
std::string describe_direction(const Campaign& campaign, const WeakDirection& direction) {
    const auto names = parameter_names(campaign);
    const auto units = parameter_units(campaign);
    const VectorXd scale = parameter_scale(campaign);
    std::string terms;
    for (const ParameterTerm& term : direction.terms) {
        const auto k = static_cast<std::size_t>(term.parameter);
        terms += terms.empty() ? "" : ", ";
        terms += detail::format_error(term.coefficient * scale[term.parameter], *units[k]) + ' ' +
                 names[k];
    }
    if (!(direction.singular_value > 0)) return "not seen at all: " + terms;
    return fmt::format("{} % of the expected size: {}",
                       detail::format_short(100 / direction.singular_value, 3), terms);
}

}  // namespace

std::string format(const Rating& rating, const Campaign& campaign, int digits) {
    std::string text =
        fmt::format("{}, {}\n{}", detail::count_of(rating.configurations, "configuration"),
                    detail::count_of(rating.parameters, "parameter"),
                    detail::describe_scaling(campaign, rating.repeats));
    text += format_section("Indices (-inf, condition inf: the parameters are not identifiable)",
                           index_table(rating, campaign.spread.is_prior, digits));
    text += fmt::format(
        "\nwhitened, scaled: rows divided by the noise, columns times the expected errors{}: what "
        "posewise selects by\nplain: of the Jacobian in mm and mrad, without noise, scale or "
        "prior, "
        "as papers print them\nLarger is better, but of the condition number; G and V predict "
        "these configurations' own readings.\n",
        campaign.spread.is_prior ? ", and what the prior tells" : "");
    text += "\nWeakest directions, known to\n\n";
    for (const WeakDirection& direction : rating.weakest) {
        text += "  " + describe_direction(campaign, direction) + '\n';
    }
    return text;
}

std::string format(const Rating& rating, const std::vector<std::string>& names, bool has_prior,
                   int digits) {
    detail::Table table{{"index", "value"}, {}};
    if (has_prior) table.header = {"index", "with the prior", "without"};
    const auto add = [&](std::string_view name, double with, double without) {
        std::vector<std::string> row{std::string(name), detail::format_short(with, digits)};
        if (has_prior) row.push_back(detail::format_short(without, digits));
        table.rows.push_back(std::move(row));
    };
    for (std::size_t i = 0; i < all_criteria.size(); ++i) {
        add(criterion_name(all_criteria[i]), rating.scaled.values[i], rating.plain.values[i]);
    }
    add("condition", rating.scaled.condition, rating.plain.condition);
    std::string text = format_section(
        fmt::format("Indices of {} (-inf, condition inf: the parameters are not identifiable)",
                    detail::count_of(rating.configurations, "pose")),
        table);
    text +=
        "\nLarger is better, but of the condition number; G and V predict all candidates.\n"
        "\nWeakest directions: standard deviation, along\n\n";
    for (const WeakDirection& direction : rating.weakest) {
        std::string terms;
        for (const ParameterTerm& term : direction.terms) {
            terms += fmt::format("{}{} {}", terms.empty() ? "" : ", ",
                                 detail::format_short(term.coefficient, 3),
                                 names[static_cast<std::size_t>(term.parameter)]);
        }
        text += fmt::format("  {}: {}\n",
                            direction.singular_value > 0
                                ? detail::format_short(1 / direction.singular_value, 3)
                                : "not seen at all",
                            terms);
    }
    return text;
}

}  // namespace posewise
