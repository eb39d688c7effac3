#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace posewise::cli {

/// --plot; `what` it draws.
void add_plot_option(CLI::App& command, std::string& path, const std::string& what);

/// The script that draws into an image of that name.
using MakeScript = std::function<std::string(const std::string& image_path)>;

/// Draws an image with gnuplot, whole or not at all. Where that fails an InputError says so, and
/// the script is left beside where the image would be.
void draw_plot(const std::string& image_path, const MakeScript& make_script);

}  // namespace posewise::cli
