#include "posewise/planner/design_space.hpp"

#include "posewise/jacobian/pose_information.hpp"

namespace posewise {
namespace {

/// Sensor rows of the targets a pose shows, `width` each.
std::vector<Index> seen_rows(const Constraints& constraints, Index width, const VectorXd& q) {
    const std::vector<bool> is_visible = constraints.check(q).is_visible;
    std::vector<Index> rows;
    for (std::size_t target = 0; target < is_visible.size(); ++target) {
        const Index first = width * static_cast<Index>(target);
        for (Index k = 0; k < width && is_visible[target]; ++k) rows.push_back(first + k);
    }
    return rows;
}

}  // namespace

DesignSpace make_design_space(const Campaign& campaign, const Parameters& parameters,
                              double repeats, const Constraints* constraints) {
    const auto pose = std::make_shared<PoseInformation>(campaign, parameters, repeats);
    const Chain& robot = constraints == nullptr ? campaign.robot : constraints->robot();
    const Index width = campaign.sensor->rows_per_target();
    DesignSpace space;
    space.parameter_count = pose->parameter_count();
    space.parameter_names = parameter_names(campaign);
    space.lower.resize(robot.joint_count());
    space.upper.resize(robot.joint_count());
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
        space.lower[j] = joint.lower;
        space.upper[j] = joint.upper;
    }
    if (constraints == nullptr || !constraints->cell().sight) {
        space.information = [pose](const VectorXd& q) { return pose->evaluate(q); };
        space.information_gradient = [pose](const VectorXd& q, const MatrixXd& Z) {
            return pose->differentiate(q, Z);
        };
    } else {
        space.information = [pose, constraints, width](const VectorXd& q) -> MatrixXd {
            const auto rows = seen_rows(*constraints, width, q);
            const Index size = pose->parameter_count();
            return rows.empty() ? MatrixXd(MatrixXd::Zero(size, size)) : pose->evaluate(q, rows);
        };
        space.information_gradient = [pose, constraints, width](const VectorXd& q,
                                                                const MatrixXd& Z) -> VectorXd {
            const auto rows = seen_rows(*constraints, width, q);
            return rows.empty() ? VectorXd(VectorXd::Zero(q.size()))
                                : pose->differentiate(q, Z, rows);
        };
    }
    if (constraints == nullptr) return space;
    for (const auto& [joint, value] : constraints->cell().fixed_joints) {
        space.lower[joint] = space.upper[joint] = value;
    }
    space.least_joint_distance = constraints->cell().least_joint_distance;
    space.margin = [constraints](const VectorXd& q) { return constraints->margin(q); };
    return space;
}

}  // namespace posewise
