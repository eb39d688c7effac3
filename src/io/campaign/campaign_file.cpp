#include "posewise/io/campaign_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "campaign_sections.hpp"
#include "core/checksum.hpp"
#include "core/names.hpp"
#include "io/format/atomic_file.hpp"
#include "io/format/file_kind.hpp"
#include "io/format/text.hpp"
#include "keys.hpp"
#include "measurement/contact.hpp"
#include "model/complete_model.hpp"
#include "model/exact_angles.hpp"
#include "model/joint_limits.hpp"
#include "model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/camera_sensor.hpp"

namespace posewise::io {
namespace {

constexpr detail::Names<ErrorModel, 5> error_models{{{ErrorModel::Full, "full"},
                                                     {ErrorModel::Complete, "geometric"},
                                                     {ErrorModel::Offsets, "offsets"},
                                                     {ErrorModel::Stated, "stated"},
                                                     {ErrorModel::None, "none"}}};

using detail::Quantity;
namespace keys = detail::keys;
using detail::YamlMap;
using detail::YamlValue;

constexpr std::size_t most_bytes = 1 << 20;  // of a file

void read_base(const YamlMap& map, bool is_world, Campaign& campaign) {
    const std::optional<YamlValue> value = map.find("base");
    if (is_world) {
        if (value) {
            throw value->error(
                "is stated beside sockets at unknown places, which are found in the robot's base "
                "frame; must be left out, or known_sockets: true");
        }
        campaign.base_is_known.fill(true);
        campaign.has_nominal_base = true;
        return;
    }
    if (!value && campaign.sensor->has_contacts()) {
        throw map.require("sensor").error(
            "has known_sockets: true, whose places are in the frame of base; base must be stated, "
            "if only roughly");
    }
    if (!value) return;
    const YamlMap base(*value, keys::places, "base");
    campaign.nominal.world_from_base = read_frame(base);
    campaign.has_nominal_base = true;
    const auto known = base.find("known");
    if (!known) return;
    const auto marks = read_known(*known, {"x", "y", "z", "rx", "ry", "rz"});
    std::copy(marks.begin(), marks.end(), campaign.base_is_known.begin());
}

/// Places that the robot reaches, for those that the file does not state.
void place_within_reach(const std::vector<Index>& reached, Campaign& campaign) {
    constexpr std::uint64_t seed = 20154;  // any: it only has to be the same every time
    const Chain& robot = campaign.robot;
    const RowMatrixXd drawn =
        detail::random_configurations(robot, static_cast<Index>(reached.size()), seed);
    const detail::JointRange range = detail::limits_of(robot);
    VectorXd middle = drawn.row(0).transpose();
    middle.head(robot.joint_count()) = (range.lower + range.upper) / 2;
    const Targets& targets = campaign.sensor->targets();
    for (std::size_t k = 0; k < reached.size(); ++k) {
        const VectorXd q = (middle + drawn.row(static_cast<Index>(k)).transpose()) / 2;
        campaign.nominal.sensor.segment<3>(reached[k]) =
            world_from_flange(campaign, campaign.nominal, q) *
            targets.position(0, campaign.nominal.sensor);
    }
}

bool is_fixed_camera(const Sensor& sensor) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(&sensor);
    return camera != nullptr && !camera->setup().is_on_flange;
}

/// `has_stated_errors`: the campaign has no other error parameters than the file says.
ParameterSpread read_spread(const YamlValue& value, const Campaign& campaign,
                            bool has_stated_errors) {
    const YamlMap map(value, keys::spread);
    ParameterSpread spread = campaign.spread;
    const auto read = [&map](std::string_view key, double& size) {
        const auto measure = map.find_measure(key);
        if (measure)
            size = read_positive(*measure, false, detail::largest_error(measure->unit->quantity));
    };
    read("length", spread.length);
    read("angle", spread.angle);
    read("gravity", spread.gravity);
    read("harmonic", spread.harmonic);
    read("slide_harmonic", spread.slide_harmonic);
    read("tilt", spread.tilt);
    read("gain", spread.gain);
    if (map.find_measure("offset")) read("offset", spread.offset.emplace());
    const auto parameters = map.find("parameters");
    if (!parameters) return spread;
    const std::vector<std::string> names = parameter_names(campaign);
    const std::vector<bool> is_angle = parameter_is_angle(campaign);
    for (const detail::YamlEntry& entry : parameters->entries()) {
        const auto found = std::find(names.begin(), names.end(), entry.key);
        if (found == names.end()) {
            if (!has_stated_errors) continue;
            throw input_error_at(entry.key_location, detail::quote(entry.key) +
                                                         " is no parameter of this campaign; " +
                                                         detail::suggest(entry.key, names));
        }
        const auto index = static_cast<std::size_t>(found - names.begin());
        const auto quantity = is_angle[index] ? Quantity::Angle : Quantity::Length;
        spread.by_name[entry.key] = read_amount(entry.value, quantity, detail::Sign::Positive,
                                                detail::largest_error(quantity));
    }
    return spread;
}

/// "auto" is what is expected of the robot's class: beside priors a calibration finds it.
void read_model_error(const YamlMap& map, std::string_view key, double& error) {
    const auto measure = map.find_measure(key);
    if (!measure || measure->value.is_text("auto")) return;
    measure->value.number(", or auto");
    error = read_positive(*measure, true);
}

double read_unit(const YamlMap& map, std::string_view key, Quantity quantity) {
    const auto value = map.find(key);
    if (!value) return 1;
    const detail::Unit* const unit = detail::find_unit(value->text());
    if (unit == nullptr || unit->quantity != quantity) {
        throw value->error("is " + detail::quote(value->text()) + "; must be " +
                           detail::list_words(unit_names(quantity)));
    }
    return unit->to_si(1);
}

MatMapping read_mat_mapping(const YamlValue& value, Index target_count) {
    const YamlMap map(value, keys::mat);
    MatMapping mapping;
    mapping.joints = map.require("joints").text();
    if (const auto torques = map.find("torques")) mapping.torques = torques->text();
    for (const YamlValue& point : map.require("points").list()) {
        mapping.points.push_back(point.text());
    }
    if (static_cast<Index>(mapping.points.size()) != target_count) {
        throw map.require("points").error("names " + std::to_string(mapping.points.size()) +
                                          " variables; must name " + std::to_string(target_count) +
                                          ", one for each target of the sensor");
    }
    mapping.angle_unit = read_unit(map, "angle_unit", Quantity::Angle);
    mapping.length_unit = read_unit(map, "length_unit", Quantity::Length);
    return mapping;
}

/// Whether joints of measurements are the controller's.
bool read_columns(const YamlValue& value) {
    if (value.is_text("controller")) return true;
    if (value.is_text("model")) return false;
    throw value.error("is " + detail::quote(value.text()) + "; must be controller or model");
}

void read_measurements_section(const YamlValue& value, CampaignFile& file) {
    const YamlMap map(value, keys::measurements);
    const auto columns = map.find("columns");
    file.has_controller_columns = columns && read_columns(*columns);
    const auto observation = map.find("observation");
    if (observation) file.observation = observation->text();
    if (const auto mat = columns || observation ? map.find("mat") : map.require("mat")) {
        file.mat = read_mat_mapping(*mat, file.sensor->target_count());
    }
}

Criterion read_criterion(const YamlValue& value) {
    const std::string name = value.text();
    try {
        return parse_criterion(name);
    } catch (const InputError& problem) {
        throw input_error_at(value.location(), std::string("criterion: ") + problem.what());
    }
}

/// What `make` returns; what is wrong is the robot's: "robot: `words`: ...".
template <typename Make>
Campaign make_of(const YamlValue& robot, const std::string& words, const Make& make) {
    try {
        return make();
    } catch (const InputError& problem) {
        throw robot.error(words + ": " + problem.what());
    }
}

Campaign with_listed_errors(const Campaign& campaign, const std::vector<YamlValue>& free) {
    std::vector<std::string> errors;
    for (const YamlValue& error : free) errors.push_back(error.text());
    try {
        return with_free_errors(campaign, errors);
    } catch (const InputError&) {
        for (const YamlValue& error : free) {  // whose fault it is
            try {
                with_free_errors(campaign, {error.text()});
            } catch (const InputError& problem) {
                throw error.error(problem.what());
            }
        }
        throw;
    }
}

Campaign make_irreducible(const Campaign& campaign, ErrorModel model, const StopSignal& stop) {
    return with_robot(campaign, model == ErrorModel::Offsets ? irreducible_offsets(campaign, stop)
                                                             : irreducible_model(campaign, stop));
}

/// One line of text: it becomes the title of plots and a comment of other files.
std::string read_name(const YamlValue& value) {
    const std::string name = value.text();
    if (detail::escape_controls(name) != name) {
        throw value.error("is " + detail::quote(name) +
                          "; must be one line without control characters");
    }
    return name;
}

std::vector<std::pair<std::string, std::string>> read_record(const YamlValue& value) {
    const YamlMap map(value, keys::record);
    std::vector<std::pair<std::string, std::string>> record;
    for (const detail::YamlKey& one : keys::record.keys) {
        if (const auto entry = map.find(one.key)) record.emplace_back(one.key, read_name(*entry));
    }
    return record;
}

/// The model to plan with. Poses chosen for a poorer one than is fitted may not identify it.
ErrorModel read_planned_model(const YamlValue& value, ErrorModel fitted) {
    const YamlMap planning(value, keys::planning);
    const YamlValue errors = planning.require("errors");
    const ErrorModel planned = detail::read_error_model(errors);
    if (planned >= fitted) return planned;
    throw errors.error(fmt::format("is {}, poorer than robot.errors, {}; must be full or left out",
                                   error_model_name(planned), error_model_name(fitted)));
}

/// With that error model, if one is asked for, else with the one that the file says.
CampaignFile parse(const std::string& content, const std::string& path,
                   std::optional<ErrorModel> errors, const StopSignal& stop) {
    const YamlMap map(detail::parse_yaml(content, path), keys::file);
    CampaignFile file;
    file.path = path;
    file.content = content;
    file.checksum = detail::checksum_of(content);
    Campaign& campaign = file;
    campaign.name = read_name(map.require("name"));
    if (campaign.name.empty()) {
        throw map.require("name").error("is empty; must be what the campaign is called");
    }

    detail::RobotSection robot = read_robot(map.require("robot"), errors);
    detail::ExactAngles exact = detail::with_exact_angles(robot.declared);
    robot.declared = std::move(exact.chain);
    file.rounded_angle_count = exact.count;
    file.declared_robot = robot.declared;
    file.robot_class = robot.robot_class;
    file.error_model = robot.error_model;
    file.urdf = robot.urdf;
    file.warnings = robot.warnings;
    const Population population = population_of(robot.robot_class, robot.declared);
    campaign.model_error = population.model_error;
    campaign.model_error_orientation = population.model_error_orientation;
    campaign.known_within = population.within;
    campaign.joint_repeatability = robot.joint_repeatability;
    const std::optional<YamlValue> sensors = map.find("sensors");
    if (sensors && map.find("sensor")) {
        throw sensors->error("is stated beside 'sensor'; must be one of them");
    }
    const detail::SensorSection sensor =
        sensors ? read_sensors(*sensors) : read_sensor(map.require("sensor"));
    campaign.sensor = sensor.sensor;
    campaign.nominal.sensor = sensor.unknowns;
    campaign.has_nominal_targets = sensor.has_positions;
    read_base(map, sensor.is_in_base_frame, campaign);
    campaign = with_robot(campaign, robot.declared);
    if (!sensor.reached.empty()) place_within_reach(sensor.reached, campaign);
    if (!campaign.has_nominal_base && is_fixed_camera(*campaign.sensor)) {
        campaign.nominal.world_from_base = detail::base_in_view(campaign);
    }
    if (robot.error_model == ErrorModel::Complete || robot.error_model == ErrorModel::Offsets) {
        campaign = make_of(map.require("robot"), "no irreducible model was found",
                           [&] { return make_irreducible(campaign, robot.error_model, stop); });
    }
    if (robot.error_model == ErrorModel::Full) {
        const Chain full = detail::full_model(robot.declared, robot.gravity);
        campaign =
            with_robot(campaign, sensor.is_in_base_frame ? without_errors_of_base(full) : full);
        campaign.spread = population.spread;
    }
    if (!robot.free.empty()) {
        campaign = with_listed_errors(campaign, robot.free);
    }
    read_model_error(map, "model_error", campaign.model_error);
    read_model_error(map, "model_error_orientation", campaign.model_error_orientation);
    if (const auto common = map.find("model_error_common")) {
        const double part = common->number();
        campaign.model_error_common = part;
        if (!(part >= 0 && part <= 1)) {
            throw common->error("is " + detail::quote(common->text()) + "; must be from 0 to 1");
        }
    }
    if (const auto spread = map.find("spread")) {
        campaign.spread = read_spread(*spread, campaign, !errors);
    }
    // What a lens or a board leaves over would be taken for the robot's: measured, 14 % worse.
    campaign.spread.is_open = !campaign.sensor->has_only_pixels();
    if (const auto sizes = map.find("sizes")) {
        if (!sizes->is_text("learned") && !sizes->is_text("stated")) {
            throw sizes->error("is " + detail::quote(sizes->text()) +
                               "; must be learned or stated");
        }
        campaign.spread.is_open = sizes->is_text("learned");
    }
    if (const auto prior = map.find("prior")) set_prior(file, prior->boolean(), stop);
    if (const auto planning = map.find("planning")) {
        file.planned_model =
            read_planned_model(*planning, errors ? ErrorModel::Stated : file.error_model);
    }
    if (const auto criterion = map.find("criterion")) file.criterion = read_criterion(*criterion);
    if (const auto seed = map.find("seed")) file.seed = seed->natural_number();
    if (const auto measurements = map.find("measurements")) {
        read_measurements_section(*measurements, file);
    }
    file.controller = ControllerJoints(campaign.robot);
    if (const auto section = map.find("controller")) {
        const auto [joints, maker] = detail::read_controller(*section, campaign.robot);
        file.controller = joints;
        file.controller_maker = maker;
    }
    if (const auto cell = map.find("cell")) {
        file.cell = read_cell(*cell, campaign.robot, *sensor.sensor, file.controller);
    }
    if (file.cell.speed.size() == 0) file.cell.speed = robot.speed;
    if (const auto record = map.find("record")) file.record = read_record(*record);
    return file;
}

}  // namespace

std::string_view error_model_name(ErrorModel model) { return detail::name_of(error_models, model); }

ErrorModel parse_error_model(const std::string& name) {
    if (name == "complete") return ErrorModel::Complete;
    if (const auto model = detail::find_named(error_models, name)) return *model;
    throw InputError("is " + detail::quote(name) + "; " +
                     detail::suggest(name, detail::words_of(error_models)));
}

void set_prior(CampaignFile& campaign, std::optional<bool> is_prior, const StopSignal& stop) {
    if (!is_prior) return;
    const bool is_dropped = campaign.spread.is_prior && !*is_prior;
    campaign.spread.is_prior = *is_prior;
    if (!is_dropped || campaign.error_model != ErrorModel::Full) return;
    static_cast<Campaign&>(campaign) = with_robot(campaign, irreducible_model(campaign, stop));
}

CampaignFile read_campaign(const std::string& path, const StopSignal& stop) {
    return parse_campaign(detail::read_file(path, most_bytes), path, stop);
}

std::vector<CampaignFile> read_campaign(const std::string& path,
                                        const std::vector<ErrorModel>& models) {
    const std::string content = detail::read_file(path, most_bytes);
    const CampaignFile stated = parse_campaign(content, path);  // says what is wrong with it
    std::vector<CampaignFile> files;
    for (const ErrorModel model : models) {
        files.push_back(parse(content, path, model, {}));
        if (model == stated.error_model || files.back().robot.parameter_count() > 0) continue;
        throw input_error_at({path},
                             fmt::format("has no errors to fit as {}, none is named in brackets; "
                                         "must be compared without that model",
                                         error_model_name(model)));
    }
    return files;
}

CampaignFile planned_campaign(const CampaignFile& campaign, std::optional<bool> prior,
                              const StopSignal& stop) {
    CampaignFile file = campaign;
    set_prior(file, prior, stop);
    if (!file.planned_model) return file;
    CampaignFile planned = parse(file.content, file.path, file.planned_model, stop);
    set_prior(planned, prior, stop);
    planned.fitted_pose_count = least_calibration_count(file, stop);
    return planned;
}

std::vector<OtherCampaign> richer_campaigns(const CampaignFile& campaign,
                                            std::optional<bool> prior) {
    std::vector<OtherCampaign> campaigns;
    const auto add = [&](ErrorModel model) {
        if (model <= campaign.error_model) return;
        try {
            CampaignFile other = parse(campaign.content, campaign.path, model, {});
            set_prior(other, prior);
            campaigns.push_back(
                {"errors: " + std::string(error_model_name(model)), std::move(other)});
        } catch (const InputError&) {  // not of this robot
        }
    };
    if (campaign.error_model == ErrorModel::Stated) add(ErrorModel::Complete);
    // Without a prior it has more errors than most poses tell apart.
    if (prior.value_or(true)) add(ErrorModel::Full);
    return campaigns;
}

CampaignFile parse_campaign(const std::string& content, const std::string& path,
                            const StopSignal& stop) {
    detail::check_file_kind(content, path, detail::FileKind::Campaign, "a campaign file (YAML)");
    return parse(content, path, std::nullopt, stop);
}

}  // namespace posewise::io
