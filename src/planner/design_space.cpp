#include "design_space.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>

#include "core/decompositions.hpp"
#include "core/parallel.hpp"
#include "core/text.hpp"
#include "jacobian/pose_information.hpp"
#include "measurement/cell_check.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {

DesignSpace make_design_space(const Campaign& campaign, const Parameters& parameters,
                              double repeats, const Constraints* constraints) {
    const auto pose = std::make_shared<PoseInformation>(campaign, parameters, repeats);
    DesignSpace space;
    space.parameter_count = pose->parameter_count();
    space.parameter_names = parameter_names(campaign);
    const JointRange range = constraints == nullptr
                                 ? limits_of(campaign.robot)
                                 : joint_range(constraints->robot(), constraints->cell());
    space.lower = range.lower;
    space.upper = range.upper;
    const auto seen = [constraints](const VectorXd& q) {
        return constraints == nullptr ? SeenTargets() : constraints->seen(q);
    };
    space.rows = [pose, seen](const VectorXd& q) { return pose->rows(q, seen(q)); };
    space.information = [pose, seen](const VectorXd& q) { return pose->evaluate(q, seen(q)); };
    space.information_gradient = [pose, seen](const VectorXd& q, const MatrixXd& Z) {
        return pose->differentiate(q, Z, seen(q));
    };
    space.weighed_gradient = [pose, seen](const VectorXd& q, const DesignSpace::Weigh& weigh) {
        return pose->differentiate_weighed(q, weigh, seen(q));
    };
    if (constraints == nullptr) return space;
    space.is_pool_only = constraints->needs_contact();
    space.least_joint_distance = constraints->cell().least_joint_distance;
    if (!constraints->restricts_places()) return space;
    space.margin = [constraints](const VectorXd& q) { return constraints->margin(q); };
    return space;
}

void Support::add(const DesignSpace& space, const RowMatrixXd& added) {
    std::vector<RowMatrixXd> rows(static_cast<std::size_t>(added.rows()));
    for_each_index(added.rows(), [&](Index i) {
        rows[static_cast<std::size_t>(i)] = space.rows(added.row(i).transpose());
    });
    for (const RowMatrixXd& block : rows) {
        blocks.first_row.push_back(blocks.first_row.back() + block.rows());
    }
    Index row = blocks.matrix.rows();
    blocks.matrix.conservativeResize(blocks.first_row.back(), space.parameter_count);
    for (const RowMatrixXd& block : rows) {
        blocks.matrix.middleRows(row, block.rows()) = block;
        row += block.rows();
    }
    poses.conservativeResize(poses.rows() + added.rows(), added.cols());
    poses.bottomRows(added.rows()) = added;
}

Blocks take_first(const Blocks& blocks, Index count) {
    std::vector<Index> first(static_cast<std::size_t>(std::min(blocks.count(), count)));
    std::iota(first.begin(), first.end(), Index{0});
    return take(blocks, first);
}

RowMatrixXd rows_of(const DesignSpace& space, const HeldPoses& held, const RowMatrixXd& poses) {
    Support planned;
    planned.add(space, poses);
    return stack(held.rows, planned.blocks.matrix);
}

bool is_apart(const RowMatrixXd& poses, const Eigen::RowVectorXd& q, double distance) {
    for (const auto pose : poses.rowwise()) {
        if (joint_distance(pose.transpose(), q.transpose()) < distance) return false;
    }
    return true;
}

void check_all_is_seen(const DesignSpace& space, const RowMatrixXd& rows) {
    // A plan that leaves a direction less sure than so many expected errors is no plan.
    constexpr double largest_deviation = 1000;
    const auto [values, directions] = singular_directions(rows);
    const double least = values.tail(1)[0];
    const bool is_identified =
        count_independent_columns(triangular_factor_of_many(rows)) == space.parameter_count;
    if (is_identified && least >= 1 / largest_deviation) return;
    const std::string deviation =
        is_identified ? fmt::format("known to {:.2g} times its expected size only", 1 / least)
                      : "unknown";
    throw InputError(fmt::format(
        "the best plan found leaves the parameter direction {} (in expected errors) {}, must be "
        "known to {} times at worst; take more poses, more starts or a prior (`pose_count`, "
        "`starts`, `spread.is_prior`)",
        describe_combination(directions.rightCols(1), space.parameter_names), deviation,
        largest_deviation));
}

}  // namespace posewise::detail
