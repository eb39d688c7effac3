#include "least_squares.hpp"

#include <fmt/format.h>

#include <Eigen/QR>
#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/noise.hpp"

namespace posewise {

IdentificationProblem make_problem(const Campaign& campaign, const Measurements& measurements) {
    check_noise(campaign);
    if (measurements.configurations.cols() != campaign.robot.joint_count()) {
        throw InputError(fmt::format("measurements have {} joints, the robot has {}",
                                     measurements.configurations.cols(),
                                     campaign.robot.joint_count()));
    }
    if (measurements.observations.cols() != campaign.sensor->row_count()) {
        throw InputError(fmt::format("an observation has {} numbers, the sensor returns {}",
                                     measurements.observations.cols(),
                                     campaign.sensor->row_count()));
    }
    const Index equations = measurements.configuration_count() * campaign.sensor->row_count();
    if (equations < parameter_count(campaign)) {
        throw InputError(
            fmt::format("{} configurations give {} equations, {} parameters need at least as many",
                        measurements.configuration_count(), equations, parameter_count(campaign)));
    }
    return {campaign, measurements, mean_observations(measurements), parameter_scale(campaign)};
}

LinearisedSystem linearise(const IdentificationProblem& problem, const Parameters& parameters) {
    const Campaign& campaign = problem.campaign;
    const Index rows = campaign.sensor->row_count();
    const Index size = problem.scale.size();
    const Index count = problem.means.rows();
    LinearisedSystem system{MatrixXd(rows * count, size), VectorXd(rows * count)};
    RowMatrixXd augmented(rows, size + 1);  // the residual is whitened with the Jacobian
    FlangeMotion motion;
    VectorXd q(campaign.robot.joint_count());
    for (Index i = 0; i < count; ++i) {
        q = problem.measurements.configurations.row(i).transpose();
        differentiate_pose(campaign, parameters, q, motion, augmented.leftCols(size));
        augmented.col(size) = problem.means.row(i).transpose() -
                              campaign.sensor->predict(motion.world_from_flange, parameters.sensor);
        whiten(mean_covariance(campaign, motion, parameters.sensor,
                               static_cast<double>(problem.measurements.sample_count(i))),
               augmented);
        system.J.middleRows(rows * i, rows) = augmented.leftCols(size) * problem.scale.asDiagonal();
        system.r.segment(rows * i, rows) = augmented.col(size);
    }
    return system;
}

double sum_of_squares(const IdentificationProblem& problem, const Parameters& parameters) {
    const Campaign& campaign = problem.campaign;
    double sum = 0;
    RowMatrixXd r(campaign.sensor->row_count(), 1);
    FlangeMotion motion;
    VectorXd q(campaign.robot.joint_count());
    for (Index i = 0; i < problem.means.rows(); ++i) {
        q = problem.measurements.configurations.row(i).transpose();
        campaign.robot.differentiate(parameters.world_from_base, q, parameters.robot, motion);
        r.col(0) = problem.means.row(i).transpose() -
                   campaign.sensor->predict(motion.world_from_flange, parameters.sensor);
        whiten(mean_covariance(campaign, motion, parameters.sensor,
                               static_cast<double>(problem.measurements.sample_count(i))),
               r);
        sum += r.squaredNorm();
    }
    return sum;
}

Triangle triangularise(const LinearisedSystem& system) {
    const Index size = system.J.cols();
    MatrixXd augmented(system.J.rows(), size + 1);
    augmented << system.J, system.r;
    const Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> qr(augmented);
    return {MatrixXd(augmented.topLeftCorner(size, size).triangularView<Eigen::Upper>()),
            augmented.col(size).head(size)};
}

void check_identifiable(const IdentificationProblem& problem, const Parameters& parameters) {
    Parameters nominal = parameters;
    nominal.robot.setZero();
    MatrixXd R = triangularise(linearise(problem, nominal)).R;
    const VectorXd norms = R.colwise().norm().transpose().cwiseMax(1e-300);
    R.array().rowwise() /= norms.transpose().array();
    const WeakDirection weakest = weakest_directions(R, 1).front();
    const double largest = std::sqrt(static_cast<double>(R.cols()));  // unit columns: s1 <= sqrt(L)
    if (weakest.singular_value > 1e-9 * largest) return;

    const auto names = parameter_names(problem.campaign);
    std::string words;
    for (const ParameterTerm& term : weakest.terms) {
        if (std::abs(term.coefficient) < 1e-6) continue;
        words += (words.empty() ? "" : ", ") + names[static_cast<std::size_t>(term.parameter)];
    }
    throw InputError(fmt::format(
        "these {} configurations cannot tell apart the effects of: {}; measure more or more "
        "different configurations, or leave one of these parameters out",
        problem.means.rows(), words));
}

void finish(const IdentificationProblem& problem, Estimate& estimate) {
    const LinearisedSystem system = linearise(problem, estimate.parameters);
    const Index size = system.J.cols();
    const MatrixXd R = triangularise(system).R;
    const MatrixXd inverse = problem.scale.asDiagonal() *
                             R.triangularView<Eigen::Upper>().solve(MatrixXd::Identity(size, size));
    estimate.degrees_of_freedom = system.r.size() - size;
    estimate.variance_factor =
        estimate.degrees_of_freedom > 0
            ? system.r.squaredNorm() / static_cast<double>(estimate.degrees_of_freedom)
            : 1.0;
    estimate.covariance = estimate.variance_factor * inverse * inverse.transpose();
    estimate.names = parameter_names(problem.campaign);
    estimate.fit =
        make_metrics(residuals(problem.campaign, estimate.parameters, problem.measurements));
    estimate.fit_means =
        make_metrics(mean_residuals(problem.campaign, estimate.parameters, problem.measurements));
}

}  // namespace posewise
