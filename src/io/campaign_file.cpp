#include "posewise/io/campaign_file.hpp"

#include <algorithm>

#include "campaign_sections.hpp"
#include "posewise/io/atomic_file.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/model/complete_model.hpp"
#include "posewise/model/transforms.hpp"
#include "text.hpp"

namespace posewise::io {
namespace {

void read_base(const YamlValue& value, Campaign& campaign) {
    const YamlMap base(value, {"position_<length>", "rpy_<angle>", "known"});
    campaign.nominal.world_from_base = read_frame(base);
    campaign.has_nominal_base = true;
    const auto known = base.find("known");
    if (!known) return;
    const auto marks = read_known(*known, {"x", "y", "z", "rx", "ry", "rz"});
    std::copy(marks.begin(), marks.end(), campaign.base_is_known.begin());
}

ParameterSpread read_spread(const YamlValue& value, const Campaign& campaign) {
    const YamlMap map(value, {"length_<length>", "angle_<angle>", "gravity_<angle>",
                              "harmonic_<angle>", "parameters"});
    ParameterSpread spread;
    const auto read = [&map](std::string_view key, double& size) {
        if (const auto measure = map.find_measure(key)) size = read_positive(*measure);
    };
    read("length", spread.length);
    read("angle", spread.angle);
    read("gravity", spread.gravity);
    read("harmonic", spread.harmonic);
    const auto parameters = map.find("parameters");
    if (!parameters) return spread;
    const std::vector<std::string> names = parameter_names(campaign);
    const std::vector<bool> is_angle = parameter_is_angle(campaign);
    for (const YamlEntry& entry : parameters->entries()) {
        const auto found = std::find(names.begin(), names.end(), entry.key);
        if (found == names.end()) {
            throw input_error_at(entry.key_location, quote(entry.key) +
                                                         " is no parameter of this campaign; " +
                                                         suggest(entry.key, names));
        }
        const auto index = static_cast<std::size_t>(found - names.begin());
        const auto quantity = is_angle[index] ? Quantity::Angle : Quantity::Length;
        spread.by_name[entry.key] = read_amount(entry.value, quantity, Sign::Positive);
    }
    return spread;
}

double read_unit(const YamlMap& map, std::string_view key, Quantity quantity) {
    const auto value = map.find(key);
    if (!value) return 1;
    const Unit* const unit = find_unit(value->text());
    if (unit == nullptr || unit->quantity != quantity) {
        throw value->error("is " + quote(value->text()) + "; must be " +
                           list_words(unit_names(quantity)));
    }
    return unit->to_si(1);
}

MatMapping read_mat_mapping(const YamlValue& measurements, Index target_count) {
    const YamlValue value = YamlMap(measurements, {"mat"}).require("mat");
    const YamlMap map(value, {"joints", "points", "torques", "angle_unit", "length_unit"});
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

Criterion read_criterion(const YamlValue& value) {
    const std::string name = value.text();
    try {
        return parse_criterion(name);
    } catch (const InputError& problem) {
        throw input_error_at(value.location(), std::string("criterion: ") + problem.what());
    }
}

Campaign make_complete(const Campaign& campaign, const YamlValue& robot) {
    try {
        return with_robot(campaign, irreducible_model(campaign));
    } catch (const InputError& problem) {
        throw robot.error(std::string("has no irreducible model: ") + problem.what());
    }
}

constexpr const char* plausible_amount = "from 1e-12 to 1000 (m or rad)";

bool is_plausible_amount(double si) { return si >= 1e-12 && si <= 1e3; }

/// One line of text: it becomes the title of plots and a comment of other files.
std::string read_name(const YamlValue& value) {
    const std::string name = value.text();
    if (escape_controls(name) != name) {
        throw value.error("is " + quote(name) + "; must be one line without control characters");
    }
    return name;
}

}  // namespace

Isometry3d read_frame(const YamlMap& map) {
    Isometry3d frame = Isometry3d::Identity();
    frame.linear() = rotation_from_rpy(map.require_measure("rpy").vector_to_si());
    frame.translation() = map.require_measure("position").vector_to_si();
    return frame;
}

std::vector<bool> read_known(const YamlValue& known, const std::vector<std::string>& names) {
    if (!known.is_list()) return std::vector<bool>(names.size(), known.boolean());
    std::vector<bool> marks(names.size(), false);
    for (const YamlValue& item : known.list()) {
        const std::string name = item.text();
        const auto found = std::find(names.begin(), names.end(), name);
        if (found == names.end())
            throw item.error("is " + quote(name) + "; " + suggest(name, names));
        const auto k = static_cast<std::size_t>(found - names.begin());
        if (marks[k]) throw item.error("is " + quote(name) + " again; keep one");
        marks[k] = true;
    }
    return marks;
}

double read_positive(const YamlMeasure& measure, bool zero_allowed) {
    const double value = measure.to_si();
    const std::string stated = "is " + quote(measure.value.text());
    if (value < 0 || (value == 0 && !zero_allowed)) {
        throw measure.value.error(stated + "; must be " +
                                  (zero_allowed ? "zero or positive" : "positive"));
    }
    if (value != 0 && !is_plausible_amount(value)) {
        throw measure.value.error(stated + "; must be " + plausible_amount);
    }
    return value;
}

double read_amount(const YamlValue& value, Quantity quantity, Sign sign) {
    const std::string text = value.text();
    const auto blank = std::min(text.find_first_of(" \t"), text.size());
    const ParsedNumber number = parse_number(std::string_view(text).substr(0, blank));
    const Unit* const unit = find_unit(trim(std::string_view(text).substr(blank)));
    const bool is_sign_right = sign == Sign::Any || number.value > 0;
    if (!number.ok() || unit == nullptr || unit->quantity != quantity || !is_sign_right) {
        throw value.error("is " + quote(text) + "; must be a " +
                          (sign == Sign::Positive ? "positive " : "") + "number and a unit, " +
                          list_words(unit_names(quantity)));
    }
    const double si = unit->to_si(number.value);
    if (sign == Sign::Positive && !is_plausible_amount(si)) {
        throw value.error("is " + quote(text) + "; must be " + plausible_amount);
    }
    if (!is_plausible(si, quantity)) {
        throw value.error("is " + quote(text) + "; must be " + plausible(quantity));
    }
    return si;
}

CampaignFile read_campaign(const std::string& path) {
    return parse_campaign(read_file(path, 1 << 20), path);
}

CampaignFile parse_campaign(const std::string& content, const std::string& path) {
    const YamlMap map(
        parse_yaml(content, path),
        {"name", "robot", "sensor", "model_error_<length>", "model_error_orientation_<angle>",
         "base", "spread", "prior", "criterion", "seed", "measurements", "cell"});
    CampaignFile file;
    file.path = path;
    Campaign& campaign = file;
    campaign.name = read_name(map.require("name"));

    const RobotSection robot = read_robot(map.require("robot"));
    file.declared_robot = robot.declared;
    file.error_model = robot.error_model;
    file.urdf = robot.urdf;
    campaign.joint_repeatability = robot.joint_repeatability;
    const SensorSection sensor = read_sensor(map.require("sensor"));
    campaign.sensor = sensor.sensor;
    campaign.nominal.sensor = sensor.unknowns;
    campaign.has_nominal_targets = sensor.has_positions;
    if (const auto base = map.find("base")) read_base(*base, campaign);
    campaign = with_robot(campaign, robot.declared);
    if (robot.error_model == ErrorModel::Complete) {
        campaign = make_complete(campaign, map.require("robot"));
    }
    if (const auto error = map.find_measure("model_error")) {
        campaign.model_error = read_positive(*error, true);
    }
    if (const auto error = map.find_measure("model_error_orientation")) {
        campaign.model_error_orientation = read_positive(*error, true);
    }
    if (const auto spread = map.find("spread")) campaign.spread = read_spread(*spread, campaign);
    if (const auto prior = map.find("prior")) file.spread.is_prior = prior->boolean();
    if (const auto criterion = map.find("criterion")) file.criterion = read_criterion(*criterion);
    if (const auto seed = map.find("seed")) file.seed = seed->natural_number();
    if (const auto measurements = map.find("measurements")) {
        file.mat = read_mat_mapping(*measurements, sensor.sensor->target_count());
    }
    if (const auto cell = map.find("cell")) {
        file.cell = read_cell(*cell, campaign.robot, sensor.sensor->target_count());
    }
    if (file.cell.speed.size() == 0) file.cell.speed = robot.speed;
    return file;
}

}  // namespace posewise::io
