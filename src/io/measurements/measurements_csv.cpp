#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <unordered_set>

#include "corner_collector.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/text.hpp"
#include "io/format/units.hpp"
#include "measurement_columns.hpp"
#include "measurement_header.hpp"
#include "noted_conditions.hpp"
#include "planned_points.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "sample_collector.hpp"

namespace posewise::io {
namespace {

using detail::Column;
using detail::Content;
using detail::Role;

/// One row's values, in SI.
class RowReader {
  public:
    RowReader(const detail::CsvReader& csv, const Campaign& campaign, Content content,
              std::vector<Column> columns)
        : csv_(csv),
          campaign_(campaign),
          content_(content),
          columns_(std::move(columns)),
          contacts_(campaign.sensor->contact_names()),
          field_of_joint_(static_cast<std::size_t>(campaign.robot.configuration_size())),
          field_of_observation_(static_cast<std::size_t>(campaign.sensor->row_count())),
          corner_sensors_(detail::corner_sensors(*campaign.sensor)),
          corners_(campaign),
          is_each_row_one_(content == Content::Program &&
                           std::none_of(columns_.begin(), columns_.end(), [](const auto& column) {
                               return column.role == Role::Sample;
                           })) {
        for (std::size_t field = 0; field < columns_.size(); ++field) {
            const auto index = static_cast<std::size_t>(columns_[field].index);
            if (columns_[field].role == Role::Purpose) field_of_purpose_ = field;
            if (columns_[field].role == Role::Point) field_of_point_ = field;
            if (columns_[field].role == Role::Camera) field_of_camera_ = field;
            if (columns_[field].role == Role::Sensor) field_of_sensor_ = field;
            if (columns_[field].role == Role::Joint) field_of_joint_[index] = field;
            if (columns_[field].role == Role::Observation) field_of_observation_[index] = field;
            if (columns_[field].role == Role::Orientation) {
                orientation_fields_.resize(
                    detail::orientation_forms[columns_[field].form].stems.size());
                orientation_fields_[index] = field;
            }
        }
        if (!orientation_fields_.empty()) field_of_observation_.resize(3);
        row_.joints.resize(campaign.robot.configuration_size());
        row_.is_seen.setConstant(campaign.sensor->target_count(), true);
        if (content == Content::JointsAndObservations) {
            const Index beside = notation() == OrientationNotation::RollPitchYaw ? 3 : 0;
            row_.observation.setZero(campaign.sensor->row_count() + beside);
        }
    }

    void add_to(detail::SampleCollector& samples) {
        check_width();
        is_via_ = read_purpose() == detail::on_the_way;
        if (is_via_ && content_ != Content::Program) return;  // nothing is measured there
        row_.name.clear();
        for (std::size_t field = 0; field < columns_.size(); ++field) read_field(field);
        if (field_of_point_) {
            if (is_corner_seen()) corners_.add(read_corner());
            return;
        }
        if (content_ == Content::JointsAndObservations && contacts_.empty()) read_targets();
        check_new_sample();
        note_conditions();
        const auto locate = [this](Index joint) {
            return csv_.locate(field_of_joint_[static_cast<std::size_t>(joint)]);
        };
        samples.add(row_, locate, is_each_row_one_);
        if (field_of_purpose_ && is_each_row_one_) purposes_.emplace_back(read_purpose());
    }

    bool has(Role role) const {
        return std::ranges::find(columns_, role, &Column::role) != columns_.end();
    }
    OrientationNotation notation() const {
        if (orientation_fields_.empty()) return OrientationNotation::RotationVector;
        return detail::orientation_forms[columns_[orientation_fields_.front()].form].notation;
    }
    /// Corners that rows of their own hold, as samples.
    void add_corners_to(detail::SampleCollector& samples) const {
        if (field_of_point_) corners_.add_to(samples);
    }
    /// What the columns of times and temperatures hold.
    detail::NotedConditions conditions() const {
        return detail::mean_conditions(times_, temperatures_);
    }
    /// Of each row that is a configuration by itself, where the file says it.
    const std::vector<std::string>& purposes() const { return purposes_; }

  private:
    void check_width() const {
        const std::size_t count = csv_.fields().size();
        if (count == columns_.size()) return;
        throw input_error_at(
            csv_.locate(std::min(count, columns_.size())),
            fmt::format("row has {} fields; must have {} as the header{}", count, columns_.size(),
                        count > columns_.size() ? "; are there decimal commas?" : ""));
    }

    /// What the robot is sent there for; empty where the file does not say.
    std::string_view read_purpose() const {
        if (!field_of_purpose_) return "";
        const std::string_view text = csv_.fields()[*field_of_purpose_];
        if (text == detail::to_calibrate || text == detail::to_verify ||
            text == detail::on_the_way) {
            return text;
        }
        throw input_error_at(csv_.locate(*field_of_purpose_),
                             fmt::format("{} is {}; must be {}, {} or {}", detail::purpose_column,
                                         detail::quote(text), detail::to_calibrate,
                                         detail::to_verify, detail::on_the_way));
    }

    void read_field(std::size_t field) {
        const Column& column = columns_[field];
        const std::string_view text = csv_.fields()[field];
        switch (column.role) {
            case Role::Configuration:
                if (text.empty()) {
                    throw input_error_at(csv_.locate(field), "config is empty; must be an id");
                }
                row_.id = text;
                return;
            case Role::Sample:
                row_.name = text;
                return;
            case Role::VisibleTargets:
                // What was planned; what was measured tells by itself what was seen.
                if (content_ == Content::JointsAndObservations) return;
                if (is_via_) {
                    row_.is_seen.setConstant(true);
                } else {
                    read_visible(field);
                }
                return;
            case Role::Contact:
                if (!is_via_) read_contact(field);
                return;
            case Role::Joint:
                row_.joints[column.index] = read_number(field);
                if (column.unit->name == "rad") {
                    detail::check_not_degrees(campaign_.robot, column.index,
                                              row_.joints[column.index],
                                              [this, field] { return csv_.locate(field); });
                }
                return;
            case Role::Observation:
            case Role::Orientation:
                return;              // by read_targets()
            case Role::Purpose:      // by read_purpose()
            case Role::Time:         // by note_conditions()
            case Role::Temperature:  // likewise
            case Role::Point:        // by read_corner()
            case Role::Sensor:       // likewise
            case Role::Camera:       // likewise
            case Role::Unused:
                return;
        }
    }

    void note_conditions() {
        for (std::size_t field = 0; field < columns_.size(); ++field) {
            if (columns_[field].role == Role::Time) {
                times_.emplace_back(row_.id, csv_.fields()[field]);
            }
            if (columns_[field].role == Role::Temperature) {
                temperatures_.emplace_back(row_.id, csv_.fields()[field]);
            }
        }
    }

    /// In SI units, or as it is if its column has no unit.
    double read_number(std::size_t field) const {
        const std::string_view text = csv_.fields()[field];
        const detail::ParsedNumber number = detail::parse_number(text);
        if (!number.ok()) {
            throw input_error_at(csv_.locate(field),
                                 fmt::format("{} {}; must be a finite number with a decimal "
                                             "point",
                                             detail::quote(text), number.problem));
        }
        if (columns_[field].unit == nullptr) return number.value;
        const detail::Unit& unit = *columns_[field].unit;
        const double si = unit.to_si(number.value);
        constexpr double farthest = 100;  // m, of a pose
        if (columns_[field].is_ros && std::abs(si) > farthest) {
            const auto axis = static_cast<std::size_t>(columns_[field].index);
            throw input_error_at(
                csv_.locate(field),
                fmt::format("{0} is over {1:g} m, the unit of {2} where none is stated; call it "
                            "{2}_mm if it is in mm",
                            detail::quote(text), farthest, detail::ros_position[axis]));
        }
        if (!is_plausible(si, unit.quantity)) {
            throw input_error_at(csv_.locate(field),
                                 fmt::format("{} is out of any cell; must be {}",
                                             detail::quote(text), plausible(unit)));
        }
        return si;
    }

    /// "1 3": the targets with these numbers.
    void read_visible(std::size_t field) {
        const std::string_view text = csv_.fields()[field];
        row_.is_seen.setConstant(false);
        bool is_good = !text.empty();
        for (std::string_view rest = text; !rest.empty();) {
            const std::string_view word = rest.substr(0, rest.find(' '));
            rest = detail::trim(rest.substr(word.size()));
            const detail::ParsedNumber number = detail::parse_number(word);
            is_good = is_good && number.ok() && number.value >= 1 &&
                      number.value <= static_cast<double>(row_.is_seen.size()) &&
                      number.value == std::floor(number.value);
            if (is_good) row_.is_seen[static_cast<Index>(number.value) - 1] = true;
        }
        if (is_good) return;
        throw input_error_at(
            csv_.locate(field),
            fmt::format("{} is {}; must be numbers of targets from 1 to {}, separated by blanks",
                        detail::visible_targets, detail::quote(text), row_.is_seen.size()));
    }

    /// "s3": what the robot touches.
    void read_contact(std::size_t field) {
        const std::string name(csv_.fields()[field]);
        const auto found = std::find(contacts_.begin(), contacts_.end(), name);
        if (found == contacts_.end()) {
            throw input_error_at(csv_.locate(field),
                                 fmt::format("{} is {}; {}", detail::contact, detail::quote(name),
                                             detail::suggest(name, contacts_)));
        }
        row_.is_seen.setConstant(false);
        row_.is_seen[found - contacts_.begin()] = true;
    }

    void read_targets() {
        for (Index target = 0; target < row_.is_seen.size(); ++target) read_target(target);
        if (row_.is_seen.any()) return;
        throw input_error_at(csv_.locate(field_of_observation_.front()),
                             "the sample shows no target; must show one at least, or be left out");
    }

    /// Programs write nothing, or "nan", of what was not seen.
    static bool is_nothing(std::string_view text) {
        return text.empty() || (text.size() == 3 && (text[0] | 0x20) == 'n' &&
                                (text[1] | 0x20) == 'a' && (text[2] | 0x20) == 'n');
    }

    bool is_corner_seen() const {
        const auto is_empty = [&](std::size_t k) {
            return is_nothing(csv_.fields()[field_of_observation_[k]]);
        };
        return !(is_empty(0) && is_empty(1));
    }

    /// The cells of a target that was not seen are empty, all of them.
    void read_target(Index target) {
        const auto width = orientation_fields_.empty()
                               ? static_cast<std::size_t>(campaign_.sensor->rows_of(target))
                               : field_of_observation_.size();
        const auto first = static_cast<std::size_t>(campaign_.sensor->first_row(target));
        std::vector<std::size_t> fields(orientation_fields_);
        for (std::size_t k = first; k < first + width; ++k) {
            fields.push_back(field_of_observation_[k]);
        }
        const auto is_empty = [&](std::size_t field) { return is_nothing(csv_.fields()[field]); };
        row_.is_seen[target] = !std::all_of(fields.begin(), fields.end(), is_empty);
        if (!row_.is_seen[target]) return;
        const auto gap = std::find_if(fields.begin(), fields.end(), is_empty);
        if (gap != fields.end()) {
            throw input_error_at(
                csv_.locate(*gap),
                fmt::format("{} is {}, but not all cells of target {} are; must be a "
                            "number, or all empty if it was not seen",
                            name_of(*gap), csv_.fields()[*gap].empty() ? "empty" : "not a number",
                            target + 1));
        }
        for (std::size_t k = first; k < first + width; ++k) {
            row_.observation[static_cast<Index>(k)] = read_number(field_of_observation_[k]);
            check_distance(k);
        }
        const auto [camera, number] = camera_of(target);
        if (camera != nullptr) {
            check_in_image(row_.observation.segment<2>(static_cast<Index>(first)),
                           camera->camera(number), first);
        }
        if (!orientation_fields_.empty()) row_.observation.segment<3>(3) = read_orientation();
    }

    /// A whole number from `first` to `last` in a column.
    Index read_count(std::string_view name, std::size_t field, Index first, Index last,
                     const char* of_what, const char* at_zero) const {
        const detail::ParsedNumber number = detail::parse_number(csv_.fields()[field]);
        if (number.ok() && number.value >= static_cast<double>(first) &&
            number.value <= static_cast<double>(last) && number.value == std::floor(number.value)) {
            return static_cast<Index>(number.value);
        }
        throw input_error_at(
            csv_.locate(field),
            fmt::format("{} is {}; must be the number of {}, {} to {}{}", name,
                        detail::quote(csv_.fields()[field]), of_what, first, last,
                        number.ok() && number.value == 0 && first == 1 ? at_zero : ""));
    }

    /// The sensor that sees a target, if it is a camera, and the number of its camera.
    std::pair<const CameraSensor*, Index> camera_of(Index target) const {
        const detail::CornerSensor& of =
            corner_sensors_[detail::sensor_of(corner_sensors_, target)];
        const auto* const camera = dynamic_cast<const CameraSensor*>(of.sensor);
        const Index own = target - of.first_target;
        return {camera, camera == nullptr ? 0 : own / camera->corner_count()};
    }

    /// The camera of the row at hand, counted from 0.
    Index read_camera(const detail::CornerSensor& of) const {
        if (!field_of_camera_) return 0;
        return read_count(detail::camera_column, *field_of_camera_, 1, of.cameras(),
                          of.cameras() == 1 ? "the campaign's only camera (key "
                                              "sensor.other_cameras states more)"
                                            : "a camera",
                          " (cameras count from 1)") -
               1;
    }

    /// The sensor of the row at hand.
    const detail::CornerSensor& read_sensor() const {
        if (!field_of_sensor_) return corner_sensors_.front();
        const Index number =
            read_count(detail::sensor_column, *field_of_sensor_, 1, std::ssize(corner_sensors_),
                       "one of the campaign's sensors", " (sensors count from 1)");
        return corner_sensors_[static_cast<std::size_t>(number - 1)];
    }

    detail::Corner read_corner() {
        const detail::CornerSensor& of = read_sensor();
        const Index camera = read_camera(of);
        const Index first = first_corner(*of.sensor);
        const Index number = read_count(detail::point_column, *field_of_point_, first,
                                        first + of.corners() - 1, "a corner of the board",
                                        " (board.first_point: 0 in the campaign counts from 0)");
        const Index target = of.first_target + camera * of.corners() + number - first;
        detail::Corner corner{row_.id, row_.name, row_.joints, target, {}, {}};
        corner.place =
            Vector2d{read_number(field_of_observation_[0]), read_number(field_of_observation_[1])};
        check_in_image(corner.place, camera_of(target).first->camera(camera), 0);
        for (const std::size_t joint : field_of_joint_)
            corner.locations.push_back(csv_.locate(joint));
        return corner;
    }

    /// To a pixel, or as far as its noise takes a corner. `first`: the field's index among the
    /// observed numbers.
    void check_in_image(const Vector2d& place, const SingleCamera& camera,
                        std::size_t first) const {
        if (!camera.image) return;
        const auto& image = camera.image;
        const Vector2d px = 1e3 * place;
        const double margin = std::max(1.0, 5 * camera.sigma);
        const auto is_inside = [&](double value, double size) {
            return value >= -margin && value <= size + margin;
        };
        for (Index axis = 0; axis < 2; ++axis) {
            if (is_inside(px[axis], (*image)[axis])) continue;
            const bool fits_swapped = is_inside(px[0], image->y()) && is_inside(px[1], image->x());
            throw input_error_at(
                csv_.locate(field_of_observation_[first + static_cast<std::size_t>(axis)]),
                fmt::format("{} is {:g} px, outside of the image; must be from 0 to {:g}{}",
                            axis == 0 ? "u" : "v", px[axis], (*image)[axis],
                            fits_swapped ? " (are u and v swapped?)" : ""));
        }
    }

    /// No target is at its anchor, or behind it.
    void check_distance(std::size_t k) const {
        const auto row = static_cast<Index>(k);
        if (!campaign_.sensor->is_distance(row) || row_.observation[row] > 0) return;
        const std::size_t field = field_of_observation_[k];
        throw input_error_at(csv_.locate(field),
                             fmt::format("{} is {}; must be a distance above 0", name_of(field),
                                         detail::quote(csv_.fields()[field])));
    }

    /// The name of an observation's column, without unit.
    std::string name_of(std::size_t field) const {
        const Column& column = columns_[field];
        const auto index = static_cast<std::size_t>(column.index);
        return column.role == Role::Orientation
                   ? detail::orientation_forms[column.form].stems[index]
                   : campaign_.sensor->observation_names()[index];
    }

    /// The rotation vector of an orientation in another form.
    Vector3d read_orientation() {
        VectorXd values(static_cast<Index>(orientation_fields_.size()));
        for (Index k = 0; k < values.size(); ++k) {
            values[k] = read_number(orientation_fields_[static_cast<std::size_t>(k)]);
        }
        if (values.size() == 3) {
            check_turns(values);
            row_.observation.tail<3>() = values;
            return vector_from_rotation(rotation_from_rpy(values));
        }
        constexpr double tolerance = 1e-3;
        const Eigen::Quaterniond q(values[0], values[1], values[2], values[3]);
        if (!(std::abs(q.norm() - 1) <= tolerance)) {
            throw input_error_at(
                csv_.locate(orientation_fields_.front()),
                fmt::format("the quaternion has length {:g}; must be 1 within 0.001", q.norm()));
        }
        return vector_from_rotation(q.normalized().toRotationMatrix());
    }

    /// Roll, pitch and yaw of degrees under rad turn round and round.
    void check_turns(const Vector3d& rpy) const {
        constexpr double impossible = 4 * std::numbers::pi;
        Index k = 0;
        if (rpy.cwiseAbs().maxCoeff(&k) <= impossible) return;
        const std::size_t field = orientation_fields_[static_cast<std::size_t>(k)];
        throw input_error_at(csv_.locate(field),
                             fmt::format("{} is {:g} rad, more than two turns, and looks like "
                                         "degrees; state degrees as such",
                                         name_of(field), rpy[k]));
    }

    /// The same sample of the same configuration twice is a file joined with itself.
    void check_new_sample() {
        if (row_.name.empty() || seen_.insert(row_.id + '\n' + row_.name).second) return;
        throw input_error_at(csv_.locate(0),
                             fmt::format("sample {} of configuration {} occurs twice; keep one",
                                         detail::quote(row_.name), detail::quote(row_.id)));
    }

    const detail::CsvReader& csv_;
    const Campaign& campaign_;
    Content content_;
    std::vector<Column> columns_;
    std::vector<std::string> contacts_;
    std::vector<std::size_t> field_of_joint_;
    std::vector<std::size_t> field_of_observation_;
    std::optional<std::size_t> field_of_purpose_;
    std::optional<std::size_t> field_of_point_;
    std::optional<std::size_t> field_of_camera_;
    std::optional<std::size_t> field_of_sensor_;
    std::vector<detail::CornerSensor> corner_sensors_;
    detail::CornerCollector corners_;
    bool is_via_ = false;  ///< the row at hand
    std::vector<std::string> purposes_;
    bool is_each_row_one_;                         ///< a configuration by itself
    std::vector<std::size_t> orientation_fields_;  ///< if it is not a rotation vector
    std::unordered_set<std::string> seen_;
    detail::Notes times_;
    detail::Notes temperatures_;
    detail::Sample row_;
};

struct ReadFile {
    MeasurementsFile samples;
    std::vector<std::string> purposes;
    bool is_corrected = false;
};

ReadFile read_csv(detail::CsvReader csv, const std::string& path, const Campaign& campaign,
                  Content content) {
    if (!csv.next_row()) {
        throw input_error_at({path}, std::string("is empty; must begin with a header like ") +
                                         (content == Content::JointsAndObservations
                                              ? "config,sample,q1_rad,...,p1_x_mm,..."
                                              : "config,q1_rad,..."));
    }
    detail::Header header = read_header(csv, campaign, content);
    const bool is_corrected = std::ranges::any_of(
        csv.fields(), [](std::string_view name) { return name.starts_with("uncorrected_m"); });
    RowReader row(csv, campaign, content, std::move(header.columns));
    detail::SampleCollector samples(campaign);
    while (csv.next_row()) row.add_to(samples);
    row.add_corners_to(samples);
    MeasurementsFile measurements{samples.finish(path), std::move(header.unused)};
    measurements.notation = row.notation();
    detail::keep_conditions(row.conditions(), row.has(Role::Time), row.has(Role::Temperature),
                            measurements);
    if (measurements.notation == OrientationNotation::RollPitchYaw &&
        measurements.observations.cols() > 0) {
        measurements.roll_pitch_yaw = measurements.observations.rightCols(3);
        measurements.observations.conservativeResize(Eigen::NoChange, campaign.sensor->row_count());
    }
    if (content == Content::JointsAndObservations && records_inverse(*campaign.sensor)) {
        invert_poses(measurements.observations);
    }
    return {std::move(measurements), row.purposes(), is_corrected};
}

Configurations read_unmeasured(const std::string& path, const Campaign& campaign, Content content) {
    auto [read, purposes, is_corrected] =
        read_csv(detail::CsvReader(path), path, campaign, content);
    const RowMatrixXd visible = times_seen(read);
    return {std::move(read.ids), std::move(read.configurations), visible.array() > 0,
            std::move(purposes), is_corrected};
}

}  // namespace

MeasurementsFile read_measurements_csv(const std::string& path, const Campaign& campaign) {
    return read_csv(detail::CsvReader(path), path, campaign, Content::JointsAndObservations)
        .samples;
}

Configurations read_configurations_csv(const std::string& path, const Campaign& campaign) {
    return read_unmeasured(path, campaign, Content::JointsAndVisibleTargets);
}

Configurations read_program_csv(const std::string& path, const Campaign& campaign) {
    return read_unmeasured(path, campaign, Content::Program);
}

}  // namespace posewise::io

namespace posewise::detail {

io::MeasurementsFile read_measurements_table(const std::string& path, std::string content,
                                             const Campaign& campaign) {
    return io::read_csv(CsvReader(path, std::move(content), CsvStyle::Table), path, campaign,
                        Content::JointsAndObservations)
        .samples;
}

}  // namespace posewise::detail
