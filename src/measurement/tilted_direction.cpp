#include "tilted_direction.hpp"

#include "posewise/model/chain.hpp"

namespace posewise::detail {

TiltedDirection tilt(const Vector3d& stated, double tilt1, double tilt2) {
    const Vector3d axis1 = stated.unitOrthogonal();
    const Vector3d axis2 = stated.cross(axis1);
    const Vector3d vector = tilt1 * axis1 + tilt2 * axis2;
    const Vector3d turned = rotation_from_vector(vector) * stated;
    const Matrix3d turns = rotation_vector_rate(vector);
    return {turned, (turns * axis1).cross(turned), (turns * axis2).cross(turned)};
}

}  // namespace posewise::detail
