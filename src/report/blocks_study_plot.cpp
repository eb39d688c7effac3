#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "core/format.hpp"
#include "gnuplot.hpp"
#include "plot.hpp"

namespace posewise::detail {
namespace {

/// What of a row is drawn: its value, or its efficiency in percent.
using Draw = double (*)(const SubsetValue&);

double value_of(const SubsetValue& found) { return found.value; }
double percent_of(const SubsetValue& found) { return 100 * found.efficiency; }

std::string number(double value) { return std::isfinite(value) ? format_short(value, 9) : "NaN"; }

/// One panel: `bound` by the row, if it is drawn.
std::string panel(const BlocksStudy& study, Criterion criterion, const std::string& suffix,
                  Draw draw, bool has_bound) {
    std::string chosen, bound, band, own;
    for (const BlocksStudyRow& row : study.rows) {
        if (row.criterion != criterion) continue;
        const double best = draw({row.chosen.value, row.chosen.efficiency});
        chosen += fmt::format("{} {}\n", row.pose_count, number(best));
        bound += fmt::format("{} {}\n", row.pose_count, number(row.chosen.bound));
        if (row.random.subsets > 0) {
            band += fmt::format("{} {} {} {}\n", row.pose_count, number(draw(row.random.p5)),
                                number(draw(row.random.p50)), number(draw(row.random.p95)));
        }
        for (const auto& [subset, found] : row.own) {
            own += fmt::format("{} {}\n", row.pose_count, number(draw(found)));
        }
    }
    std::string script, clauses;
    const auto add = [&](const std::string& name, const std::string& lines,
                         const std::string& style) {
        if (lines.empty()) return;
        script += fmt::format("${}{} << EOD\n{}EOD\n", name, suffix, lines);
        clauses += fmt::format("{}${}{} {}", clauses.empty() ? "plot " : ", \\\n     ", name,
                               suffix, style);
    };
    add("random", band, "using 1:2:4 with filledcurves fc rgb '#c9cfd6' title 'random, 5-95 %'");
    if (!band.empty()) {
        clauses += ", \\\n     $random" + suffix +
                   " using 1:3 with lines lw 2 dt (8,5) lc rgb '#5f6b77' title 'random, median'";
    }
    if (has_bound) {
        add("bound", bound, "using 1:2 with lines lw 1.5 lc rgb '#c8401f' title 'proven bound'");
    }
    add("chosen", chosen,
        "using 1:2 with linespoints lw 2.5 pt 7 ps 0.6 lc rgb '#0b6fa4' title 'chosen'");
    add("own", own, "using 1:2 with points pt 9 ps 1.2 lc rgb '#2f8f4e' title 'own subsets'");
    return script + clauses + '\n';
}

}  // namespace

std::string study_plot_script(const BlocksStudy& study, const std::string& image_path) {
    check_image_path(image_path);
    const double height = 400 * static_cast<double>(study.criteria.size()) + 40;
    std::string script = fmt::format(
        "{}set xtics out nomirror\nset ytics out nomirror\nset border 3 lc rgb '#5f6b77'\n"
        "set grid ytics lc rgb '#dfe3e8'\nset format y '%g'\nset key below reverse Left\n"
        "set offsets graph 0.02, graph 0.02\nset multiplot layout {},2\nset xlabel 'poses' offset "
        "0,0.3\n",
        gnuplot_output(image_path, 1100, height), study.criteria.size());
    if (!study.rows.empty() && study.rows.front().pose_count == study.rows.back().pose_count) {
        const Index only = study.rows.front().pose_count;  // makes no range of its own
        script += fmt::format("set xrange [{}:{}]\n", only - 1, only + 1);
    }
    for (std::size_t c = 0; c < study.criteria.size(); ++c) {
        std::string name(criterion_name(study.criteria[c]));
        for (char& letter : name) letter = static_cast<char>(std::toupper(letter));
        script += fmt::format("set ylabel 'value of {}'\nset autoscale y\n", name);
        script += panel(study, study.criteria[c], fmt::format("_value{}", c), value_of, true);
        script += fmt::format("set ylabel 'efficiency by {} (%)'\nset yrange [0:105]\n", name);
        script += panel(study, study.criteria[c], fmt::format("_share{}", c), percent_of, false);
    }
    return script + "unset multiplot\nset output\n";
}

}  // namespace posewise::detail
