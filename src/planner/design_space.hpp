#pragma once

#include <functional>
#include <string>
#include <vector>

#include "posewise/core/blocks.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::detail {

/// All poses that could be measured, as continuous refinement needs them: where they may lie and
/// what each tells. A campaign is one instance; an experiment that is no robot could be another.
/// The functions must be free of side effects, since threads share them.
struct DesignSpace {
    VectorXd lower;  ///< of each joint, rad or m
    VectorXd upper;  ///< equal to lower: that joint stays
    Index parameter_count = 0;
    /// The block of one pose, without units, parameter_count wide.
    std::function<RowMatrixXd(const VectorXd& q)> rows;
    /// Its information rows(q)^T rows(q), parameter_count square.
    std::function<MatrixXd(const VectorXd& q)> information;
    /// Derivative of trace(Z information(q)) by q, for symmetric Z.
    std::function<VectorXd(const VectorXd& q, const MatrixXd& Z)> information_gradient;
    /// As information_gradient, for a Z that is not at hand: `weigh` takes rows(q) and returns
    /// rows(q) Z. It is called once. Empty: there is only information_gradient.
    using Weigh = std::function<RowMatrixXd(const RowMatrixXd& rows)>;
    std::function<VectorXd(const VectorXd& q, const Weigh& weigh)> weighed_gradient{};
    /// At least 0 where a pose is feasible; may have kinks. Empty: everywhere within the limits.
    std::function<double(const VectorXd& q)> margin;
    /// Whether feasible poses have no feasible ones beside them, so that those of a pool are all
    /// there are.
    bool is_pool_only = false;
    /// Two poses of a plan differ at least so much in one joint (rad or m).
    double least_joint_distance = 0;
    std::vector<std::string> parameter_names;  ///< for messages; empty: they are numbered from 1

    Index joint_count() const { return lower.size(); }
};

/// The poses of a campaign within the joint limits, or within `constraints`, each telling what the
/// targets it shows tell. Campaign and constraints must outlive the result. Throws InputError as
/// PoseInformation.
DesignSpace make_design_space(const Campaign& campaign, const Parameters& parameters,
                              double repeats = 1, const Constraints* constraints = nullptr);

/// Poses of a space met by a search, to choose from.
struct Support {
    RowMatrixXd poses;
    Blocks blocks;

    /// Adds some poses.
    void add(const DesignSpace& space, const RowMatrixXd& added);
};

/// The first blocks of a pool, so many or all: its poses are of a low-discrepancy sequence, so that
/// the first ones are spread as all of them are.
Blocks take_first(const Blocks& blocks, Index count);

/// Rows held, and below them those of poses.
RowMatrixXd rows_of(const DesignSpace& space, const HeldPoses& held, const RowMatrixXd& poses);

/// Whether q differs from each of the poses by so much in some joint (rad or m).
bool is_apart(const RowMatrixXd& poses, const Eigen::RowVectorXd& q, double distance);

/// Throws InputError that names a parameter direction which rows do not see, or much less than is
/// expected of its errors; a criterion's value does not tell.
void check_all_is_seen(const DesignSpace& space, const RowMatrixXd& rows);

}  // namespace posewise::detail
