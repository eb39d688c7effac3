#pragma once

#include <string>
#include <vector>

#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::io {

/// Reads measurements by the file's ending: `.mat` or else CSV. Throws InputError with
/// path:line:column. A target that a sample does not show has empty cells or "nan" (CSV) or NaN
/// (MATLAB), all of them. Refused: a sample that shows no target, missing or unknown columns,
/// ragged rows, text or other non-finite numbers, readings of which half are others once more under
/// another id, angles in rad over four turns beyond the limits (degrees by the look of them), a
/// configuration whose samples differ in a joint by over 1e-6.
Measurements read_measurements(const std::string& path, const CampaignFile& file);

/// Named configurations, none of them measured (or not of interest whether).
struct Configurations {
    std::vector<std::string> ids;
    RowMatrixXd joints;  ///< configurations x joints, rad or m
    Seen is_seen;        ///< which targets are to be measured there
    /// Of a program with a column purpose (as plan --csv writes it): calibrate, verify or via.
    std::vector<std::string> purposes = {};
};

/// Reads configurations as read_measurements() does; a CSV need not have the sensor's columns, and
/// what stands in them does not matter. Its column visible_targets, if there is one, lists the
/// targets each shows ("1 3"), as plans do; else all are visible. What is beyond the joint limits
/// is refused: nobody measured there.
Configurations read_configurations(const std::string& path, const CampaignFile& file);
/// Throws InputError, naming the file, if one of them is beyond the joint limits.
void check_within_limits(const std::string& path, const CampaignFile& file,
                         const Configurations& configurations);
/// The poses of a program, which may hold the same one more than once: each row is one, or where
/// there is a column sample each configuration. The limits are not looked at.
Configurations read_program(const std::string& path, const CampaignFile& file);
/// The same of CSV alone, without a look at the limits.
Configurations read_configurations_csv(const std::string& path, const Campaign& campaign);
Configurations read_program_csv(const std::string& path, const Campaign& campaign);

/// CSV with a header that carries the units: config, <joint>_rad or _deg (_m or _mm if it slides),
/// the sensor's columns with _m or _mm (orientations: rx, ry, rz or roll, pitch, yaw with _rad or
/// _deg, or qw, qx, qy, qz of length 1 within 0.001), and optionally sample and visible_targets
/// (which measured ones need not agree with); in any order. Separated by commas, semicolons or
/// tabs; lines after # are comments. Rows of one config may stand anywhere.
Measurements read_measurements_csv(const std::string& path, const Campaign& campaign);

/// MATLAB file (5 to 7.3) of real double matrices; rows with equal joint values are samples of one
/// configuration; NaN in all three columns of a target: not seen. Configurations are named 0, 1,
/// ... in the order they first occur.
Measurements read_measurements_mat(const std::string& path, const Campaign& campaign,
                                   const MatMapping& mapping);

/// Writes CSV (rad and mm, digits enough to read the numbers back exactly; cells of targets not
/// seen are empty). `comment_lines` go first, each after "# ".
void write_measurements_csv(const std::string& path, const Campaign& campaign,
                            const Measurements& measurements,
                            const std::vector<std::string>& comment_lines = {});

}  // namespace posewise::io
