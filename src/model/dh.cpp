#include "posewise/model/dh.hpp"

#include <cmath>
#include <numbers>
#include <optional>

#include "driven_axes.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

std::vector<JointTerm> driving(const DhRow& row, Motion motion) {
    return row.motion == motion ? row.joints : std::vector<JointTerm>();
}

Element joint_rotation(const DhRow& row) {
    return {Motion::Rotation, Axis::Z, row.theta, driving(row, Motion::Rotation), ""};
}

Element joint_translation(const DhRow& row) {
    return {Motion::Translation, Axis::Z, row.d, driving(row, Motion::Translation), ""};
}

Element link_translation(const DhRow& row) { return {Motion::Translation, Axis::X, row.a, {}, ""}; }

Element link_rotation(const DhRow& row) { return {Motion::Rotation, Axis::X, row.alpha, {}, ""}; }

Element parallel_rotation(const DhRow& row) {
    return {Motion::Rotation, Axis::Y, row.beta, {}, ""};
}

std::vector<Element> without_idle(std::vector<Element> elements) {
    std::erase_if(elements, [](const Element& element) {
        return element.value == 0 && element.joints.empty();
    });
    return elements;
}

// ---- A chain as rows ----

Isometry3d transform_of(const DhRow& row) {
    return Eigen::AngleAxisd(row.theta, Vector3d::UnitZ()) * Eigen::Translation3d(row.a, 0, row.d) *
           Eigen::AngleAxisd(row.alpha, Vector3d::UnitX()) *
           Eigen::AngleAxisd(row.beta, Vector3d::UnitY());
}

/// To the point where a line (direction u through p) meets the xy plane, z turned into its
/// direction [Hayati 1983].
DhRow row_to_nearly_parallel(const Vector3d& p, const Vector3d& u) {
    const Vector3d origin = p - p.z() / u.z() * u;
    DhRow row;
    row.a = std::hypot(origin.x(), origin.y());
    row.theta = row.a > 0 ? std::atan2(origin.y(), origin.x()) : 0;
    const Vector3d turned = Eigen::AngleAxisd(-row.theta, Vector3d::UnitZ()) * u;
    row.alpha = std::atan2(-turned.y(), turned.z());
    row.beta = std::atan2(turned.x(), std::hypot(turned.y(), turned.z()));
    return row;
}

/// The row from a frame to the nearest one whose z axis is the line.
DhRow row_to(const Isometry3d& frame, const detail::Line& line, bool has_beta = true) {
    constexpr double parallel = 1e-12;  // rad; what is nearer is rounding
    const Vector3d u = frame.linear().transpose() * line.direction;
    const Vector3d p = frame.inverse() * line.point;
    const double sine = std::hypot(u.x(), u.y());
    if (has_beta && sine >= parallel && sine < detail::nearly_parallel) {
        return row_to_nearly_parallel(p, u);
    }
    DhRow row;
    row.alpha = std::atan2(sine < parallel ? 0 : sine, u.z());
    if (sine < parallel) {
        row.a = std::hypot(p.x(), p.y());
        row.theta = row.a > 0 ? std::atan2(p.y(), p.x()) : 0;
        return row;
    }
    // The common normal z cross u, and what is across it in the xy plane.
    const Vector3d normal(-u.y() / sine, u.x() / sine, 0);
    const Vector3d across = Vector3d::UnitZ().cross(normal);
    row.theta = std::atan2(normal.y(), normal.x());
    row.a = p.dot(normal);
    row.d = p.z() + p.dot(across) / sine * u.z();
    return row;
}

/// As the elements from a driven one to the next (or the end) state it, where they are a row of the
/// standard convention.
std::optional<DhRow> stated_row(const Element* driven, const Element* next) {
    constexpr double largest_error = 0.1;  // rad or m, of what no row has
    DhRow row;
    if (driven->axis != Axis::Z) return std::nullopt;
    (driven->motion == Motion::Rotation ? row.theta : row.d) = driven->value;
    for (const Element* element = driven + 1; element != next; ++element) {
        const bool turns = element->motion == Motion::Rotation;
        if (element->axis == Axis::Y) {
            if (std::abs(element->value) > largest_error) return std::nullopt;
        } else if (element->axis == Axis::Z) {
            (turns ? row.theta : row.d) += element->value;
        } else {
            (turns ? row.alpha : row.a) += element->value;
        }
    }
    return row;
}

double distance(const DhRow& row, const DhRow& stated) {
    const auto turn = [](double angle) {
        return std::abs(std::remainder(angle, 2 * std::numbers::pi));
    };
    return turn(row.theta - stated.theta) + turn(row.alpha - stated.alpha) +
           std::abs(row.a - stated.a);
}

/// The row with its x axis, and that of the frame after it, turned about z by half a turn.
DhRow turned(DhRow row) {
    row.theta = std::remainder(row.theta + std::numbers::pi, 2 * std::numbers::pi);
    for (double* const value : {&row.a, &row.alpha, &row.beta}) *value = 0 - *value;
    return row;
}

bool is_idle(const DhRow& row) {
    return row.a == 0 && row.alpha == 0 && row.d == 0 && row.theta == 0 && row.beta == 0;
}

}  // namespace

std::vector<DhRow> dh_rows(const Chain& chain, const VectorXd& parameters, bool has_beta) {
    const auto [axes, flange] = detail::find_driven_axes(chain, parameters);
    std::vector<DhRow> rows;
    Isometry3d frame = Isometry3d::Identity();
    const auto add = [&](DhRow row) {
        frame = frame * transform_of(row);
        rows.push_back(std::move(row));
    };
    DhRow base = row_to(frame, axes.front().line());
    if (!is_idle(base)) add(base);
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const detail::Line next = k + 1 < axes.size()
                                      ? axes[k + 1].line()
                                      : detail::Line{flange.translation(), flange.linear().col(2)};
        DhRow row = row_to(frame, next, has_beta || k + 1 == axes.size());
        const Element* const end = k + 1 < axes.size()
                                       ? axes[k + 1].element
                                       : chain.elements().data() + chain.elements().size();
        const auto stated = stated_row(axes[k].element, end);
        if (stated && distance(turned(row), *stated) < distance(row, *stated)) row = turned(row);
        row.motion = axes[k].element->motion;
        row.joints = axes[k].element->joints;
        add(std::move(row));
    }
    const Isometry3d rest = frame.inverse() * flange;
    DhRow tool;
    tool.theta = std::atan2(rest(1, 0), rest(0, 0));
    tool.d = rest.translation().z();
    if (!is_idle(tool)) add(tool);
    return rows;
}

ModifiedDh modified_dh(const Chain& chain, const VectorXd& parameters) {
    ModifiedDh modified;
    const Isometry3d half_turn(Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()));
    DhRow link;  // a and alpha in front of the next joint; behind the last one all of its row
    for (const DhRow& row : dh_rows(chain, parameters, false)) {
        if (row.joints.empty()) {
            Isometry3d& fixed = modified.rows.empty() ? modified.base : modified.tool;
            fixed = fixed * transform_of(row);
            continue;
        }
        const JointTerm& term = row.joints.front();
        const bool is_own = row.motion == Motion::Rotation && row.joints.size() == 1 &&
                            std::abs(term.coefficient) == 1 &&
                            term.joint == std::ssize(modified.rows);
        if (!is_own) {
            throw InputError(
                "joint '" + chain.joint(term.joint).name +
                "' does not turn one axis of its own in the order of the joints, as each row of a "
                "modified Denavit-Hartenberg table has it");
        }
        DhRow joint = row;
        joint.a = link.a;
        joint.alpha = link.alpha;
        link = {};
        link.a = row.a;
        link.alpha = row.alpha;
        link.beta = row.beta;
        if (term.coefficient < 0) {  // z and y axes of the joint's frame the other way
            joint.alpha += std::numbers::pi;
            joint.theta *= -1;
            joint.d *= -1;
            joint.joints.front().coefficient = 1;
            link.alpha -= std::numbers::pi;
        }
        joint.beta = 0;
        if (modified.rows.empty()) {
            if (joint.alpha != 0) modified.base = modified.base * half_turn;
            joint.alpha = 0;
        }
        joint.alpha = std::remainder(joint.alpha, 2 * std::numbers::pi);
        modified.rows.push_back(joint);
        modified.tool = transform_of(link);
    }
    if (std::ssize(modified.rows) != chain.joint_count()) {
        throw InputError("a joint turns nothing, which a modified Denavit-Hartenberg table needs");
    }
    return modified;
}

std::vector<Element> dh_elements(const DhRow& row) {
    return without_idle({joint_rotation(row), joint_translation(row), link_translation(row),
                         link_rotation(row), parallel_rotation(row)});
}

std::vector<Element> mdh_elements(const DhRow& row) {
    return without_idle(
        {link_rotation(row), link_translation(row), joint_rotation(row), joint_translation(row)});
}

}  // namespace posewise
