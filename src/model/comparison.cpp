#include <algorithm>

#include "posewise/core/errors.hpp"
#include "posewise/model/chain.hpp"
#include "sampling.hpp"

namespace posewise {
namespace {

/// Where each joint of `b` is among those of `a`.
std::vector<Index> matching_joints(const Chain& a, const Chain& b) {
    std::vector<Index> places;
    for (const Joint& joint : b.joints()) {
        const auto found =
            std::find_if(a.joints().begin(), a.joints().end(),
                         [&](const Joint& other) { return other.name == joint.name; });
        if (found != a.joints().end()) places.push_back(found - a.joints().begin());
    }
    if (places.size() != b.joints().size() || places.size() != a.joints().size()) {
        throw InputError("the robots to compare have other joints; must be the same by name");
    }
    return places;
}

}  // namespace

FlangeDifference compare_flanges(const Chain& a, const VectorXd& parameters_a, const Chain& b,
                                 const VectorXd& parameters_b, Index configuration_count,
                                 std::uint64_t seed) {
    const std::vector<Index> places = matching_joints(a, b);
    const RowMatrixXd configurations = detail::random_configurations(a, configuration_count, seed);
    FlangeDifference largest;
    largest.configuration_count = configuration_count;
    VectorXd q_b = VectorXd::Zero(b.configuration_size());
    for (Index i = 0; i < configuration_count; ++i) {
        const VectorXd q = configurations.row(i).transpose();
        q_b.head(b.joint_count()) = q(places);
        const Isometry3d difference =
            a.base_from_flange(q, parameters_a).inverse() * b.base_from_flange(q_b, parameters_b);
        largest.position = std::max(largest.position, difference.translation().norm());
        largest.orientation =
            std::max(largest.orientation, vector_from_rotation(difference.linear()).norm());
    }
    return largest;
}

}  // namespace posewise
