#include "design_space.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "../core/decompositions.hpp"
#include "../core/parallel.hpp"
#include "../core/text.hpp"
#include "../jacobian/pose_information.hpp"
#include "../measurement/cell_check.hpp"
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
    space.information = [pose, seen](const VectorXd& q) { return pose->evaluate(q, seen(q)); };
    space.information_gradient = [pose, seen](const VectorXd& q, const MatrixXd& Z) {
        return pose->differentiate(q, Z, seen(q));
    };
    if (constraints == nullptr) return space;
    space.is_pool_only = constraints->needs_contact();
    space.least_joint_distance = constraints->cell().least_joint_distance;
    if (!constraints->restricts_places()) return space;
    space.margin = [constraints](const VectorXd& q) { return constraints->margin(q); };
    return space;
}

void Support::add(const DesignSpace& space, const RowMatrixXd& added) {
    std::vector<RowMatrixXd> roots(static_cast<std::size_t>(added.rows()));
    for_each_index(added.rows(), [&](Index i) {
        const auto eigen = eigen_decomposition(space.information(added.row(i).transpose()));
        const VectorXd& lambda = eigen.eigenvalues();
        const Index rank = (lambda.array() > 1e-13 * lambda.maxCoeff()).count();
        roots[static_cast<std::size_t>(i)] = lambda.tail(rank).cwiseSqrt().asDiagonal() *
                                             eigen.eigenvectors().rightCols(rank).transpose();
    });
    for (const RowMatrixXd& root : roots) {
        blocks.first_row.push_back(blocks.first_row.back() + root.rows());
    }
    Index row = blocks.matrix.rows();
    blocks.matrix.conservativeResize(blocks.first_row.back(), space.parameter_count);
    for (const RowMatrixXd& root : roots) {
        blocks.matrix.middleRows(row, root.rows()) = root;
        row += root.rows();
    }
    poses.conservativeResize(poses.rows() + added.rows(), added.cols());
    poses.bottomRows(added.rows()) = added;
}

bool is_apart(const RowMatrixXd& poses, const Eigen::RowVectorXd& q, double distance) {
    return poses.rows() == 0 ||
           (poses.rowwise() - q).cwiseAbs().rowwise().maxCoeff().minCoeff() >= distance;
}

void check_all_is_seen(const DesignSpace& space, const MatrixXd& M) {
    // A plan that leaves a direction less sure than so many expected errors is no plan.
    constexpr double largest_deviation = 1000;
    const auto eigen = eigen_decomposition(M);
    const double least = eigen.eigenvalues()[0];
    if (least >= 1 / (largest_deviation * largest_deviation)) return;
    const double rounding = std::numeric_limits<double>::epsilon() * eigen.eigenvalues().tail(1)[0];
    const std::string deviation =
        least > 100 * rounding
            ? fmt::format("known to {:.2g} times its expected size only", 1 / std::sqrt(least))
            : "unknown";
    throw InputError(fmt::format(
        "the best plan found leaves the parameter direction {} (in expected errors) {}, must be "
        "known to {} times at worst; take more poses, more starts or a prior (--poses, --starts, "
        "--prior)",
        describe_combination(eigen.eigenvectors().col(0), space.parameter_names), deviation,
        largest_deviation));
}

}  // namespace posewise::detail
