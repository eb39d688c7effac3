#pragma once

#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/task/plan.hpp"

namespace posewise::io {

/// Writes a plan as JSON (format 2): what was asked for and from which candidates, value, bounds
/// and the matrix that proves them, how it was made, what it assumes (noise, scales), and the
/// poses, joint values in rad (m) exactly and in degrees (mm) for people. Relative paths are stored
/// as seen from the plan's folder; infinite numbers are null. `warnings`: what was warned of, a
/// sentence each.
void write_plan(const std::string& path, const Plan& plan,
                const std::vector<std::string>& warnings = {});
/// The same beside write_configurations_csv() of its poses, unless `csv_path` is empty: both files
/// or none.
void write_plan(const std::string& path, const Plan& plan, const std::string& csv_path,
                const Campaign& campaign, const std::vector<std::string>& warnings = {});

/// Reads a plan of format 2 or 1 (which had two kinds: "posewise plan" and "posewise pose plan");
/// the file is read once. Relative paths lead from the plan's folder or else from the current one.
/// Throws InputError with the place for whatever is missing, of another type or out of range.
Plan read_plan(const std::string& path);

/// The poses as CSV, in the order to visit them: config, then each joint in degrees or mm, digits
/// enough to read the numbers back exactly, then visible_targets ("1 3"), purpose, way and, where a
/// cell has obstacles, clearance_mm and nearest. The purpose is calibrate, or verify of those that
/// a plan has to verify, which come last. A point to pass on the way to p3 is a row of its own
/// before it, p3.via, its purpose via; a way is straight, or BLOCKED where none was found.
/// read_configurations() reads the others, read_program() all.
void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<PlannedPose>& poses);

}  // namespace posewise::io
