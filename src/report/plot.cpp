#include "posewise/report/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <functional>

#include "posewise/core/errors.hpp"
#include "posewise/report/units.hpp"

namespace posewise {
namespace {

/// A gnuplot single-quoted string: nothing in it is expanded; a quote is written twice.
std::string quote(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) {
        if (c == '\'') quoted += '\'';
        quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return quoted + "'";
}

bool ends_with_any_case(const std::string& path, const std::string& ending) {
    return path.size() > ending.size() &&
           std::equal(ending.rbegin(), ending.rend(), path.rbegin(), [](char a, char b) {
               return a == std::tolower(static_cast<unsigned char>(b));
           });
}

std::string terminal(const std::string& image_path) {
    return ends_with_any_case(image_path, ".svg")
               ? "svg size 900,560 dynamic rounded font 'Helvetica,15' background '#ffffff'"
               : "pngcairo size 1350,840 rounded font 'Helvetica,18' linewidth 1.4";
}

/// Lines "count value..." of the p-quantiles, of the rows that have them.
std::string data_lines(const std::vector<StudyRow>& rows,
                       const std::function<std::vector<StudyCase>(const StudyRow&)>& cases,
                       const std::vector<double>& quantiles) {
    std::string lines;
    for (const StudyRow& row : rows) {
        const auto of_row = cases(row);
        if (!held_out_quantile(of_row, 0.5)) continue;
        lines += std::to_string(row.pose_count);
        for (const double p : quantiles) {
            lines += ' ' + format_short(mm_per_m * *held_out_quantile(of_row, p), 9);
        }
        lines += '\n';
    }
    return lines;
}

/// Named data and the plot clauses that draw them.
struct Drawing {
    std::string data;
    std::string clauses;

    void add(const std::string& name, const std::string& lines, const std::string& clause) {
        data += fmt::format("${} << EOD\n{}EOD\n", name, lines);
        clauses += clauses.empty() ? "plot " : ", \\\n     ";
        clauses += fmt::format(fmt::runtime(clause), '$' + name);
    }
};

Drawing draw(const std::vector<Criterion>& criteria, const std::vector<StudyRow>& rows) {
    constexpr std::array colors{"#0b6fa4", "#c8401f", "#2f8f4e", "#8a4fb0", "#c98a00",
                                "#d0418f", "#5b6b00", "#006d77", "#7f3b08", "#333333"};
    Drawing drawing;
    const auto random =
        data_lines(rows, [](const StudyRow& row) { return row.random; }, {0.1, 0.5, 0.9});
    if (!random.empty()) {
        drawing.add(
            "random", random,
            "{0} using 1:2:4 with filledcurves fc rgb '#c9cfd6' title 'random, 10-90 %', "
            "{0} using 1:3 with lines lw 2 dt (8,5) lc rgb '#5f6b77' title 'random, median'");
    }
    for (std::size_t i = 0; i < criteria.size(); ++i) {
        const auto lines = data_lines(
            rows, [i](const StudyRow& row) { return std::vector{row.optimal[i]}; }, {0.5});
        if (lines.empty()) continue;
        std::string name(criterion_name(criteria[i]));
        std::transform(name.begin(), name.end(), name.begin(),
                       [](char c) { return std::toupper(c); });
        drawing.add(fmt::format("optimal{}", i), lines,
                    fmt::format("{{0}} using 1:2 with linespoints lw 2.5 pt 7 ps 0.6 lc rgb '{}' "
                                "title 'optimal, {}'",
                                colors[i % colors.size()], name));
    }
    return drawing;
}

}  // namespace

void check_image_path(const std::string& path) {
    if (std::any_of(path.begin(), path.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
        throw InputError("the plot's path holds a control character");
    }
    if (!ends_with_any_case(path, ".svg") && !ends_with_any_case(path, ".png")) {
        throw InputError("the plot is '" + path + "', its ending must be .svg or .png");
    }
}

std::string study_plot_script(const std::vector<Criterion>& criteria,
                              const std::vector<StudyRow>& rows, const std::string& title,
                              const std::string& image_path) {
    check_image_path(image_path);
    const Drawing drawing = draw(criteria, rows);
    if (drawing.clauses.empty()) {
        throw InputError(
            "the study has no held-out error to plot: no subset that left a "
            "configuration out identified the model");
    }
    return fmt::format(
        "set terminal {}\nset output {}\nset title {} noenhanced\n"
        "set xlabel 'poses used for calibration'\n"
        "set ylabel 'held-out distance RMS (mm)'\n"
        "set logscale y\nset format y '%g'\nset xtics out nomirror\nset ytics out nomirror\n"
        "set border 3 lc rgb '#5f6b77'\nset grid ytics mytics lc rgb '#dfe3e8', lc rgb '#eff1f3'\n"
        "set mytics 10\nset offsets graph 0.02, graph 0.02\nset key top right reverse Left\n"
        "{}{}\nset output\n",
        terminal(image_path), quote(image_path), quote(title), drawing.data, drawing.clauses);
}

}  // namespace posewise
