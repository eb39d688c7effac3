#pragma once

#include <string>

/// What goes into a script of gnuplot so that nothing in it is executed.
namespace posewise::detail {

/// A single-quoted string: nothing in it is expanded; a quote is written twice.
std::string gnuplot_text(const std::string& text);

/// The name of a file likewise; one that begins with "|" would be a program to run.
std::string gnuplot_path(const std::string& path);

/// Whether it ends in .svg, in small or capital letters.
bool is_svg_path(const std::string& path);

/// "set terminal" and "set output" of an image of so many pixels as SVG; of a .png half as many
/// again.
std::string gnuplot_output(const std::string& image_path, double width, double height);

}  // namespace posewise::detail
