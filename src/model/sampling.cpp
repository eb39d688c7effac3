#include "sampling.hpp"

#include "posewise/core/random.hpp"

namespace posewise::detail {

RowMatrixXd random_configurations(const Chain& chain, Index count, std::uint64_t seed) {
    RowMatrixXd configurations(count, chain.configuration_size());
    for (Index i = 0; i < count; ++i) {
        RandomStream stream(seed, static_cast<std::uint64_t>(i));
        for (Index j = 0; j < chain.joint_count(); ++j) {
            const Joint& joint = chain.joints()[static_cast<std::size_t>(j)];
            configurations(i, j) = stream.uniform(joint.lower, joint.upper);
        }
        Index next = chain.joint_count();
        for (const MeasuredTorque& torque : chain.torques()) {
            configurations(i, next++) = stream.uniform(-torque.largest, torque.largest);
        }
    }
    return configurations;
}

}  // namespace posewise::detail
