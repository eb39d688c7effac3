#pragma once

#include <string>
#include <vector>

#include "posewise/task/study.hpp"

namespace posewise::cli {

/// Draws the studies with gnuplot, elsewhere first, so that the image is replaced by a whole one or
/// not at all. Throws InputError if it cannot be drawn; the script is then left beside it.
void draw_plot(const std::string& image_path, const std::vector<Study>& studies);

}  // namespace posewise::cli
