#include "reading_change.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/format.hpp"
#include "length_units.hpp"
#include "measurement/camera_model.hpp"
#include "posewise/core/types.hpp"
#include "posewise/measurement/camera_sensor.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {
namespace {

using Kind = ReadingChange::Kind;

bool turns(const Campaign& campaign, Index joint) {
    return campaign.robot.joint(joint).motion == Motion::Rotation;
}

const std::string& name_of(const Campaign& campaign, Index joint) {
    return campaign.robot.joints()[static_cast<std::size_t>(joint)].name;
}

// ---- Reading otherwise ----

void change_joints(const ReadingChange& change, const Campaign& campaign, RowMatrixXd& q) {
    switch (change.kind) {
        case Kind::Reversed:
            q.col(change.joint) *= -1;
            return;
        case Kind::Exchanged:
            q.col(change.joint).swap(q.col(change.other));
            return;
        case Kind::Coupled:
            q.col(change.joint) =
                change.factor * q.col(change.joint) + change.other_factor * q.col(change.other);
            return;
        case Kind::JointFactor:
            for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
                const bool is_meant = change.joint < 0 ? turns(campaign, j) : j == change.joint;
                if (is_meant) q.col(j) *= change.factor;
            }
            return;
        case Kind::Zero:
            q.col(change.joint).array() += change.factor;
            return;
        default:
            return;
    }
}

void change_lengths(const ReadingChange& change, const Sensor& sensor, RowMatrixXd& observations) {
    const Index width = sensor.rows_per_target();
    for (Index row = 0; row < observations.cols(); ++row) {
        const bool is_meant = change.joint < 0 || row / width == change.joint;
        if (is_meant && !sensor.is_angle(row)) observations.col(row) *= change.factor;
    }
}

void mirror(const Sensor& sensor, RowMatrixXd& observations) {
    const Index width = sensor.rows_per_target();
    for (Index z = 2; z < observations.cols(); z += width) observations.col(z) *= -1;
    if (sensor.has_orientation()) observations.middleCols(observations.cols() - 3, 2) *= -1;
}

/// Which column is meant by x, y and z.
constexpr std::array<std::array<Index, 3>, 6> orders{
    {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}}};

bool is_axis_reversed(const ReadingChange& change, Index axis) {
    return (change.other >> axis & 1) != 0;
}

Index column_of_axis(const ReadingChange& change, Index axis) {
    return orders[static_cast<std::size_t>(change.joint)][static_cast<std::size_t>(axis)];
}

void change_axes(const ReadingChange& change, RowMatrixXd& observations) {
    const RowMatrixXd read = observations.leftCols(3);
    for (Index axis = 0; axis < 3; ++axis) {
        const double sign = is_axis_reversed(change, axis) ? -1 : 1;
        observations.col(axis) = sign * read.col(column_of_axis(change, axis));
    }
}

bool are_exchanged(const ReadingChange& change) { return (change.other & 1) != 0; }
bool is_reversed(const ReadingChange& change, Index axis) {
    return (change.other & (axis == 0 ? 2 : 4)) != 0;
}

/// In an image of the size that the campaign states, else of twice the principal point.
void change_image(const ReadingChange& change, const Sensor& sensor, RowMatrixXd& observations) {
    const auto* const camera = dynamic_cast<const CameraSensor*>(&sensor);
    if (camera == nullptr) return;
    const Intrinsics& stated = camera->setup().intrinsics;
    const Vector2d size =
        kpx_per_px * camera->setup().image.value_or(2 * Vector2d(stated.cx, stated.cy));
    for (Index u = 0; u < observations.cols(); u += 2) {
        if (are_exchanged(change)) observations.col(u).swap(observations.col(u + 1));
        for (Index axis = 0; axis < 2; ++axis) {
            if (!is_reversed(change, axis)) continue;
            observations.col(u + axis) = size[axis] - observations.col(u + axis).array();
        }
    }
}

void change_orientations(const OrientationSense& sense, Measurements& measurements) {
    const bool has_rpy = measurements.roll_pitch_yaw.rows() > 0;
    for (Index k = 0; k < measurements.observations.rows(); ++k) {
        auto rotation = measurements.observations.row(k).tail<3>();
        Vector3d read = rotation.transpose();
        if (has_rpy) read = measurements.roll_pitch_yaw.row(k).transpose();
        rotation = vector_from_rotation(sense.meant(read)).transpose();
    }
}

// ---- Words ----

/// "y, x, -z".
std::string axes(const ReadingChange& change) {
    std::string text;
    for (Index axis = 0; axis < 3; ++axis) {
        text +=
            fmt::format("{}{}{}", axis == 0 ? "" : ", ", is_axis_reversed(change, axis) ? "-" : "",
                        "xyz"[column_of_axis(change, axis)]);
    }
    return text;
}

/// "v, width - u": what is meant by u, v.
std::string image_axes(const ReadingChange& change) {
    std::string text;
    for (Index axis = 0; axis < 2; ++axis) {
        const Index column = are_exchanged(change) ? 1 - axis : axis;
        text += fmt::format("{}{}{}", axis == 0 ? "" : ", ",
                            !is_reversed(change, axis) ? ""
                            : axis == 0                ? "width - "
                                                       : "height - ",
                            "uv"[column]);
    }
    return text;
}

/// "j3 - j2", "-j3 + j2".
std::string coupled(const ReadingChange& change, const Campaign& campaign) {
    return fmt::format("{}{} {} {}", change.factor < 0 ? "-" : "", name_of(campaign, change.joint),
                       change.other_factor < 0 ? "-" : "+", name_of(campaign, change.other));
}

/// "q2 + 90 deg".
std::string shifted(const ReadingChange& change, const Campaign& campaign) {
    return fmt::format("{} {} {} deg", name_of(campaign, change.joint),
                       change.factor < 0 ? "-" : "+",
                       format_short(to_degrees(std::abs(change.factor)), 3));
}

struct JointUnits {
    const char* meant;
    const char* read;
    const char* suffix;
};

/// The unit that a factor of joint values would mend.
JointUnits joint_units(const ReadingChange& change, const Campaign& campaign) {
    const bool is_larger = change.factor > 1;
    if (change.joint >= 0 && !turns(campaign, change.joint)) {
        return is_larger ? JointUnits{"m", "mm", "_m"} : JointUnits{"mm", "m", "_mm"};
    }
    return is_larger ? JointUnits{"rad", "degrees", "_rad"} : JointUnits{"degrees", "rad", "_deg"};
}

std::string describe_one(const ReadingChange& change, const Campaign& campaign,
                         OrientationNotation notation) {
    switch (change.kind) {
        case Kind::Reversed:
            break;  // all together
        case Kind::Exchanged:
            return fmt::format("{} and {} exchanged", name_of(campaign, change.joint),
                               name_of(campaign, change.other));
        case Kind::Coupled:
            return fmt::format("{} in place of {}", coupled(change, campaign),
                               name_of(campaign, change.joint));
        case Kind::JointFactor: {
            const JointUnits units = joint_units(change, campaign);
            return fmt::format("{} in {} where the file says {}",
                               change.joint < 0 ? "joint values" : name_of(campaign, change.joint),
                               units.meant, units.read);
        }
        case Kind::Zero:
            return fmt::format("{} in place of {}", shifted(change, campaign),
                               name_of(campaign, change.joint));
        case Kind::LengthFactor: {
            const LengthUnitMistake& mistake = mistake_of(change.factor);
            const std::string what = change.joint < 0 ? campaign.sensor->words().readings
                                                      : fmt::format("target {}", change.joint + 1);
            return fmt::format("{} in {} where the file says {}", what, mistake.meant,
                               mistake.read);
        }
        case Kind::LeftHanded:
            return "the instrument's frame left-handed";
        case Kind::Inverted:
            return "each pose inverted";
        case Kind::Axes:
            return axes(change) + " in place of x, y, z";
        case Kind::Image:
            return image_axes(change) + " in place of u, v";
        case Kind::Orientation:
            return fmt::format("{} {}", orientation_columns(notation), change.sense->words);
    }
    return "";
}

std::string cure_one(const ReadingChange& change, const Campaign& campaign) {
    switch (change.kind) {
        case Kind::Reversed:
            break;  // all together
        case Kind::Exchanged:
            return "exchange the names of these columns";
        case Kind::Coupled:
            return fmt::format("write {} into the column {}", coupled(change, campaign),
                               name_of(campaign, change.joint));
        case Kind::JointFactor: {
            const char* suffix = joint_units(change, campaign).suffix;
            return change.joint < 0
                       ? fmt::format("let the names of their columns end in {}", suffix)
                       : fmt::format("name the column {}{}", name_of(campaign, change.joint),
                                     suffix);
        }
        case Kind::Zero:
            return fmt::format("write {} into the column {}, or turn the joint's zero in the robot",
                               shifted(change, campaign), name_of(campaign, change.joint));
        case Kind::LengthFactor: {
            const std::string meant = mistake_of(change.factor).meant;
            return meant == "m" || meant == "mm"
                       ? fmt::format("let the names of their columns end in _{}", meant)
                       : fmt::format("multiply them by {}", format_short(change.factor, 4));
        }
        case Kind::LeftHanded:
            return campaign.sensor->has_orientation()
                       ? "turn round the signs of z and of the turns about x and y"
                       : "turn round the signs of all z";
        case Kind::Inverted:
            return "say what was measured, keys sensor.camera and sensor.measured (board_in_camera "
                   "or camera_in_board), or invert each pose";
        case Kind::Axes:
            return fmt::format("write {} into the columns x, y, z", axes(change));
        case Kind::Image:
            return fmt::format(
                "write {} into the columns u, v: the image was mirrored or turned after the "
                "camera was calibrated, or these columns exchanged",
                image_axes(change));
        case Kind::Orientation:
            return change.sense->cure;
    }
    return "";
}

}  // namespace

Measurements read_with(const ReadingChanges& changes, const Campaign& campaign,
                       Measurements measurements) {
    RowMatrixXd& observations = measurements.observations;
    const bool is_inverse = records_inverse(*campaign.sensor);
    if (is_inverse) invert_poses(observations);  // as it was read
    for (const ReadingChange& change : changes) {
        change_joints(change, campaign, measurements.configurations);
        if (change.kind == Kind::LengthFactor)
            change_lengths(change, *campaign.sensor, observations);
        if (change.kind == Kind::Image) change_image(change, *campaign.sensor, observations);
        if (change.kind == Kind::Axes) change_axes(change, observations);
        if (change.kind == Kind::LeftHanded) mirror(*campaign.sensor, observations);
        if (change.kind == Kind::Orientation) change_orientations(*change.sense, measurements);
        if (change.kind == Kind::Inverted) invert_poses(observations);
    }
    if (is_inverse) invert_poses(observations);
    return measurements;
}

bool has_kind(const ReadingChanges& changes, Kind kind) {
    return std::ranges::any_of(changes, [&](const auto& change) { return change.kind == kind; });
}

Index count_changes(const ReadingChanges& changes) {
    const auto twice = std::ranges::count_if(changes, [](const ReadingChange& change) {
        const bool is_mirrored = is_reversed(change, 0) || is_reversed(change, 1);
        return change.kind == Kind::Zero || (change.kind == Kind::Coupled && change.factor < 0) ||
               (change.kind == Kind::Image && is_mirrored);
    });
    return std::ssize(changes) + twice;
}

bool has_all(const ReadingChanges& changes, const ReadingChanges& others) {
    return std::ranges::all_of(others, [&](const ReadingChange& other) {
        return std::ranges::find(changes, other) != changes.end();
    });
}

std::vector<std::string> reversed_joints(const ReadingChanges& changes, const Campaign& campaign) {
    std::vector<std::string> names;
    for (const ReadingChange& change : changes) {
        if (change.kind == Kind::Reversed) names.push_back(name_of(campaign, change.joint));
    }
    return names;
}

std::string describe(const ReadingChanges& changes, const Campaign& campaign,
                     OrientationNotation notation) {
    if (changes.empty()) return "as stated";
    std::vector<std::string> parts;
    for (const ReadingChange& change : changes) {
        if (change.kind == Kind::Reversed) continue;
        parts.push_back(describe_one(change, campaign, notation));
    }
    const auto reversed = reversed_joints(changes, campaign);
    if (!reversed.empty()) parts.push_back(fmt::format("{} reversed", fmt::join(reversed, ", ")));
    return fmt::format("{}", fmt::join(parts, " and "));
}

std::string describe_cure(const ReadingChanges& changes, const Campaign& campaign) {
    std::vector<std::string> parts;
    for (const ReadingChange& change : changes) {
        if (change.kind == Kind::Reversed) continue;
        parts.push_back(cure_one(change, campaign));
    }
    if (has_kind(changes, Kind::Reversed)) {
        parts.emplace_back(
            "write each with the opposite sign (-q for q) in the file or wherever it stands in the "
            "campaign's robot, or turn its axis round in the URDF");
    }
    return fmt::format("{}", fmt::join(parts, ", and "));
}

}  // namespace posewise::detail
