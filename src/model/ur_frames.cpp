#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "driven_axes.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/types.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/dh.hpp"

namespace posewise {
namespace {

using namespace detail;

constexpr std::size_t ur_joint_count = std::tuple_size_v<UrFrames>;

void check_joints(const Chain& chain, const std::vector<DrivenAxis>& axes) {
    bool is_plain = axes.size() == ur_joint_count && chain.joints().size() == ur_joint_count;
    for (std::size_t k = 0; k < axes.size() && is_plain; ++k) {
        const std::vector<JointTerm>& joints = axes[k].element->joints;
        is_plain = axes[k].element->motion == Motion::Rotation && joints.size() == 1 &&
                   joints.front().joint == static_cast<Index>(k) &&
                   std::abs(joints.front().coefficient) == 1;
    }
    if (is_plain) return;
    throw InputError(
        "frames of a UR are those of six joints that turn, each about one axis and in their order, "
        "neither geared nor coupled; this robot has others");
}

/// A UR's own turns by what its errors are. One that begins a half turn before does not fit the
/// links that ROS puts in front of it.
void check_shoulder(const Isometry3d& shoulder) {
    if (shoulder(0, 0) >= 0) return;
    throw InputError(fmt::format(
        "the shoulder is turned by {:.1f} deg about the base's z axis; kinematics of a UR begin at "
        "base_link_inertia: state that as base_link, or a base that is half a turn from it",
        to_degrees(std::abs(std::atan2(shoulder(1, 0), shoulder(0, 0))))));
}

/// Right before a driven element, turned so that z is what its joint turns about.
Isometry3d turned_frame(const DrivenAxis& axis) {
    Matrix3d R = Matrix3d::Identity();  // z to the axis
    if (axis.element->axis == Axis::X) R << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    if (axis.element->axis == Axis::Y) R << 1, 0, 0, 0, 0, 1, 0, -1, 0;
    const bool is_reversed = axis.element->joints.front().coefficient < 0;
    if (is_reversed) R = R * Vector3d(1, -1, -1).asDiagonal();
    Isometry3d frame = axis.base_from_element;
    frame.linear() = frame.linear() * R;
    return frame;
}

Line axis_of(const Isometry3d& frame) { return {frame.translation(), frame.linear().col(2)}; }

bool are_nearly_parallel(const Isometry3d& a, const Isometry3d& b) {
    return axis_of(a).direction.cross(axis_of(b).direction).norm() < nearly_parallel;
}

/// Where frame k, its predecessors in place, belongs on its axis.
Vector3d place(const std::array<Isometry3d, ur_joint_count>& frames, std::size_t k) {
    const Line axis = axis_of(frames[k]);
    if (!are_nearly_parallel(frames[k], frames[k + 1])) {
        return foot_of_normal(axis, axis_of(frames[k + 1]));
    }
    if (k == 0) return axis.point;
    const Line before = axis_of(frames[k - 1]);
    if (!are_nearly_parallel(frames[k], frames[k - 1])) return foot_of_normal(axis, before);
    const double along = (before.point - axis.point).dot(before.direction);
    return axis.point + along / axis.direction.dot(before.direction) * axis.direction;
}

/// The flange, brought onto the axis of the last joint if its description rounds what it should be:
/// 1.5708 for half of pi.
Isometry3d flange_on_axis(const Isometry3d& flange, const Isometry3d& last,
                          const std::string& joint) {
    constexpr double exact = 1e-9;  // m or rad
    Isometry3d rest = last.inverse() * flange;
    const double sideways = std::hypot(rest.translation().x(), rest.translation().y());
    const double off = std::atan2(std::hypot(rest(0, 2), rest(1, 2)), rest(2, 2));
    if (sideways <= exact && off <= exact) return flange;
    if (sideways <= ur_rounding.position && off <= ur_rounding.orientation) {
        const Vector3d z = rest.linear().col(2);
        rest.translation().head<2>().setZero();
        rest.linear() = nearest_rotation(rotation_between(z, Vector3d::UnitZ()) * rest.linear());
        return last * rest;
    }
    throw InputError(fmt::format(
        "the flange is {:.4f} mm beside the axis of joint '{}', its z axis {:.4f} mrad off it; "
        "frames of a UR end with that joint, so that its z axis must be the flange's",
        mm_per_m * sideways, joint, mrad_per_rad * off));
}

}  // namespace

Chain without_half_turn(const Chain& chain) {
    std::vector<Element> elements = chain.elements();
    if (elements.empty()) return chain;
    const Element& first = elements.front();
    const bool is_half_turn =
        first.motion == Motion::Rotation && first.axis == Axis::Z && first.joints.empty() &&
        first.parameter.empty() && !first.has_functions() &&
        std::abs(std::abs(first.value) - std::numbers::pi) <= ur_rounding.orientation;
    if (!is_half_turn) return chain;
    elements.erase(elements.begin());
    return chain.with_elements(std::move(elements));
}

UrFrames ur_frames(const Chain& stated, const VectorXd& parameters) {
    const Chain chain = without_half_turn(stated);
    const auto [axes, flange] = find_driven_axes(chain, parameters);
    check_joints(chain, axes);
    std::array<Isometry3d, ur_joint_count> frames;  // in the base
    for (std::size_t k = 0; k < ur_joint_count; ++k) frames[k] = turned_frame(axes[k]);
    const Isometry3d end = flange_on_axis(flange, frames.back(), chain.joints().back().name);
    for (std::size_t k = 0; k + 1 < ur_joint_count; ++k) frames[k].translation() = place(frames, k);
    frames.back() = end;
    UrFrames relative = frames;
    for (std::size_t k = 1; k < ur_joint_count; ++k)
        relative[k] = frames[k - 1].inverse() * frames[k];
    check_shoulder(relative.front());
    return relative;
}

Chain ur_chain(const UrFrames& frames, const std::vector<Joint>& joints) {
    std::vector<Element> elements;
    for (std::size_t k = 0; k < ur_joint_count; ++k) {
        const auto origin =
            origin_elements(frames[k].translation(), rpy_from_rotation(frames[k].linear()));
        elements.insert(elements.end(), origin.begin(), origin.end());
        elements.push_back({Motion::Rotation, Axis::Z, 0, {{static_cast<Index>(k), 1.0}}, ""});
    }
    return Chain(joints, std::move(elements));
}

}  // namespace posewise
