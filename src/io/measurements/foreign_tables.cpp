#include "foreign_tables.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/text.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/text.hpp"
#include "io/format/units.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"
#include "sample_collector.hpp"

namespace posewise::detail {
namespace {

constexpr Index robodk_joints = 6;
constexpr std::size_t robodk_poses = 18;
constexpr std::size_t robodk_points = 12;
constexpr std::size_t matrix_size = 16;
constexpr double mm = 1e-3;

bool is_number(std::string_view field) {
    return parse_number(field).problem != std::string_view("is not a number");
}

/// Whether the columns before what RoboDK measured may be joints of a table without our column
/// config: a list of points has its name or coordinates there.
bool may_be_robodk_header(const std::vector<std::string_view>& titles) {
    if (titles.size() < robodk_joints || std::ranges::all_of(titles, is_number)) return false;
    for (std::size_t k = 0; k < titles.size(); ++k) {
        std::string title(titles[k]);
        std::ranges::transform(title, title.begin(), [](char c) {
            return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
        });
        if (title == "config" || title.starts_with("p1_") || title.starts_with("rx")) return false;
        if (k >= robodk_joints) continue;
        for (const std::string_view other : {"x", "y", "z", "name", "point", "target", "id"}) {
            if (title == other || split_unit(title).stem == other) return false;
        }
    }
    return true;
}

/// Whether six columns have the joints' names as RoboDK writes them, J1 to J6, which none of our
/// tables has without units.
bool has_robodk_joints(const std::vector<std::string_view>& titles) {
    for (Index k = 0; k < robodk_joints; ++k) {
        const auto field = static_cast<std::size_t>(k);
        if (field >= titles.size() || titles[field] != fmt::format("J{}", k + 1)) return false;
    }
    return true;
}

bool has_robodk_width(const CsvReader& csv) {
    const std::size_t count = csv.fields().size();
    return count == robodk_poses || count == robodk_points;
}

/// Orientations as columns may state them.
struct AngleReading {
    double scale;  ///< to rad
    bool is_xyz;   ///< Rx Ry Rz, else Rz Ry Rx
    const char* words;
};
constexpr std::array<AngleReading, 4> angle_readings{{
    {1, true, "rad, Rx Ry Rz"},
    {to_radians(1), true, "deg, Rx Ry Rz"},
    {1, false, "rad, Rz Ry Rx"},
    {to_radians(1), false, "deg, Rz Ry Rx"},
}};

Matrix3d rotation(const Vector3d& angles, const AngleReading& reading) {
    const Vector3d rad = reading.scale * angles;
    const Eigen::AngleAxisd x(rad.x(), Vector3d::UnitX());
    const Eigen::AngleAxisd y(rad.y(), Vector3d::UnitY());
    const Eigen::AngleAxisd z(rad.z(), Vector3d::UnitZ());
    return (reading.is_xyz ? x * y * z : z * y * x).toRotationMatrix();
}

/// A row of the file. Lengths and joints are in SI units, angles of RoboDK as they stand there.
struct Row {
    VectorXd joints;
    Vector3d position;
    Vector3d angles = Vector3d::Zero();
    Matrix3d orientation = Matrix3d::Identity();
    Vector3d tool = Vector3d::Zero();
    Vector3d tool_angles = Vector3d::Zero();
    FileLocation place;
};

class TableReader {
  public:
    TableReader(const std::string& path, std::string content, const io::CampaignFile& file,
                ForeignTable kind)
        : path_(path),
          file_(file),
          kind_(kind),
          joints_(file.robot.joint_count()),
          csv_(path, std::move(content), CsvStyle::Table),
          pose_(dynamic_cast<const PoseSensor*>(file.sensor.get())) {}

    io::MeasurementsFile read() {
        check_sensor();
        read_rows();
        if (pose_ != nullptr && kind_ == ForeignTable::RoboDk) find_orientations();
        return collect();
    }

  private:
    InputError error(const std::string& problem) const { return input_error_at({path_}, problem); }
    std::string name() const {
        return kind_ == ForeignTable::RoboDk ? "a table of RoboDK" : "a table of pybotics";
    }

    void check_sensor() const {
        const bool is_usable =
            pose_ != nullptr ? !records_inverse(*file_.sensor) : file_.sensor->observes_targets();
        if (is_usable && file_.robot.torques().empty()) return;
        throw error(
            "is " + name() +
            ", which is read where a sensor of kind points or poses measures the tool in "
            "its own frame, and no torques; else it must be a table with the column config");
    }

    void read_rows() {
        if (kind_ == ForeignTable::RoboDk) csv_.next_row();
        std::size_t width = 0;
        for (Index number = 1; csv_.next_row(); ++number) {
            const std::size_t count = csv_.fields().size();
            if (width == 0) check_width(count);
            if (width != 0 && count != width) {
                throw input_error_at(
                    csv_.locate(std::min(count, width)),
                    fmt::format("row has {} fields; must have {} as the first", count, width));
            }
            width = count;
            Row row = kind_ == ForeignTable::RoboDk ? read_robodk() : read_pybotics();
            // As RoboDK leaves what was not measured.
            if (kind_ == ForeignTable::RoboDk && row.position.lpNorm<1>() < 1e-3 * mm) {
                left_out_.push_back(std::to_string(number));
                continue;
            }
            check_tool(row);
            rows_.push_back(std::move(row));
            ids_.push_back(std::to_string(number));
        }
        if (rows_.empty()) throw error("is " + name() + " in which nothing was measured");
        check_unit();
    }

    /// Throws InputError where measured poses are of another tool than those before.
    void check_tool(const Row& row) const {
        if (pose_ == nullptr || rows_.empty()) return;
        constexpr double rounding = 1e-6;  // m or the file's unit of angles
        const Row& first = rows_.front();
        if ((row.tool - first.tool).norm() < rounding &&
            (row.tool_angles - first.tool_angles).norm() < rounding) {
            return;
        }
        throw input_error_at(row.place, "has another tool in its last columns than " +
                                            std::to_string(first.place.line) +
                                            ", the first line measured; must be one tool");
    }

    /// Throws InputError for positions that must be in m: taken as mm they are too near to the
    /// instrument.
    void check_unit() const {
        constexpr double nearest = 20 * mm;
        const double farthest = std::ranges::max(rows_, {}, [](const Row& row) {
                                    return row.position.norm();
                                }).position.norm();
        if (farthest > nearest) return;
        throw error(fmt::format(
            "is {} with all it measured within {:.3g} mm of the origin; is it in m? Must be in mm",
            name(), farthest / mm));
    }

    void check_width(std::size_t count) const {
        if (pose_ == nullptr || kind_ != ForeignTable::RoboDk || count == robodk_poses) return;
        throw error(
            "is a table of RoboDK with points only (12 columns), but the sensor of kind "
            "poses needs orientations (18 columns)");
    }

    double number(std::size_t field) const {
        const std::string_view text = csv_.fields()[field];
        const ParsedNumber number = parse_number(text);
        if (number.ok()) return number.value;
        throw input_error_at(csv_.locate(field),
                             fmt::format("{} {}; must be a finite number with a decimal point",
                                         quote(text), number.problem));
    }

    double length(std::size_t field) const {
        const double value = mm * number(field);
        if (is_plausible(value, Quantity::Length)) return value;
        throw input_error_at(csv_.locate(field),
                             fmt::format("{} is out of any cell; must be {}",
                                         quote(csv_.fields()[field]), plausible(*find_unit("mm"))));
    }

    Vector3d vector(std::size_t first) const {
        return {length(first), length(first + 1), length(first + 2)};
    }

    VectorXd read_joints() const {
        VectorXd q(joints_);
        for (Index j = 0; j < joints_; ++j) {
            const auto field = static_cast<std::size_t>(j);
            const bool is_angle = file_.robot.joints()[field].motion == Motion::Rotation;
            q[j] = is_angle ? to_radians(number(field)) : length(field);
            if (!is_angle || is_plausible(q[j], Quantity::Angle)) continue;
            throw input_error_at(csv_.locate(field),
                                 quote(csv_.fields()[field]) + " is no joint value in degrees");
        }
        return q;
    }

    Row read_robodk() const {
        Row row;
        row.joints = read_joints();
        row.position = vector(robodk_joints);
        const bool is_pose = csv_.fields().size() == robodk_poses;
        if (is_pose && pose_ != nullptr) row.angles = {number(9), number(10), number(11)};
        row.tool = vector(is_pose ? 12 : 9);
        if (is_pose) row.tool_angles = {number(15), number(16), number(17)};
        row.place = csv_.locate(0);
        return row;
    }

    Row read_pybotics() const {
        Row row;
        row.joints = read_joints();
        const auto first = static_cast<std::size_t>(joints_);
        for (std::size_t i = 0; i < 3; ++i) {
            const auto axis = static_cast<Index>(i);
            for (std::size_t k = 0; k < 3; ++k) {
                row.orientation(axis, static_cast<Index>(k)) = number(first + 4 * i + k);
            }
            row.position[axis] = length(first + 4 * i + 3);
        }
        row.place = csv_.locate(0);
        constexpr double tolerance = 1e-3;
        const bool is_frame = row.orientation.isUnitary(tolerance) &&
                              row.orientation.determinant() > 0 && number(first + 12) == 0 &&
                              number(first + 13) == 0 && number(first + 14) == 0 &&
                              number(first + 15) == 1;
        if (!is_frame) {
            throw input_error_at(
                csv_.locate(first),
                "the last 16 numbers are no pose; must be a 4 x 4 matrix by rows, "
                "of an orientation and a position in mm, whose last row is 0 0 0 1");
        }
        row.orientation = Eigen::Quaterniond(row.orientation).normalized().toRotationMatrix();
        return row;
    }

    VectorXd model_joints(const VectorXd& joints) const {
        return file_.has_controller_columns ? file_.controller.to_model(joints) : joints;
    }

    /// By how much the robot turns between two rows, less by how much it does by the measured
    /// angles, in the middle of all; rad. Neither base nor tool matters.
    double disagreement(const AngleReading& reading) const {
        std::vector<Matrix3d> flange;
        std::vector<Matrix3d> measured;
        for (const Row& row : rows_) {
            flange.push_back(
                world_from_flange(file_, file_.nominal, model_joints(row.joints)).linear());
            measured.push_back(rotation(row.angles, reading));
        }
        std::vector<double> differences;
        const auto compare = [&](std::size_t i, std::size_t k) {
            const auto turned = [&](const std::vector<Matrix3d>& all) {
                return Eigen::AngleAxisd(all[i] * all[k].transpose()).angle();
            };
            differences.push_back(std::abs(turned(flange) - turned(measured)));
        };
        for (std::size_t k = 1; k < rows_.size(); ++k) {
            compare(0, k);
            compare(k - 1, k);
        }
        const auto middle = differences.begin() + std::ssize(differences) / 2;
        std::ranges::nth_element(differences, middle);
        return *middle;
    }

    void find_orientations() {
        const double most = to_radians(2);  // more than any error of a robot's geometry
        const double apart = to_radians(0.5);
        if (rows_.size() < 3)
            throw error("has fewer than three poses; they do not tell its angles");
        std::vector<std::pair<double, const AngleReading*>> found;
        for (const AngleReading& reading : angle_readings) {
            found.emplace_back(disagreement(reading), &reading);
        }
        std::ranges::sort(found);
        const auto& [best, fitting] = found[0];
        if (best > most) {
            throw error(
                "its angles are neither those of Rx Ry Rz nor of Rz Ry Rx, in rad or deg, by which "
                "this robot turns with these joints; are they another robot's, or the controller's "
                "(`measurements: {columns: controller}`)?");
        }
        if (found[1].first < std::max(3 * best, apart)) {
            throw error(
                fmt::format("its poses fit angles in {} about as well as in {}; must turn "
                            "the tool more, or be a table with the column config",
                            fitting->words, found[1].second->words));
        }
        for (Row& row : rows_) row.orientation = rotation(row.angles, *fitting);
        notes_.push_back(
            fmt::format("its angles are taken in {}, as fits the robot", fitting->words));
    }

    /// Which target the sensor has at each row's tool.
    std::vector<Index> find_targets() const {
        std::vector<Vector3d> tools;
        std::vector<Index> of;
        constexpr double same = 1e-6;  // m
        for (const Row& row : rows_) {
            const auto found = std::ranges::find_if(
                tools, [&](const Vector3d& tool) { return (tool - row.tool).norm() < same; });
            of.push_back(found - tools.begin());
            if (found == tools.end()) tools.push_back(row.tool);
        }
        const Sensor& sensor = *file_.sensor;
        if (std::ssize(tools) != sensor.target_count()) {
            throw error(
                fmt::format("is {} with {}; must have as many as the sensor has targets, {}",
                            name(), count_of(std::ssize(tools), "tool"), sensor.target_count()));
        }
        if (tools.size() == 1) return of;
        std::vector<Index> target_of(tools.size());
        for (std::size_t t = 0; t < tools.size(); ++t) target_of[t] = place_of(tools[t], t);
        for (Index& target : of) target = target_of[static_cast<std::size_t>(target)];
        return of;
    }

    /// The target at a tool: where the campaign says where they are, the one there, by less than a
    /// third of how far apart they are; else in order.
    Index place_of(const Vector3d& tool, std::size_t number) const {
        if (!file_.has_nominal_targets) return static_cast<Index>(number);
        Index nearest = 0;
        const auto distance = [&](Index target) { return (place(target) - tool).norm(); };
        for (Index k = 1; k < file_.sensor->target_count(); ++k) {
            if (distance(k) < distance(nearest)) nearest = k;
        }
        double apart = std::numeric_limits<double>::infinity();
        for (Index k = 0; k < file_.sensor->target_count(); ++k) {
            if (k != nearest) apart = std::min(apart, (place(k) - place(nearest)).norm());
        }
        if (3 * distance(nearest) < apart) return nearest;
        throw error(
            fmt::format("has a tool at {:.6g}, {:.6g}, {:.6g} mm, near which the campaign "
                        "has no target",
                        tool.x() / mm, tool.y() / mm, tool.z() / mm));
    }
    Vector3d place(Index target) const {
        return file_.sensor->target_position(target, file_.nominal.sensor);
    }

    io::MeasurementsFile collect() {
        const std::vector<Index> targets =
            pose_ != nullptr ? std::vector<Index>(rows_.size(), 0) : find_targets();
        SampleCollector samples(file_);
        for (std::size_t k = 0; k < rows_.size(); ++k) {
            const Row& row = rows_[k];
            Sample sample{ids_[k], "", row.joints, VectorXd::Zero(file_.sensor->row_count()),
                          SeenTargets::Constant(file_.sensor->target_count(), false)};
            sample.observation.segment<3>(3 * targets[k]) = row.position;
            if (pose_ != nullptr) {
                sample.observation.tail<3>() = vector_from_rotation(row.orientation);
            }
            sample.is_seen[targets[k]] = true;
            samples.add(sample, [&](Index) { return row.place; });
        }
        io::MeasurementsFile measured{samples.finish(path_)};
        if (!left_out_.empty()) {
            const bool is_one = left_out_.size() == 1;
            notes_.push_back(fmt::format("row{} {} {} not measured, and left out",
                                         is_one ? "" : "s", fmt::join(left_out_, ", "),
                                         is_one ? "is" : "are"));
        }
        measured.joined = fmt::format("{}", fmt::join(notes_, "; "));
        return measured;
    }

    const std::string& path_;
    const io::CampaignFile& file_;
    ForeignTable kind_;
    Index joints_;
    CsvReader csv_;
    const PoseSensor* pose_;  ///< the sensor if it is one
    std::vector<Row> rows_;
    std::vector<std::string> ids_;
    std::vector<std::string> left_out_;
    std::vector<std::string> notes_;
};

}  // namespace

ForeignTable foreign_table(const std::string& path, const std::string& content,
                           const Campaign& campaign) {
    // Enough for two rows; what has longer lines is none.
    constexpr std::size_t enough = 1 << 16;
    std::string head = content.substr(0, enough);
    if (head.size() < content.size()) head.erase(head.rfind('\n') + 1);
    CsvReader csv(path, std::move(head), CsvStyle::Table);
    const auto next_row = [&] {
        try {
            return csv.next_row();
        } catch (const InputError&) {
            return false;  // no table of this form; who reads it says what is wrong
        }
    };
    if (!next_row()) return ForeignTable::None;
    const auto joints = static_cast<std::size_t>(campaign.robot.joint_count());
    const bool may_be_robodk = joints == robodk_joints;
    if (std::ranges::all_of(csv.fields(), is_number)) {
        if (csv.fields().size() == joints + matrix_size) return ForeignTable::Pybotics;
        if (!may_be_robodk || !has_robodk_width(csv)) return ForeignTable::None;
        throw input_error_at(
            csv.locate(0), fmt::format("{} numbers without a header; a table of RoboDK must begin "
                                       "with one, J1,J2,J3,J4,J5,J6,X,Y,Z,..., and another table "
                                       "with the column config",
                                       csv.fields().size()));
    }
    const bool is_named = has_robodk_joints(csv.fields());
    if (!may_be_robodk || !may_be_robodk_header(csv.fields()) || !next_row() ||
        !std::ranges::all_of(csv.fields(), is_number)) {
        return ForeignTable::None;
    }
    if (has_robodk_width(csv)) return ForeignTable::RoboDk;
    if (!is_named) return ForeignTable::None;
    throw input_error_at(csv.locate(0),
                         fmt::format("row has {} fields behind a header with J1 to J6; a table of "
                                     "RoboDK must have {} (points) or {} (poses)",
                                     csv.fields().size(), robodk_points, robodk_poses));
}

io::MeasurementsFile read_foreign_table(const std::string& path, std::string content,
                                        const io::CampaignFile& file, ForeignTable kind) {
    return TableReader(path, std::move(content), file, kind).read();
}

}  // namespace posewise::detail
