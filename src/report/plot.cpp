#include "plot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/format.hpp"
#include "gnuplot.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"

namespace posewise::detail {
namespace {

/// In pixels of SVG.
double panels_width(std::size_t columns) { return 45 + 400 * static_cast<double>(columns); }
double panels_height(std::size_t rows) { return 220 + 300 * static_cast<double>(rows); }

/// Of so many panels beside and below each other, a legend below.
std::string study_output(const std::string& image_path, std::size_t columns, std::size_t rows) {
    const bool is_one = columns * rows == 1;
    return gnuplot_output(image_path, is_one ? 900 : 110 + 380 * static_cast<double>(columns),
                          is_one ? 600 : 130 + 280 * static_cast<double>(rows));
}

/// Range of the error axis, in the unit of errors.
struct ErrorAxis {
    double lower = std::numeric_limits<double>::infinity();
    double upper = 0;

    void include(const std::optional<double>& error) {
        if (!error) return;
        lower = std::min(lower, 1e3 * *error / 1.5);
        upper = std::max(upper, 1e3 * *error * 1.5);
    }
    bool is_empty() const { return !(upper > 0) || !(lower > 0); }
    /// Places for labels: 1, 2 and 5 of each decade.
    std::string format_ticks() const {
        std::string ticks;
        const int first = static_cast<int>(std::floor(std::log10(lower)));
        const int last = static_cast<int>(std::floor(std::log10(upper)));
        for (int decade = first; decade <= last; ++decade) {
            for (const int digit : {1, 2, 5}) {
                ticks += fmt::format("{}{}e{}", ticks.empty() ? "" : ", ", digit, decade);
            }
        }
        return ticks;
    }
};

constexpr std::array band_quantiles{0.1, 0.5, 0.9};

/// One count alone makes no range of its own.
std::string count_axis(const std::vector<StudyRow>& rows) {
    const auto by_count = [](const StudyRow& a, const StudyRow& b) {
        return a.pose_count < b.pose_count;
    };
    const auto [least, most] = std::minmax_element(rows.begin(), rows.end(), by_count);
    if (rows.empty() || least->pose_count < most->pose_count) return "";
    return fmt::format("set xrange [{}:{}]\n", least->pose_count - 1, least->pose_count + 1);
}

std::string format_plotted(const std::optional<double>& error, const std::string& if_absent) {
    return error ? format_short(1e3 * *error, 9) : if_absent;
}

ErrorAxis find_error_axis(const std::vector<Study>& studies) {
    ErrorAxis axis;
    for (const Study& study : studies) {
        const std::size_t criterion_count = study.criteria.size();
        for (const StudyRow& row : study.rows) {
            for (const double p : band_quantiles) axis.include(held_out_quantile(row.random, p));
            for (std::size_t c = 0; c < criterion_count; ++c) {
                axis.include(held_out_quantile(planned_cases(row, c, criterion_count), 0.5));
            }
        }
    }
    return axis;
}

/// Lines "count 10% 50% 90%" of the rows whose 10 % quantile is a number. A quantile that falls
/// among subsets that could not identify the model has none: the band then reaches the upper edge.
std::string band_lines(const std::vector<StudyRow>& rows, const ErrorAxis& axis) {
    std::string lines;
    for (const StudyRow& row : rows) {
        const auto error = [&](std::size_t i) {
            return held_out_quantile(row.random, band_quantiles[i]);
        };
        if (!error(0)) continue;
        lines += fmt::format("{} {} {} {}\n", row.pose_count, format_plotted(error(0), ""),
                             format_plotted(error(1), "NaN"),
                             format_plotted(error(2), format_short(axis.upper, 9)));
    }
    return lines;
}

/// Lines "count error" of one criterion, where it identified the model; of splits the median.
std::string criterion_lines(const std::vector<StudyRow>& rows, std::size_t criterion,
                            std::size_t criterion_count) {
    std::string lines;
    for (const StudyRow& row : rows) {
        const auto error = held_out_quantile(planned_cases(row, criterion, criterion_count), 0.5);
        if (error) lines += fmt::format("{} {}\n", row.pose_count, format_plotted(error, ""));
    }
    return lines;
}

/// Named data and the plot clauses that draw them.
struct Drawing {
    std::string data;
    std::string suffix{};  ///< of the names
    std::string clauses;

    /// Each of `styles` is one way that the data are drawn.
    void add(const std::string& name, const std::string& lines,
             const std::vector<std::string>& styles) {
        if (lines.empty()) return;
        data += fmt::format("${}{} << EOD\n{}EOD\n", name, suffix, lines);
        const std::string data_name = '$' + name + suffix + ' ';
        clauses += clauses.empty() ? "plot " : ", \\\n     ";
        clauses += data_name + fmt::format("{}", fmt::join(styles, ", " + data_name));
    }
};

/// The first study's random subsets are a band, those of others their median alone; `number` is the
/// study's.
void draw(const Study& study, std::size_t number, const ErrorAxis& axis, Drawing& drawing) {
    constexpr std::array colors{"#0b6fa4", "#c8401f", "#2f8f4e", "#8a4fb0", "#c98a00",
                                "#d0418f", "#5b6b00", "#006d77", "#7f3b08", "#333333"};
    const std::string of_model =
        study.model.empty() || !drawing.suffix.empty() ? "" : ", " + study.model;
    const std::size_t lines_before = number * study.criteria.size();
    const auto color = [&](std::size_t line) {
        return colors[(lines_before + line) % colors.size()];
    };
    std::vector<std::string> random{
        fmt::format("using 1:3 with lines lw 2 dt (8,5) lc rgb '{}' title {}",
                    number == 0 ? "#5f6b77" : color(0), gnuplot_text("random, median" + of_model))};
    if (number == 0) {
        const std::string title = "random, 10-90 % (open top: not identifiable)" + of_model;
        random.insert(random.begin(), "using 1:2:4 with filledcurves fc rgb '#c9cfd6' title " +
                                          gnuplot_text(title));
    }
    drawing.add(number == 0 ? "random" : fmt::format("random{}", number),
                band_lines(study.rows, axis), random);
    for (std::size_t i = 0; i < study.criteria.size(); ++i) {
        std::string name(criterion_name(study.criteria[i]));
        for (char& c : name) c = static_cast<char>(std::toupper(c));
        drawing.add(
            fmt::format("optimal{}", lines_before + i),
            criterion_lines(study.rows, i, study.criteria.size()),
            {fmt::format("using 1:2 with linespoints lw 2.5 pt 7 ps 0.6 lc rgb '{}' title {}",
                         color(i), gnuplot_text("optimal, " + name + of_model))});
    }
}

std::string axis_labels(const Study& study) {
    return fmt::format(
        "set xlabel 'poses used for calibration'\nset ylabel 'held-out {}RMS ({})'\n",
        study.units == &length_units ? "distance " : "", study.units->error);
}

std::string one_panel(const std::vector<Study>& studies, const ErrorAxis& axis) {
    Drawing drawing;
    for (std::size_t i = 0; i < studies.size(); ++i) draw(studies[i], i, axis, drawing);
    return fmt::format("set title {} noenhanced\n{}set key below\n{}{}\n",
                       gnuplot_text(studies.front().campaign), axis_labels(studies.front()),
                       drawing.data, drawing.clauses);
}

/// A panel a study, with the same axes and one legend.
std::string panels(const std::vector<Study>& studies, const ErrorAxis& axis, std::size_t columns,
                   std::size_t rows) {
    const auto part = [](double pixels, double all) { return pixels / all; };
    const double width = panels_width(columns);
    const double height = panels_height(rows);
    std::string script = fmt::format(
        "set multiplot layout {},{} title {} noenhanced margins {:.4f},{:.4f},{:.4f},{:.4f} "
        "spacing {:.4f},{:.4f}\n"
        "set key at screen 0.5,{:.4f} center bottom\n",
        rows, columns, gnuplot_text(studies.front().campaign), part(75, width), 1 - part(25, width),
        part(220, height), 1 - part(75, height), part(55, width), part(95, height),
        part(10, height));
    for (std::size_t i = 0; i < studies.size(); ++i) {
        Drawing drawing{"", fmt::format("_{}", i), ""};
        draw(studies[i], 0, axis, drawing);
        const bool is_left = i % columns == 0;
        const bool is_lowest = i + columns >= studies.size();
        script += fmt::format(
            "set title {} noenhanced\nset xlabel '{}'\nset ylabel '{}'\n{}{}\nunset key\n",
            gnuplot_text(studies[i].model), is_lowest ? "poses used for calibration" : "",
            is_left ? fmt::format("held-out RMS ({})", studies[i].units->error) : "", drawing.data,
            drawing.clauses);
    }
    return script + "unset multiplot\n";
}

}  // namespace

std::string study_plot_script(const std::vector<Study>& studies, const std::string& image_path) {
    check_image_path(image_path);
    const ErrorAxis axis = find_error_axis(studies);
    if (axis.is_empty()) {
        throw InputError(
            "the study has no held-out error to plot: no subset that left a "
            "configuration out identified the model");
    }
    // Many curves are read beside each other, not one on the other.
    constexpr std::size_t most_in_one = 2;
    const bool is_one = studies.size() <= most_in_one;
    const std::size_t columns =
        is_one ? 1 : static_cast<std::size_t>(std::ceil(std::sqrt(studies.size())));
    const std::size_t rows = is_one ? 1 : (studies.size() + columns - 1) / columns;
    const Study& first = studies.front();
    std::string script = fmt::format(
        "{}{}set logscale y\nset yrange [{}:{}]\nset format y '%g'\n"
        "set xtics out nomirror\nset ytics out nomirror ({})\n"
        "set border 3 lc rgb '#5f6b77'\nset grid ytics lc rgb '#dfe3e8'\n"
        "set offsets graph 0.02, graph 0.02\nset key reverse Left\n",
        study_output(image_path, columns, rows), count_axis(first.rows), format_short(axis.lower),
        format_short(axis.upper), axis.format_ticks());
    script += is_one ? one_panel(studies, axis) : panels(studies, axis, columns, rows);
    return script + "set output\n";
}

}  // namespace posewise::detail
