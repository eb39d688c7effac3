#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/model/controller.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/choice.hpp"
#include "posewise/task/plan.hpp"
#include "posewise/task/planning.hpp"
#include "posewise/task/study.hpp"

namespace posewise::io {

/// Writes a plan as JSON (format 2): the request and the candidates; value, bounds and the matrix
/// that proves them; how it was made; what it assumes (noise, scales); and the poses, with joint
/// values exactly in rad (m) and readably in degrees (mm). Relative paths are stored relative to
/// the plan's folder; infinite numbers are null. `warnings` are those given meanwhile, a sentence
/// each.
void write_plan(const std::string& path, const Plan& plan,
                const std::vector<std::string>& warnings = {});
/// Tables to write together with a plan; a table without a path is not written.
struct PlanTables {
    std::string configurations{};  ///< write_configurations_csv()
    std::string targets{};         ///< write_targets()
};
/// As above, together with these: all files or none.
void write_plan(const std::string& path, const Plan& plan, const PlanTables& tables,
                const Campaign& campaign, const std::vector<std::string>& warnings = {});

/// Reads a plan of format 2 or 1 (which had two kinds: "posewise plan" and "posewise pose plan"),
/// reading the file once. Relative paths lead from the plan's folder or else from the current one.
/// Throws InputError with the place for whatever is missing, of another type or out of range.
Plan read_plan(const std::string& path);
/// The same of what the file at that path would hold.
Plan parse_plan(const std::string& content, const std::string& path);
/// As above; or, of a file that ends in .csv, its configurations as the poses of a plan: those with
/// the purpose verify to verify, via points left out.
Plan read_plan(const std::string& path, const Campaign& campaign);

/// Writes the poses as CSV, in visiting order: config, then each joint in degrees or mm with enough
/// digits to read the numbers back exactly, then visible_targets ("1 3"), purpose, way and, if the
/// cell has obstacles, clearance_mm and nearest. The purpose is calibrate, or verify for a plan's
/// verification poses, which come last. A via point before p3 is a row of its own, p3.via, with
/// purpose via. The way is straight, or BLOCKED if none was found. read_configurations() skips via
/// points, read_program() reads all.
void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<PlannedPose>& poses);

/// Writes where an instrument finds each target at each pose, in visiting order, as CSV: name
/// (P001_T1 for the first target at pose p1), x_mm, y_mm, z_mm in the instrument's frame for the
/// nominal robot, range_mm, azimuth_deg, elevation_deg, incidence_deg (empty where the cell does
/// not state the targets' normals) and visible (yes or no). A file that ends in .txt has the
/// visible ones only, as a list of name, x, y and z in mm without a header, which instruments'
/// programs import. read_measurements() joins what was measured by these names. Of several sensors
/// those of points have rows, each in its own frame; where they are more than one, a column sensor
/// has their numbers, and a list is refused. Throws InputError unless a sensor measures points and
/// the campaign states where they are.
void write_targets(const std::string& path, const Campaign& campaign, const Plan& plan);

/// The inputs of an estimate: paths, and checksums where they are known.
struct Provenance {
    std::string measurements{};
    std::string measurements_checksum{};  ///< checksum_of()
    std::string campaign_file{};
    std::string campaign_checksum{};  ///< CampaignFile::checksum
    /// Command-line options: name and values.
    std::vector<std::pair<std::string, std::vector<std::string>>> options{};
    std::vector<std::string> warnings{};  ///< those given meanwhile, a sentence each
    std::vector<Answer> answers{};        ///< answer() of the calibration
    std::vector<std::pair<std::string, std::string>> record{};  ///< CampaignFile::record
};

/// Checksum of configurations, their ids and observations, to tell whether measurements are the
/// same.
std::string checksum_of(const Measurements& measurements);

/// Writes a calibration as JSON, with units in the names (accuracy in mm, all else in m and rad)
/// and enough digits to read the numbers back exactly. Same input, same bytes. The calibration must
/// be identified.
void write_estimate(const std::string& path, const Calibration& calibration,
                    const Provenance& made_from);

/// Writes CSV, one row per joint of the controller whose offset was found: joint, offset,
/// deviation, unit (deg or mm) and, if they are stated, pulses. The joint stands at its commanded
/// value plus the offset. `controller`: ControllerJoints(campaign.robot) for the model's own
/// joints.
void write_offsets_csv(const std::string& path, const Campaign& campaign, const Estimate& estimate,
                       const ControllerJoints& controller);

/// Writes CSV, one row per configuration: config, then parameters, left_over, noise, total (RMS)
/// and p95 (95 % of points are off by less), each with _mm, or _mrad for orientations. `ids` are
/// those of the predicted configurations.
void write_predictions_csv(const std::string& path, const std::vector<std::string>& ids,
                           const std::vector<ErrorPrediction>& predictions);

/// Reads an estimate exactly as it was written: parameters, names, covariance, ending, variance
/// factor, degrees of freedom, model errors. Throws InputError with the place if the file is none,
/// or is for another robot than the campaign's (see designs/README.md) or another kind of sensor.
/// find_faults() and EarlierFile::faults tell whether it can be used.
Estimate read_estimate(const std::string& path, const Campaign& campaign);

/// An earlier estimate, with the sizes of errors that were learned with it. Targets (the sensor's
/// unknowns) that have moved since may be others now, seen by another kind of sensor: they are as
/// the campaign states them, with covariance 0.
struct EarlierFile : Earlier {
    /// Changes since in the campaign's noise or expected sizes: "sigma_m was 1e-05, is 2e-05".
    std::vector<std::string> changes;
    std::vector<std::string> warnings;  ///< those given when it was made, a sentence each
    /// Calibration::faults, if it was written nevertheless: it must not be used.
    std::vector<std::string> faults;
};
EarlierFile read_earlier(const std::string& path, const Campaign& campaign, const EarlierUse& use);
/// Why it must not be used, in words: what its file says, and find_faults() under the campaign.
std::vector<std::string> find_faults(const Campaign& campaign, const EarlierFile& earlier);

/// Whether the checksum is that of these measurements, with or without those excluded.
bool are_of_checksum(const std::string& checksum, const Measurements& measurements,
                     const std::vector<std::string>& excluded);

/// Whether an estimate states that it was made from these measurements, with or without those that
/// it lists as excluded.
bool is_made_from(const std::string& estimate_path, const Measurements& measurements);

/// Writes the weights as CSV (config, weight; with enough digits to read them back exactly) or as
/// JSON (to_json() of the design, with the warnings given), by the file's ending. Throws InputError
/// unless it is .csv or .json.
void write_weights(const std::string& path, const ApproximateDesign& design,
                   const std::vector<std::string>& warnings = {});

/// Opens or creates an SQLite file for finished trials; a new one that stays empty is removed
/// again. It belongs to one version of posewise, and to one process at a time; others may read it
/// meanwhile. Kept trials survive a killed process. A power failure may lose the last ones, but
/// never the file. A trial may be kept again if the numbers are the same. Throws InputError, and so
/// do the functions, for a file that is no store, damaged, of another version, being written, or
/// that cannot be written.
TrialStore open_trial_store(const std::string& path);

/// Opens a store only for reading: of any version of posewise, even while another process writes
/// it. Its `keep` throws.
TrialStore read_trial_store(const std::string& path);

/// The series that a store has trials of; their order does not depend on how the trials came there.
std::vector<TrialSeries> series_in_store(const std::string& path);

/// Puts all trials of some stores into one more, which may be new or have trials already: all or,
/// if it throws, none. Throws InputError as open_trial_store(), and if a trial has different
/// numbers in two of them.
void merge_trial_stores(const std::vector<std::string>& from, const std::string& into);

/// Whether the file exists and is a store of trials, of any format, by its first bytes. Not for one
/// that this process has open: closing a file ends all SQLite locks on it.
bool is_trial_store(const std::string& path);

// Files written by commands, read again to inspect them.

enum class SavedKind {
    Plan,      ///< a plan file, or what select --json or plan --json printed
    Estimate,  ///< from calibrate
    Study,     ///< what study --json printed
    Export,    ///< what export --json printed
    Trials,    ///< a store, from study --store
};

/// The kind of a file, by its content. Throws InputError for any other.
SavedKind kind_of_saved(const std::string& path);

/// The document in the file of a plan, an estimate, a study or an export. Throws InputError for
/// another kind or format.
std::string read_saved_document(const std::string& path, SavedKind kind);

/// The document of a plan with the results of judge_again() and the answers to them, unless it has
/// them already.
std::string read_saved_plan(const std::string& path, const Planning& judged,
                            const std::vector<Answer>& answers);
/// As above for a choice.
std::string read_saved_plan(const std::string& path, const Plan& judged,
                            const std::vector<Answer>& answers);

/// How an estimate was made, as its file states.
struct EstimateRecord {
    std::string campaign;  ///< its name
    Provenance made_from;  ///< paths as they were typed
    std::vector<std::string> excluded;
    Index folds = 0;  ///< groups held out; 0: none
    Loss loss;

    /// Whether that option was given.
    bool has_option(const std::string& name) const;
};
EstimateRecord read_estimate_record(const std::string& path);

/// Where an estimate has camera and board.
struct CameraPlaces {
    bool is_on_flange = false;  ///< the camera; else the board
    /// Where the camera is, z forwards and x to the right of its image: in the flange frame; a
    /// fixed one in the robot's base frame.
    Isometry3d camera = Isometry3d::Identity();
    /// Where the board is, in the other frame.
    Isometry3d board = Isometry3d::Identity();
    std::optional<Intrinsics> intrinsics;  ///< known if corners were measured
    std::optional<Vector2d> image;         ///< width and height, px
    std::vector<PlacedCamera> others{};
};
/// The sensor, or one of several, the first that does, must measure corners in an image, or poses
/// of a board; else the result is empty.
std::optional<CameraPlaces> camera_places(const Campaign& campaign, const Parameters& found);

/// Throws InputError if the name does not end in .yaml, .yml, .urdf or .xacro.
void check_camera_path(const std::string& path);
/// The ending chooses the format. YAML is a file for OpenCV's FileStorage: intrinsic parameters,
/// and both frames as 4 x 4 matrices (m); of further cameras likewise, `camera2_matrix` and
/// `camera_from_camera2`. URDF has fixed joints to the frames camera_optical_frame (further ones
/// camera2_optical_frame on it) and calibration_board; their parents are the campaign's base and
/// tip link, base_link and tool0 without a URDF. Throws InputError as check_camera_path(), or if no
/// file can be there.
void write_camera(const std::string& path, const CampaignFile& file, const CameraPlaces& places);
/// The camera's place as arguments of ROS 2's static_transform_publisher.
std::string static_transform(const CampaignFile& file, const CameraPlaces& places);

}  // namespace posewise::io
