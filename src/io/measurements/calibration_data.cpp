#include "calibration_data.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <map>
#include <optional>

#include "core/text.hpp"
#include "io/format/text.hpp"
#include "io/format/yaml_reader.hpp"
#include "posewise/core/errors.hpp"
#include "sample_collector.hpp"

namespace posewise::detail {
namespace {

constexpr double not_seen = std::numeric_limits<double>::quiet_NaN();

/// What one sensor saw at one sample.
struct Features {
    std::string frame;
    std::vector<Vector3d> points;  ///< m; NaN: not seen
    FileLocation place;
};

struct Message {
    VectorXd joints;
    std::map<std::string, Features> by_sensor;
    FileLocation place;
};

/// Text between `---`, with the number of lines before it.
struct Document {
    std::string text;
    std::size_t lines_before = 0;
};

std::size_t indentation(std::string_view line) {
    return std::min(line.find_first_not_of(' '), line.size());
}

/// Parts the text, with empty lines in place of clouds, images and cameras, which may be millions
/// of numbers.
std::vector<Document> split(const std::string& content) {
    std::vector<Document> documents(1);
    constexpr std::size_t none = std::string::npos;
    std::size_t skipped_below = none;  // indentation of the key that is skipped
    std::size_t line_number = 0;
    for (std::size_t at = 0; at < content.size(); ++line_number) {
        const std::size_t end = std::min(content.find('\n', at), content.size());
        std::string_view line(content.data() + at, end - at);
        if (line.ends_with('\r')) line.remove_suffix(1);
        at = end + 1;
        const std::string_view words = trim(line);
        if (line.starts_with("---") && words == "---") {
            documents.push_back({"", line_number + 1});
            skipped_below = none;
            continue;
        }
        const bool is_skipped = skipped_below != none && indentation(line) > skipped_below;
        if (!is_skipped && !words.empty()) skipped_below = none;
        if (words == "cloud:" || words == "image:" || words == "ext_camera_info:") {
            skipped_below = indentation(line);
        }
        if (!is_skipped && skipped_below == none) documents.back().text += line;
        documents.back().text += '\n';
    }
    std::erase_if(documents, [](const Document& one) { return trim(one.text).empty(); });
    return documents;
}

double coordinate(const YamlValue& point, std::string_view axis) {
    const YamlValue value = require_of(point, axis, "which a point has");
    for (const std::string_view nan : {"nan", "NaN", ".nan", ".NaN", ".NAN"}) {
        if (value.is_text(nan)) return not_seen;
    }
    const double number = value.number();
    if (is_plausible(number, Quantity::Length)) return number;
    throw value.error("is out of any cell; must be in m");
}

class MessagesReader {
  public:
    MessagesReader(const std::string& path, const Campaign& table) : path_(path), table_(table) {}

    std::vector<Message> read(const std::string& content) {
        for (const Document& one : split(content)) {
            try {
                take(parse_yaml(one.text, path_));
            } catch (const InputError&) {
                // Once more where it stands, for the line in the message.
                take(parse_yaml(std::string(one.lines_before, '\n') + one.text, path_));
                throw;
            }
        }
        return std::move(messages_);
    }

  private:
    void take(const YamlValue& document) {
        std::vector<Message> read;
        if (document.is_list()) {
            for (const YamlValue& one : document.list()) read.push_back(read_message(one));
        } else {
            read.push_back(read_message(document));
        }
        std::ranges::move(read, std::back_inserter(messages_));
    }

    Message read_message(const YamlValue& value) const {
        const char* const why = "which a message CalibrationData has";
        Message message{read_joints(require_of(value, "joint_states", why)), {}, value.location()};
        for (const YamlValue& one : require_of(value, "observations", why).list()) {
            const YamlValue name = require_of(one, "sensor_name", "which an observation has");
            if (!message.by_sensor.emplace(name.text(), read_features(one)).second) {
                throw name.error("is " + quote(name.text()) + " twice in one message");
            }
        }
        return message;
    }

    VectorXd read_joints(const YamlValue& states) const {
        const char* const why = "which joint_states has";
        const std::vector<YamlValue> names = require_of(states, "name", why).list();
        const YamlValue positions = require_of(states, "position", why);
        const std::vector<YamlValue> values = positions.list();
        if (names.size() != values.size()) {
            throw positions.error(fmt::format("has {} for {}; must be one for each",
                                              count_of(std::ssize(values), "number"),
                                              count_of(std::ssize(names), "name")));
        }
        VectorXd q(table_.robot.joint_count());
        for (Index j = 0; j < q.size(); ++j) {
            const Joint& joint = table_.robot.joints()[static_cast<std::size_t>(j)];
            const auto found = std::ranges::find_if(
                names, [&](const YamlValue& name) { return name.is_text(joint.name); });
            if (found == names.end()) {
                throw states.error("has no joint " + quote(joint.name) +
                                   ", which the campaign's robot has");
            }
            const YamlValue& value = values[static_cast<std::size_t>(found - names.begin())];
            q[j] = value.number();
            const auto quantity =
                joint.motion == Motion::Rotation ? Quantity::Angle : Quantity::Length;
            if (!is_plausible(q[j], quantity)) throw value.error("is no joint value in rad or m");
        }
        return q;
    }

    static Features read_features(const YamlValue& observation) {
        const YamlValue features = require_of(observation, "features", "which an observation has");
        Features read{"", {}, features.location()};
        for (const YamlValue& one : features.list()) {
            const YamlValue point = require_of(one, "point", "which a feature has");
            read.points.emplace_back(coordinate(point, "x"), coordinate(point, "y"),
                                     coordinate(point, "z"));
            const auto header = find_of(one, "header");
            const auto frame = header ? find_of(*header, "frame_id") : std::nullopt;
            const std::string own = frame ? frame->text() : "";
            if (read.points.size() > 1 && own != read.frame) {
                throw one.error("is in the frame " + quote(own) + "; must be in " +
                                quote(read.frame) + " as the features before");
            }
            read.frame = own;
        }
        return read;
    }

    const std::string& path_;
    const Campaign& table_;
    std::vector<Message> messages_;
};

/// Whether the sensor states the same points always: those of a board that an arm holds, in its
/// own frame.
bool is_constant(const std::vector<Message>& messages, const std::string& sensor) {
    const std::vector<Vector3d>* first = nullptr;
    for (const Message& message : messages) {
        const auto found = message.by_sensor.find(sensor);
        if (found == message.by_sensor.end()) continue;
        if (first == nullptr) first = &found->second.points;
        if (*first != found->second.points) return false;
    }
    return true;
}

/// The observation to take, see read_calibration_data().
std::string find_sensor(const std::string& path, const std::vector<Message>& messages,
                        const std::string& stated) {
    std::map<std::string, bool> all;  // whether it moves
    for (const Message& message : messages) {
        for (const auto& [sensor, features] : message.by_sensor) {
            all[sensor] = all[sensor] || !features.points.empty();
        }
    }
    if (!stated.empty() && !all.contains(stated)) {
        std::vector<std::string> names;
        for (const auto& [sensor, has_points] : all) names.push_back(quote(sensor));
        throw input_error_at({path},
                             fmt::format("has no observation {}, which the campaign states; "
                                         "has {}",
                                         quote(stated), fmt::join(names, ", ")));
    }
    if (!stated.empty()) return stated;
    std::vector<std::string> moving;
    for (const auto& [sensor, has_points] : all) {
        if (has_points && !is_constant(messages, sensor)) moving.push_back(sensor);
    }
    if (moving.size() == 1) return moving.front();
    if (moving.empty()) {
        throw input_error_at({path},
                             "has no observation whose features move from one message to "
                             "another; must have those of one camera at least");
    }
    std::vector<std::string> quoted;
    for (const std::string& sensor : moving) quoted.push_back(quote(sensor));
    throw input_error_at(
        {path}, fmt::format("has observations by {}; must say which is measured with, such as "
                            "`measurements: {{observation: {}}}` in the campaign",
                            fmt::join(quoted, " and "), moving.front()));
}

}  // namespace

bool is_calibration_data(const std::string& content) {
    constexpr std::size_t enough = 1 << 16;
    constexpr std::string_view key = "joint_states";
    const std::string_view head = std::string_view(content).substr(0, enough);
    const std::size_t at = head.find(key);
    if (at == std::string_view::npos) return false;
    const std::size_t line = head.rfind('\n', at) + 1;  // 0 in the first line
    const std::string_view before = head.substr(line, at - line);
    const std::string_view after = trim(head.substr(at + key.size(), 3));
    return before.find_first_not_of(" \t-[{\"'") == std::string_view::npos &&
           (after.starts_with(':') || after.starts_with('"') || after.starts_with('\''));
}

io::MeasurementsFile read_calibration_data(const std::string& path, const std::string& content,
                                           const Campaign& table, const std::string& observation) {
    const Sensor& sensor = *table.sensor;
    if (!sensor.observes_targets() || !table.robot.torques().empty()) {
        throw input_error_at({path},
                             "holds messages CalibrationData of points, which are read where a "
                             "sensor of kind points measures them, and no torques");
    }
    const std::vector<Message> messages = MessagesReader(path, table).read(content);
    const std::string name = find_sensor(path, messages, observation);
    SampleCollector samples(table);
    Index without = 0;
    std::optional<std::string> frame;
    for (std::size_t k = 0; k < messages.size(); ++k) {
        const Message& message = messages[k];
        const auto found = message.by_sensor.find(name);
        if (found == message.by_sensor.end() || found->second.points.empty()) {
            ++without;
            continue;
        }
        const Features& features = found->second;
        if (std::ssize(features.points) != sensor.target_count()) {
            throw input_error_at(
                features.place,
                fmt::format("features of {} are {}; must be {}, as the sensor has targets",
                            quote(name), features.points.size(), sensor.target_count()));
        }
        if (frame.value_or(features.frame) != features.frame) {
            throw input_error_at(features.place,
                                 fmt::format("features of {} are in the frame {}; must be in {} as "
                                             "before, which does not move",
                                             quote(name), quote(features.frame), quote(*frame)));
        }
        frame = features.frame;
        Sample sample{std::to_string(k + 1), "", message.joints, VectorXd::Zero(sensor.row_count()),
                      SeenTargets::Constant(sensor.target_count(), false)};
        for (Index t = 0; t < sensor.target_count(); ++t) {
            const Vector3d& point = features.points[static_cast<std::size_t>(t)];
            if (!point.allFinite()) continue;
            sample.observation.segment<3>(3 * t) = point;
            sample.is_seen[t] = true;
        }
        if (!sample.is_seen.any()) {
            ++without;
            continue;
        }
        samples.add(sample, [&](Index) { return message.place; });
    }
    io::MeasurementsFile measured{samples.finish(path)};
    measured.joined = fmt::format("the observation {} is taken", quote(name));
    if (frame && !frame->empty()) measured.joined += ", in the frame " + quote(*frame);
    if (without > 0) {
        measured.joined += fmt::format("; {} of {} without it are left out", without,
                                       count_of(std::ssize(messages), "message"));
    }
    return measured;
}

}  // namespace posewise::detail
