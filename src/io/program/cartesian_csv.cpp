#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <optional>

#include "core/text.hpp"
#include "io/format/csv_reader.hpp"
#include "io/format/text.hpp"
#include "io/format/units.hpp"
#include "posewise/io/robot_programs.hpp"

// Tables of Cartesian targets.

namespace posewise::io {
namespace {

using detail::quote;

/// Ways to state an orientation.
const std::array<std::vector<std::string_view>, 3> orientations{
    {{"rx", "ry", "rz"}, {"roll", "pitch", "yaw"}, {"qw", "qx", "qy", "qz"}}};

constexpr std::size_t quaternion = 2;  // of these

class CartesianReader {
  public:
    CartesianReader(const std::string& path, const CampaignFile& campaign)
        : csv_(path), path_(path), campaign_(campaign) {
        for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
            joints_.push_back(campaign.has_controller_columns
                                  ? campaign.controller.names()[static_cast<std::size_t>(j)]
                                  : campaign.robot.joint(j).name);
        }
    }

    std::vector<CartesianTarget> read() {
        if (!csv_.next_row()) {
            throw input_error_at({path_}, "is empty; must begin with a header like " + example());
        }
        read_header();
        std::vector<CartesianTarget> targets;
        while (csv_.next_row()) targets.push_back(read_row());
        if (targets.empty()) throw input_error_at({path_}, "has no target; must have one");
        return targets;
    }

  private:
    struct Column {
        std::string stem;
        const detail::Unit* unit = nullptr;
    };

    static std::string example() { return "config,x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg"; }

    std::optional<std::size_t> find(std::string_view stem) const {
        const auto found = std::ranges::find(columns_, stem, &Column::stem);
        if (found == columns_.end()) return std::nullopt;
        return static_cast<std::size_t>(found - columns_.begin());
    }

    InputError header_error(std::size_t field, const std::string& problem) const {
        return input_error_at(csv_.locate(field),
                              fmt::format("column {} {}", quote(csv_.fields()[field]), problem));
    }

    /// What a column of that stem holds; nothing: it has no unit.
    std::optional<detail::Quantity> quantity_of(const std::string& stem) const {
        if (stem == "x" || stem == "y" || stem == "z") return detail::Quantity::Length;
        const auto joint = std::ranges::find(joints_, stem);
        if (joint != joints_.end()) {
            return detail::quantity_of(campaign_.controller.motion(joint - joints_.begin()));
        }
        return stem[0] == 'q' ? std::nullopt : std::optional(detail::Quantity::Angle);
    }

    bool is_known(const std::string& stem) const {
        const auto has = [&](const auto& names) {
            return std::ranges::find(names, stem) != names.end();
        };
        return has(std::array<std::string_view, 4>{"config", "x", "y", "z"}) ||
               std::ranges::any_of(orientations, has) || has(joints_);
    }

    void read_header() {
        for (std::size_t field = 0; field < csv_.fields().size(); ++field) {
            const std::string_view name = csv_.fields()[field];
            detail::NameWithUnit with_unit = detail::split_unit(name);
            Column column{std::string(with_unit.stem), with_unit.unit};
            if (!is_known(column.stem)) {
                throw header_error(field, "is unknown; must be one as in " + example() +
                                              ", or a joint near which the target is meant");
            }
            if (find(column.stem)) throw header_error(field, "occurs twice; keep one");
            if (column.stem != "config") {
                const auto quantity = quantity_of(column.stem);
                const bool is_right = quantity ? column.unit && column.unit->quantity == *quantity
                                               : column.unit == nullptr;
                if (!is_right) throw header_error(field, "has the wrong unit, or none");
            }
            columns_.push_back(column);
        }
        for (const char* const name : {"config", "x", "y", "z"}) {
            if (find(name)) continue;
            throw input_error_at(
                csv_.locate(csv_.fields().size()),
                fmt::format("missing column {}; the header must be like {}", name, example()));
        }
        find_orientation();
        const auto stated = std::ranges::count_if(
            joints_, [&](const std::string& name) { return find(name).has_value(); });
        if (stated != 0 && stated != std::ssize(joints_)) {
            throw input_error_at(csv_.locate(0),
                                 fmt::format("has columns of {} joints; must have all {}, or none",
                                             stated, joints_.size()));
        }
        has_joints_ = stated != 0;
    }

    void find_orientation() {
        std::size_t found = 0;
        std::ptrdiff_t columns = 0;
        for (std::size_t form = 0; form < orientations.size(); ++form) {
            const auto count = std::ranges::count_if(
                orientations[form], [&](std::string_view name) { return find(name).has_value(); });
            columns += count;
            if (count != std::ssize(orientations[form])) continue;
            orientation_ = form;
            ++found;
        }
        if (found == 1 && columns == std::ssize(orientations[orientation_])) return;
        throw input_error_at(csv_.locate(0),
                             "must state the orientation once: rx, ry, rz (a rotation vector) or "
                             "roll, pitch, yaw with _deg or _rad, or qw, qx, qy, qz");
    }

    double number(std::string_view stem) const {
        const std::size_t field = *find(stem);
        const std::string_view text = csv_.fields()[field];
        const detail::ParsedNumber number = detail::parse_number(text);
        if (!number.ok()) {
            throw input_error_at(csv_.locate(field),
                                 fmt::format("{} {}; must be a finite number with a decimal point",
                                             quote(text), number.problem));
        }
        const detail::Unit* const unit = columns_[field].unit;
        if (unit == nullptr) return number.value;
        const double si = unit->to_si(number.value);
        if (!is_plausible(si, unit->quantity)) {
            throw input_error_at(
                csv_.locate(field),
                fmt::format("{} is out of any cell; must be {}", quote(text), plausible(*unit)));
        }
        return si;
    }

    Matrix3d read_orientation() const {
        std::vector<double> n;
        for (const std::string_view stem : orientations[orientation_]) n.push_back(number(stem));
        if (orientation_ != quaternion) {
            const Vector3d angles(n[0], n[1], n[2]);
            return orientation_ == 0 ? rotation_from_vector(angles) : rotation_from_rpy(angles);
        }
        const Eigen::Quaterniond q(n[0], n[1], n[2], n[3]);
        constexpr double tolerance = 1e-3;
        if (!(std::abs(q.norm() - 1) <= tolerance)) {
            throw input_error_at(
                csv_.locate(*find("qw")),
                fmt::format("the quaternion has length {:g}; must be 1 within 0.001", q.norm()));
        }
        return q.normalized().toRotationMatrix();
    }

    CartesianTarget read_row() const {
        if (csv_.fields().size() != columns_.size()) {
            throw input_error_at(csv_.locate(0),
                                 fmt::format("row has {} fields; must have {} as the header",
                                             csv_.fields().size(), columns_.size()));
        }
        CartesianTarget target;
        target.id = csv_.fields()[*find("config")];
        if (target.id.empty()) {
            throw input_error_at(csv_.locate(*find("config")), "config is empty; must be an id");
        }
        target.frame_from_tool.translation() = Vector3d{number("x"), number("y"), number("z")};
        target.frame_from_tool.linear() = read_orientation();
        if (!has_joints_) return target;
        target.seed.resize(std::ssize(joints_));
        for (std::size_t j = 0; j < joints_.size(); ++j) {
            target.seed[static_cast<Index>(j)] = number(joints_[j]);
        }
        if (campaign_.has_controller_columns) {
            target.seed = campaign_.controller.to_model(target.seed);
        }
        return target;
    }

    detail::CsvReader csv_;
    const std::string& path_;
    const CampaignFile& campaign_;
    std::vector<std::string> joints_;
    std::vector<Column> columns_;
    std::size_t orientation_ = 0;
    bool has_joints_ = false;
};

}  // namespace

std::vector<CartesianTarget> read_cartesian_targets(const std::string& path,
                                                    const CampaignFile& campaign) {
    return CartesianReader(path, campaign).read();
}

}  // namespace posewise::io
