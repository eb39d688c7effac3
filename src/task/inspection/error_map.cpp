#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/scene.hpp"
#include "task/calibration/nominal_fit.hpp"
#include "task/choice/choice_problem.hpp"
#include "task/plan/planning_problem.hpp"

namespace posewise {
namespace {

/// `spread` has three columns a position, as many positions a configuration as it takes: what
/// errors of these a draw of the parameters makes.
ErrorMap make_map(const Campaign& campaign, const Parameters& parameters,
                  const RowMatrixXd& configurations, const MatrixXd& spread, Index target = 0) {
    const Vector3d point = campaign.sensor->target_position(target, parameters.sensor);
    const Index columns = spread.cols() / std::max<Index>(1, configurations.rows());
    ErrorMap map;
    for (Index i = 0; i < configurations.rows(); ++i) {
        MappedError& error = map.emplace_back();
        error.configuration = configurations.row(i).transpose();
        error.position = world_from_flange(campaign, parameters, error.configuration) * point;
        const double square = spread.middleCols(columns * i, columns).squaredNorm();
        error.predicted = std::sqrt(3 * square / static_cast<double>(columns));
    }
    return map;
}

/// Errors by the information M of scaled parameters.
ErrorMap map_information(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations, const MatrixXd& M, Index target = -1) {
    const Eigen::LLT<MatrixXd> cholesky(M);
    if (cholesky.info() != Eigen::Success) {
        throw InputError("the poses do not identify all parameters, so they predict nothing");
    }
    const Blocks blocks = make_prediction_blocks(campaign, parameters, configurations, target);
    return make_map(campaign, parameters, configurations,
                    cholesky.matrixL().solve(blocks.matrix.transpose()),
                    std::max<Index>(0, target));
}

}  // namespace

ErrorMap map_errors(const Plan& plan, const Campaign& campaign, const PlanningOptions& options) {
    const PlanningOptions made = detail::options_of(plan, options);
    const detail::PlanningProblem problem = detail::state_planning(campaign, made);
    const MatrixXd M =
        held_information(problem) + information(detail::blocks_of(problem, plan.poses));
    return map_information(problem.campaign, problem.campaign.nominal,
                           detail::workspace_of(problem, made), M,
                           plan.request.workspace_target - 1);
}

ErrorMap map_errors(const Plan& plan, const Campaign& campaign, const Candidates& candidates,
                    const ChoiceOptions& options) {
    const detail::ChoiceProblem problem = detail::state_choice(campaign, candidates, options);
    return map_information(campaign, problem.parameters, detail::workspace_of(problem),
                           detail::information_of(problem, plan.poses));
}

ErrorMap map_errors(const Campaign& campaign, const Estimate& estimate,
                    const GeometryOptions& options) {
    const detail::NominalFit nominal = detail::fit_nominal(campaign, estimate.parameters, options);
    const Blocks blocks =
        make_position_blocks(campaign, estimate.parameters, nominal.configurations);
    // C = L L^T; a covariance that is only nearly positive semidefinite has a root, too.
    const Eigen::LDLT<MatrixXd> factors(estimate.covariance);
    const MatrixXd turned = factors.transpositionsP() * MatrixXd(blocks.matrix.transpose());
    const MatrixXd spread =
        factors.vectorD().cwiseMax(0).cwiseSqrt().asDiagonal() * (factors.matrixU() * turned);
    ErrorMap map = make_map(campaign, estimate.parameters, nominal.configurations, spread);
    const Index rows = nominal.displacements.size() / std::max<Index>(1, std::ssize(map));
    for (Index i = 0; i < std::ssize(map); ++i) {
        map[static_cast<std::size_t>(i)].displacement = nominal.displacements.segment<3>(rows * i);
    }
    return map;
}

}  // namespace posewise
