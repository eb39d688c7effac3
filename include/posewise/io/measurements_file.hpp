#pragma once

#include <string>

#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::io {

/// Reads measurements by the file's ending: `.mat` or else CSV. Throws InputError with
/// path:line:column. Refused: missing or unknown columns, ragged rows, text or non-finite numbers,
/// two configurations with the same joint values, angles in rad beyond 2 pi + limits (degrees by
/// the look of them), a configuration whose samples have different joint values.
Measurements read_measurements(const std::string& path, const CampaignFile& file);

/// CSV with a header that carries the units: config, sample, <joint>_rad|_deg|_m|_mm, then the
/// sensor's columns with _m or _mm.
Measurements read_measurements_csv(const std::string& path, const Campaign& campaign);

/// MATLAB 5-7 file; consecutive rows with equal joint values are samples of one configuration.
Measurements read_measurements_mat(const std::string& path, const Campaign& campaign,
                                   const MatMapping& mapping);

/// Writes CSV (rad and mm, 17 digits). `comment_lines` go first, each behind "# ".
void write_measurements_csv(const std::string& path, const Campaign& campaign,
                            const Measurements& measurements,
                            const std::vector<std::string>& comment_lines = {});

}  // namespace posewise::io
