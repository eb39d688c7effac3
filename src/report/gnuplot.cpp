#include "gnuplot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "plot.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

bool ends_with_any_case(const std::string& path, const std::string& ending) {
    return path.size() > ending.size() &&
           std::equal(ending.rbegin(), ending.rend(), path.rbegin(), [](char a, char b) {
               return a == std::tolower(static_cast<unsigned char>(b));
           });
}

}  // namespace

std::string gnuplot_text(const std::string& text) {
    std::string quoted = "'";
    for (const char c : text) {
        if (c == '\'') quoted += '\'';
        quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
    }
    return quoted + "'";
}

std::string gnuplot_path(const std::string& path) {
    return gnuplot_text(path.starts_with('/') ? path : "./" + path);
}

bool is_svg_path(const std::string& path) { return ends_with_any_case(path, ".svg"); }

std::string gnuplot_output(const std::string& image_path, double width, double height) {
    const bool is_svg = is_svg_path(image_path);
    const double scale = is_svg ? 1 : 1.5;
    return fmt::format("set terminal {} size {:.0f},{:.0f} {}\nset output {}\n",
                       is_svg ? "svg" : "pngcairo", scale * width, scale * height,
                       is_svg ? "dynamic rounded font 'Helvetica,15' background '#ffffff'"
                              : "rounded font 'Helvetica,18' linewidth 1.4",
                       gnuplot_path(image_path));
}

void check_image_path(const std::string& path) {
    if (std::any_of(path.begin(), path.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 0x20; })) {
        throw InputError("the plot's path holds a control character");
    }
    if (!is_svg_path(path) && !ends_with_any_case(path, ".png")) {
        throw InputError("the plot is '" + path + "', its ending must be .svg or .png");
    }
}

}  // namespace posewise::detail
