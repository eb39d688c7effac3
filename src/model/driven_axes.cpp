#include "driven_axes.hpp"

namespace posewise::detail {
namespace {

Isometry3d transform_of(const Element& element, double amount) {
    const Vector3d axis = Vector3d::Unit(static_cast<Index>(element.axis));
    if (element.motion == Motion::Rotation) return Isometry3d(Eigen::AngleAxisd(amount, axis));
    return Isometry3d(Eigen::Translation3d(amount * axis));
}

}  // namespace

Vector3d foot_of_normal(const Line& line, const Line& other) {
    const Vector3d normal = line.direction.cross(other.direction);
    const Vector3d apart = other.point - line.point;
    const double along = apart.cross(other.direction).dot(normal) / normal.squaredNorm();
    return line.point + along * line.direction;
}

DrivenAxes find_driven_axes(const Chain& chain, const VectorXd& parameters) {
    DrivenAxes found{{}, Isometry3d::Identity()};
    Isometry3d& frame = found.base_from_flange;
    Index next = 0;
    for (const Element& element : chain.elements()) {
        if (!element.joints.empty()) found.axes.push_back({frame, &element});
        const double error = element.parameter.empty() ? 0 : parameters[next++];
        next += static_cast<Index>(element.terms.size());
        frame = frame * transform_of(element, element.value + error);
    }
    return found;
}

}  // namespace posewise::detail
