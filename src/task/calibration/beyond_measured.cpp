#include "posewise/task/doubts.hpp"

namespace posewise {

std::optional<BeyondMeasured> find_beyond_measured(const Campaign& campaign,
                                                   const RowMatrixXd& measured,
                                                   const RowMatrixXd& configurations) {
    constexpr double tolerated = 0.1;  // of the range
    using Beyond = Eigen::Array<bool, Eigen::Dynamic, 1>;
    Beyond is_beyond = Beyond::Constant(configurations.rows(), false);
    BeyondMeasured found{0, configurations.rows(), {}};
    for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
        const double least = measured.col(j).minCoeff();
        const double most = measured.col(j).maxCoeff();
        const double margin = tolerated * (most - least);
        const auto q = configurations.col(j).array();
        const Beyond leaves = q < least - margin || q > most + margin;
        if (!leaves.any()) continue;
        is_beyond = is_beyond || leaves;
        found.joints.push_back(campaign.robot.joint(j).name);
    }
    found.count = is_beyond.count();
    if (found.count == 0) return std::nullopt;
    return found;
}

}  // namespace posewise
