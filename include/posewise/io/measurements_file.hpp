#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/calibrator/correction.hpp"
#include "posewise/core/blocks.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/answers.hpp"

namespace posewise {
struct Plan;
}

namespace posewise::io {

/// When measurements were taken, as means of each configuration.
struct NotedTimes {
    /// What they are counted in: "seconds", "time of day" or "date", with the zone that stands
    /// behind (date+01:00); empty: not all alike.
    std::string clock;
    double first = 0;  ///< s
    double last = 0;   ///< s
};

/// Measurements as a file has them.
struct MeasurementsFile : Measurements {
    std::vector<std::string> unused_columns = {};  ///< names of columns that nothing is known about
    bool is_joined = false;                        ///< from points and a plan
    std::string joined = {};  ///< if so: which points are missing, in words; empty: none
    /// By the columns time or time_s, in h since the first, and temperature_C; means of each
    /// configuration's samples. Columns that cannot be read all are among `unused_columns`.
    std::vector<Condition> conditions = {};
    std::optional<NotedTimes> times = {};  ///< those of `conditions`
};

/// What the reader passed over, a sentence each: columns that it does not know, missing points.
std::vector<std::string> describe_passed_over(const MeasurementsFile& measured);

/// What an instrument's list of points needs to be measurements.
struct PointsSource {
    const Plan* plan = nullptr;  ///< the poses that they were measured at; nullptr: not stated
    std::string plan_path = {};  ///< for messages
    std::string unit = {};       ///< "mm", "m" or "um", where the list has none; empty: not stated
};

/// Reads measurements, by the file's ending: `.mat`, else CSV. Throws InputError with
/// path:line:column. If a sample does not show a target, all of its cells are empty or "nan" (CSV)
/// or NaN (MATLAB). Columns that are not known are passed over, unless they are nearly one that is.
/// Refused: a sample that shows no target, missing columns, ragged rows, text or other non-finite
/// numbers, readings half of which repeat others under another id, angles in rad over four turns
/// beyond the limits (they look like degrees), a configuration whose samples differ in a joint by
/// over 1e-6. With CampaignFile::has_controller_columns the file's joints are the controller's;
/// those returned are always the model's.
///
/// A file without the column `config` may be a list of points, as SpatialAnalyzer or PolyWorks
/// write it: `name x y z`, separated by commas, semicolons, tabs or blanks, with names of
/// collection and group before it (`Collection::Group::Target`), or under a header with x, y and z.
/// They get their configurations from the plan's poses by their names, P001_T1 for the first target
/// at pose p1, in any order; some may be missing. Where no name is one of the plan's and there are
/// as many points as it has, they are taken in its order. A list is refused if only some of its
/// names are the plan's, if it names a point twice, lacks a unit, or has a row with another number
/// of fields.
MeasurementsFile read_measurements(const std::string& path, const CampaignFile& file,
                                   const PointsSource& points = {});

/// Plans that were measured together, as one: the poses of all in their order, with their plan's
/// name before the id, old/p1 for p1 of old.json, or with folders where several are called so.
/// Throws InputError for a plan that is not of this campaign's robot and sensor.
Plan join_plans(std::vector<Plan> plans, const std::vector<std::string>& paths,
                const Campaign& campaign);

/// Measurements of such plans, one for each, as one with the ids of join_plans(). Temperatures are
/// kept if all have them; times if all have them and they are of one clock: dates, or each begins
/// after the one before ended. Otherwise `joined` says so. Throws InputError if two have the same
/// readings.
MeasurementsFile join_measurements(std::vector<MeasurementsFile> parts,
                                   const std::vector<std::string>& paths,
                                   const std::vector<std::string>& plan_paths);

/// Named configurations that need not have been measured.
struct Configurations {
    std::vector<std::string> ids;
    RowMatrixXd joints;  ///< configurations x joints, rad or m
    Seen is_seen;        ///< which targets to measure there
    /// For a program with a column purpose (as plan --csv writes it): calibrate, verify or via.
    std::vector<std::string> purposes = {};
    bool is_corrected = false;  ///< has columns as `correct` writes them
};

/// Reads configurations as read_measurements() does. A CSV file needs no sensor columns; their
/// values do not matter. Its column visible_targets, if any, lists the targets each shows ("1 3"),
/// as in plans; else all are visible. Configurations beyond the joint limits are refused: nobody
/// measured there.
Configurations read_configurations(const std::string& path, const CampaignFile& file);
/// Throws InputError, naming the file, if one of them is beyond the joint limits.
void check_within_limits(const std::string& path, const CampaignFile& file,
                         const Configurations& configurations);
/// The poses of a program, which may contain one more than once: each row is a pose or, with a
/// column sample, each configuration. Limits are not checked.
Configurations read_program(const std::string& path, const CampaignFile& file);
/// CSV only, without checking limits.
Configurations read_configurations_csv(const std::string& path, const Campaign& campaign);
Configurations read_program_csv(const std::string& path, const Campaign& campaign);

/// CSV with units in the header: config, <joint>_rad or _deg (_m or _mm for a prismatic joint), the
/// sensor's columns with _m or _mm (orientations: rx, ry, rz or roll, pitch, yaw with _rad or _deg,
/// or qw, qx, qy, qz of length 1 within 0.001; positions also tx, ty, tz, in m without a unit), and
/// optionally sample and visible_targets (need not agree with the targets measured); in any order.
/// Separators are commas, semicolons or tabs; lines after # are comments. Rows of one config may
/// stand anywhere.
MeasurementsFile read_measurements_csv(const std::string& path, const Campaign& campaign);

/// MATLAB file (5 to 7.3) with real double matrices. Rows with equal joint values are samples of
/// one configuration; NaN in all three columns of a target: not seen. Configurations are named 0,
/// 1, ... in the order they first occur.
Measurements read_measurements_mat(const std::string& path, const Campaign& campaign,
                                   const MatMapping& mapping);

/// Writes CSV (rad and mm, with enough digits to read the numbers back exactly; cells of targets
/// not seen are empty). `comment_lines` go first, each after "# ".
void write_measurements_csv(const std::string& path, const Campaign& campaign,
                            const Measurements& measurements,
                            const std::vector<std::string>& comment_lines = {});

/// Writes such a CSV file for read_measurements(): it has the controller's joints where
/// CampaignFile::has_controller_columns says that measurements have them.
void write_measurements(const std::string& path, const CampaignFile& file,
                        const Measurements& measurements,
                        const std::vector<std::string>& comment_lines = {});

/// Writes CSV: config, the corrected joint values (degrees or mm, with enough digits to read them
/// back exactly), residual_mm, residual_mrad, uncorrected_mm, uncorrected_mrad, and note
/// (describe_shortfall()); also purpose, if `purposes` are stated. `ids`, `corrections` and stated
/// `purposes` have equal lengths.
void write_corrections_csv(const std::string& path, const Campaign& campaign,
                           const std::vector<std::string>& ids,
                           const std::vector<Correction>& corrections,
                           const std::vector<std::string>& purposes = {});

// Plain blocks in files, anybody's Jacobians: CSV, blanks (numpy.savetxt()), MATLAB, .npy, .npz.

/// What a file of blocks holds. Every block has as many rows.
struct BlocksFile {
    Blocks blocks;
    Index rows_per_block = 0;
    std::vector<std::string> names{};   ///< parameter names; empty: the file has none
    std::vector<std::string> doubts{};  ///< why the rows may not be meant so, a sentence each
};

/// Reads blocks of equal height. `rows_per_block` may be 0 if the file holds three dimensions
/// (candidates x rows x parameters). `variable`: of a .mat or .npz file; empty: the first. Throws
/// InputError if that contradicts the file or is missing, if it does not divide the number of rows,
/// and as make_equal_blocks() does.
BlocksFile read_blocks(const std::string& path, Index rows_per_block = 0,
                       const std::string& variable = "");

/// Writes blocks of equal height: .npy, .npz (variable `blocks`) in three dimensions, else CSV,
/// with these names of the parameters, if any, as header. Throws InputError if the heights differ
/// or the file cannot be written.
void write_blocks(const std::string& path, const Blocks& blocks,
                  const std::vector<std::string>& names = {});

/// Indices of candidates from 0 to `candidate_count` - 1, in any shape of matrix, in the order of
/// the file; or the ids of a plan of plain blocks (.json). Throws InputError for others.
std::vector<Index> read_subset(const std::string& path, Index candidate_count);

}  // namespace posewise::io
