#include "posewise/model/dh.hpp"

#include <cmath>

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

std::vector<Element> without_idle(std::vector<Element> elements) {
    std::erase_if(elements, [](const Element& element) {
        return element.value == 0 && element.joints.empty();
    });
    return elements;
}

// ---- A chain as rows ----

struct Line {
    Vector3d point;
    Vector3d direction;
};

/// A driven element: where its axis is at joint values zero.
struct DrivenAxis {
    Line line;
    Motion motion;
    std::vector<JointTerm> joints;
};

Isometry3d transform_of(const Element& element, double amount) {
    const Vector3d axis = Vector3d::Unit(static_cast<Index>(element.axis));
    if (element.motion == Motion::Rotation) return Isometry3d(Eigen::AngleAxisd(amount, axis));
    return Isometry3d(Eigen::Translation3d(amount * axis));
}

Isometry3d transform_of(const DhRow& row) {
    return Eigen::AngleAxisd(row.theta, Vector3d::UnitZ()) * Eigen::Translation3d(row.a, 0, row.d) *
           Eigen::AngleAxisd(row.alpha, Vector3d::UnitX());
}

/// The row from a frame to the nearest one whose z axis is the line.
DhRow row_to(const Isometry3d& frame, const Line& line) {
    constexpr double parallel = 1e-8;  // rad; nearer, rounding of a far d is worse
    const Vector3d u = frame.linear().transpose() * line.direction;
    const Vector3d p = frame.inverse() * line.point;
    const double sine = std::hypot(u.x(), u.y());
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

/// Axes of the driven elements and the flange, at joint values zero.
std::pair<std::vector<DrivenAxis>, Isometry3d> axes_of(const Chain& chain,
                                                       const VectorXd& parameters) {
    std::vector<DrivenAxis> axes;
    Isometry3d frame = Isometry3d::Identity();
    Index next = 0;
    for (const Element& element : chain.elements()) {
        if (!element.joints.empty()) {
            const Vector3d direction = frame.linear().col(static_cast<Index>(element.axis));
            axes.push_back({{frame.translation(), direction}, element.motion, element.joints});
        }
        const double error = element.parameter.empty() ? 0 : parameters[next++];
        next += static_cast<Index>(element.terms.size());
        frame = frame * transform_of(element, element.value + error);
    }
    return {axes, frame};
}

bool is_idle(const DhRow& row) {
    return row.a == 0 && row.alpha == 0 && row.d == 0 && row.theta == 0;
}

}  // namespace

std::vector<DhRow> dh_rows(const Chain& chain, const VectorXd& parameters) {
    const auto [axes, flange] = axes_of(chain, parameters);
    std::vector<DhRow> rows;
    Isometry3d frame = Isometry3d::Identity();
    const auto add = [&](DhRow row) {
        frame = frame * transform_of(row);
        rows.push_back(std::move(row));
    };
    DhRow base = row_to(frame, axes.front().line);
    if (!is_idle(base)) add(base);
    for (std::size_t k = 0; k < axes.size(); ++k) {
        const Line next = k + 1 < axes.size() ? axes[k + 1].line
                                              : Line{flange.translation(), flange.linear().col(2)};
        DhRow row = row_to(frame, next);
        row.motion = axes[k].motion;
        row.joints = axes[k].joints;
        add(std::move(row));
    }
    const Isometry3d rest = frame.inverse() * flange;
    DhRow tool;
    tool.theta = std::atan2(rest(1, 0), rest(0, 0));
    tool.d = rest.translation().z();
    if (!is_idle(tool)) add(tool);
    return rows;
}

std::vector<Element> dh_elements(const DhRow& row) {
    return without_idle(
        {joint_rotation(row), joint_translation(row), link_translation(row), link_rotation(row)});
}

std::vector<Element> mdh_elements(const DhRow& row) {
    return without_idle(
        {link_rotation(row), link_translation(row), joint_rotation(row), joint_translation(row)});
}

}  // namespace posewise
