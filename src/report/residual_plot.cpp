#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "gnuplot.hpp"
#include "plot.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"

namespace posewise::detail {
namespace {

/// The numbers of a reading that are drawn.
struct DrawnRows {
    Index begin = 0;
    Index count = 0;

    VectorXd of(const VectorXd& residual) const {
        return mm_per_m * residual.segment(begin, count);
    }
};

/// Lines "length share" of the lengths of residuals, the least first; empty if none has one.
template <class Find>
std::string distribution(const std::vector<ReadingResidual>& readings, const DrawnRows& rows,
                         Find&& find) {
    std::vector<double> distances;
    for (const ReadingResidual& reading : readings) {
        const std::optional<VectorXd> residual = find(reading);
        if (residual) distances.push_back(rows.of(*residual).norm());
    }
    std::sort(distances.begin(), distances.end());
    std::string lines;
    const auto count = static_cast<double>(distances.size());
    for (std::size_t k = 0; k < distances.size(); ++k) {
        lines += fmt::format("{:.6g} {:.6g}\n", distances[k],
                             100 * (static_cast<double>(k) + 0.5) / count);
    }
    return lines;
}

/// Lines "configuration x y z ...", targets of a configuration beside each other.
std::string in_order(const std::vector<ReadingResidual>& readings, const DrawnRows& rows) {
    std::string lines;
    for (std::size_t k = 0; k < readings.size();) {
        std::size_t end = k;
        const Index configuration = readings[k].configuration;
        while (end < readings.size() && readings[end].configuration == configuration) ++end;
        const auto width = static_cast<double>(end - k);
        for (std::size_t i = k; i < end; ++i) {
            const double place = static_cast<double>(i - k) / width - 0.5 + 0.5 / width;
            lines += fmt::format("{:.4f}", static_cast<double>(configuration + 1) + 0.8 * place);
            for (const double value : rows.of(readings[i].calibrated)) {
                lines += fmt::format(" {:.6g}", value);
            }
            lines += '\n';
        }
        k = end;
    }
    return lines;
}

std::string residual_panel(const std::vector<ReadingResidual>& readings, const DrawnRows& rows,
                           const std::vector<std::string>& axes) {
    constexpr std::array colors{"#0b6fa4", "#c8401f", "#2f8f4e"};
    std::string clauses = "0 lc rgb '#5f6b77' notitle";
    for (Index k = 0; k < rows.count; ++k) {
        const auto axis = static_cast<std::size_t>(rows.begin + k);
        // A legend that can be seen, of points that do not hide each other.
        clauses += fmt::format(
            ", $order using 1:{0} with points pt 7 ps 0.35 lc rgb '{1}' notitle, "
            "NaN with points pt 7 ps 0.9 lc rgb '{1}' title {2}",
            k + 2, colors[static_cast<std::size_t>(k) % colors.size()], gnuplot_text(axes[axis]));
    }
    return fmt::format("$order << EOD\n{}EOD\nset xrange [0.3:{}.7]\nplot {}\nset xrange [*:*]\n",
                       in_order(readings, rows), readings.back().configuration + 1, clauses);
}

std::string distribution_panel(const std::vector<ReadingResidual>& readings,
                               const DrawnRows& rows) {
    struct Curve {
        const char* name;
        const char* title;
        const char* style;
        std::string lines;
    };
    using Part = std::optional<VectorXd>;
    const std::array<Curve, 3> curves{
        {{"nominal", "nominal", "lw 2 dt (8,5) lc rgb '#5f6b77'",
          distribution(readings, rows, [](const auto& one) { return Part(one.nominal); })},
         {"calibrated", "calibrated", "lw 2.5 lc rgb '#0b6fa4'",
          distribution(readings, rows, [](const auto& one) { return Part(one.calibrated); })},
         {"held_out", "held out", "lw 2.5 lc rgb '#c8401f'",
          distribution(readings, rows, [](const auto& one) { return one.held_out; })}}};
    std::string data, clauses;
    for (const Curve& curve : curves) {
        if (curve.lines.empty()) continue;
        data += fmt::format("${} << EOD\n{}EOD\n", curve.name, curve.lines);
        clauses += fmt::format("{}${} using 1:2 with lines {} title '{}'",
                               clauses.empty() ? "" : ", ", curve.name, curve.style, curve.title);
    }
    return data + "plot " + clauses + '\n';
}

}  // namespace

std::string residual_plot_script(const Campaign& campaign,
                                 const std::vector<ReadingResidual>& all_readings,
                                 const std::string& image_path) {
    check_image_path(image_path);
    const Sensor& sensor = *campaign.sensor;
    const Index lengths = sensor.lengths_per_target();
    const DrawnRows rows{0, lengths > 0 ? lengths : sensor.rows_per_target()};
    std::vector<ReadingResidual> readings = all_readings;
    if (sensor.is_combined()) {  // those that all have the same axes
        std::erase_if(readings, [&](const ReadingResidual& one) {
            return one.calibrated.size() < rows.count ||
                   sensor.is_angle(sensor.first_row(one.target)) == (lengths > 0);
        });
    }
    if (readings.empty()) throw InputError("there are no readings to draw");
    const char* const unit = lengths > 0 ? "mm" : "mrad";
    return gnuplot_output(image_path, 1200, 560) +
           fmt::format(
               "set multiplot layout 1,2 title {} noenhanced margins 0.075,0.98,0.24,0.86 "
               "spacing 0.09,0\n"
               "set border 3 lc rgb '#5f6b77'\nset grid lc rgb '#e6eaee'\nset xtics out nomirror\n"
               "set ytics out nomirror\nset key below samplen 1\n"
               "set title 'left after calibration, in the order measured'\n"
               "set xlabel 'configuration'\nset ylabel 'residual ({})'\n",
               gnuplot_text(campaign.name), unit) +
           residual_panel(readings, rows, residual_axes(campaign)) +
           fmt::format(
               "set title 'how many readings are off by less'\nset key samplen 4\nset xlabel "
               "'residual ({})'\n"
               "set ylabel 'share of readings (%)'\nset logscale x\nset format x '%g'\n"
               "set yrange [0:100]\n",
               unit) +
           distribution_panel(readings, rows) + "unset multiplot\nset output\n";
}

}  // namespace posewise::detail
