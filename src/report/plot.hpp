#pragma once

#include <chrono>
#include <functional>
#include <string>

#include "posewise/task/calibration.hpp"
#include "posewise/task/plan.hpp"
#include "posewise/task/scene.hpp"
#include "posewise/task/study.hpp"

namespace posewise::detail {

/// Throws InputError if an image's path does not end in .svg or .png or has control characters.
void check_image_path(const std::string& path);

/// The gnuplot script that draws held-out error against pose count into `image_path` (ending
/// `.svg` or `.png`): one line each criterion, the random subsets' median over their 10-90 % band,
/// error in mm on a logarithmic axis. Of several error models' studies (compare_models()) each has
/// its lines, the first alone the band. The band's upper side leaves the plot where the 90 %
/// quantile falls among subsets that could not identify the model; the median has a gap there.
/// Texts and paths are quoted, so nothing in them is executed. Throws InputError as
/// check_image_path() does, or for a study without any held-out error.
std::string study_plot_script(const std::vector<Study>& studies, const std::string& image_path);

/// The script that draws, for each criterion, value and efficiency of plain blocks' subsets against
/// pose count: chosen, proven bound, 5-95 % of random ones with their median, own ones as points.
/// Throws InputError as check_image_path() does.
std::string study_plot_script(const BlocksStudy& study, const std::string& image_path);

/// The script that draws the poses of a plan in the base frame, from the side and from above: each
/// as a line through the joints to the targets, coloured in the order to visit them, with the
/// cell's solids, floor and walls along an axis, and the tracker. Throws InputError as
/// check_image_path(), and for a plan without a robot.
std::string plan_plot_script(const Plan& plan, const Scene& scene, const std::string& image_path);

/// The script that draws what is left of the readings of a calibration: each in the order measured,
/// an axis a colour; and how many are off by less than how much, of the nominal robot, calibrated,
/// and held out. Lengths if there are some, else angles. Throws InputError as check_image_path(),
/// and where nothing was measured.
std::string residual_plot_script(const Campaign& campaign,
                                 const std::vector<ReadingResidual>& readings,
                                 const std::string& image_path);

/// Runs gnuplot on a script file, not through a shell. Throws InputError if gnuplot is absent or
/// fails, or is ended because it takes longer than `limit` or `is_stopped` says so.
void run_gnuplot(const std::string& script_path, const std::function<bool()>& is_stopped = {},
                 std::chrono::milliseconds limit = std::chrono::seconds(20));

}  // namespace posewise::detail
