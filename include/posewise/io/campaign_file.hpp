#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/core/types.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/model/controller.hpp"
#include "posewise/task/judgement.hpp"

namespace posewise::io {

/// Names of the variables in a MATLAB file.
struct MatMapping {
    std::string joints = "q";         ///< samples x joints
    std::vector<std::string> points;  ///< one variable per target, samples x 3
    std::string torques = "tau";      ///< samples x measured torques, N m
    double angle_unit = 1;            ///< unit of revolute joints, in rad
    double length_unit = 1;           ///< unit of points and prismatic joints, in m
};

/// The error parameters that the robot of a campaign has.
enum class ErrorModel {
    None,      ///< none: only base and targets are found
    Stated,    ///< those that the file names in brackets
    Offsets,   ///< joint zeros, reduced to those that can be told apart
    Complete,  ///< all geometric errors of rigid links, reduced to an irreducible set
    Full,      ///< geometric errors, torque shapes, harmonics; sizes are priors: the default
};

/// "none", "stated", "offsets", "geometric" or "full", as in files under `errors`.
std::string_view error_model_name(ErrorModel model);
/// The model with that name ("complete" is geometric, too). Throws InputError for any other.
ErrorModel parse_error_model(const std::string& name);

/// A campaign, the rest of its file, and defaults for the command line.
struct CampaignFile : Campaign {
    std::string path;
    std::string content;   ///< the file's text
    std::string checksum;  ///< checksum of that
    /// The robot as the file's elements state it. `robot` is the irreducible form of its complete
    /// model with ErrorModel::Complete, that of its joint zeros with ErrorModel::Offsets, its full
    /// model with ErrorModel::Full, else the same.
    Chain declared_robot;
    /// Number of robot angles that the file rounds; within 1e-6 rad of a multiple of 90 deg they
    /// are taken as that.
    Index rounded_angle_count = 0;
    RobotClass robot_class = RobotClass::Unknown;
    ErrorModel error_model = ErrorModel::Stated;
    /// What select and plan use instead, as the file states under `planning`.
    std::optional<ErrorModel> planned_model;
    std::optional<UrdfSource> urdf;     ///< source of the robot, if it comes from a URDF
    std::vector<std::string> warnings;  ///< parts of it that were not understood, a sentence each
    /// Who measured, with what, when: keys of section `record` and their texts, in its order.
    std::vector<std::pair<std::string, std::string>> record{};
    MatMapping mat;
    ControllerJoints controller;   ///< joints of programs; the robot's own where nothing is stated
    std::string controller_maker;  ///< the family that `controller` is of; empty: none is stated
    bool has_controller_columns = false;  ///< measurements hold the controller's joints, so named
    /// Which observation of robot_calibration's messages is measured with; empty: the only one.
    std::string observation{};
};

/// Overrides whether the expected sizes are priors; nothing: as the file states. A full model
/// without priors is reduced to what poses can tell apart; throws InputError if that is stopped.
void set_prior(CampaignFile& campaign, std::optional<bool> is_prior, const StopSignal& stop = {});

/// Reads a campaign from YAML; designs/README.md explains every key. Throws InputError with
/// path:line:column for anything missing, misspelt or out of range. A stop ends the search for an
/// irreducible model with an error.
CampaignFile read_campaign(const std::string& path, const StopSignal& stop = {});

/// Reads a text that is not in its file (yet). Its paths are relative to the folder of `path`.
CampaignFile parse_campaign(const std::string& content, const std::string& path,
                            const StopSignal& stop = {});

/// The campaign for planning poses: with the error model that its file states under `planning`, if
/// any, and then with the Campaign::fitted_pose_count of the model under `robot`. The expected
/// sizes are priors as asked, else as the file states.
CampaignFile planned_campaign(const CampaignFile& campaign, std::optional<bool> prior = {},
                              const StopSignal& stop = {});

/// The campaign with each richer error model that its robot can have, to try where a calibration is
/// doubtful (CalibrationOptions::richer). The expected sizes are priors as asked.
std::vector<OtherCampaign> richer_campaigns(const CampaignFile& campaign,
                                            std::optional<bool> prior = {});

/// Reads a campaign with each of these error models in turn, whatever the file states under
/// `errors`. Expected sizes of single parameters that a model does not have are ignored.
std::vector<CampaignFile> read_campaign(const std::string& path,
                                        const std::vector<ErrorModel>& models);

/// One key of a campaign file, and the values it takes in turn.
struct VariedKey {
    std::string key;                  ///< with the keys it stands under: "sensor.sigma_mm"
    std::vector<std::string> values;  ///< as YAML: "0.05", "[1, 2, 3]", "full"
    std::optional<std::pair<double, double>> range{};  ///< instead: any number in between
};

/// Parses "sensor.sigma_mm=0.01,0.05" or "sensor.sigma_mm=0.01..0.05". Throws InputError for any
/// other text, and for an empty range.
VariedKey parse_varied_key(const std::string& text);

/// A campaign file's text with other values for some keys.
struct Variation {
    std::string name;  ///< "sensor.sigma_mm=0.01 sensor.targets.count=3"; empty: as it is
    std::string content;
};

/// Makes every combination of the values, the last key's changing fastest; without keys the text
/// unchanged. A number in a key is an index in a list, from 1: "sensor.targets.1.position_mm".
/// Missing keys are added; parse_campaign() checks whether they are allowed. Ranges, if any, are
/// filled together by `point_count` points, each with every combination of the values. The points
/// are an additive recurrence with the powers of the root of x^(d+1) = x + 1 for d ranges, so fewer
/// points are the first of more. They are even by ratio if the upper end is at least ten times a
/// positive lower one. Throws InputError if the text at `path` is no YAML, for a key under
/// something that is not a map or list, and for ranges without points or points without ranges.
std::vector<Variation> vary_campaign(const std::string& content, const std::string& path,
                                     const std::vector<VariedKey>& keys, Index point_count = 0);

}  // namespace posewise::io
