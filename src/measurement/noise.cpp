#include "noise.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "../core/decompositions.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// J_q diag(s): how far one standard deviation of each joint moves the observation.
RowMatrixXd joint_noise_effect(const Campaign& campaign, const FlangeMotion& motion,
                               const VectorXd& sensor_unknowns) {
    RowMatrixXd J(campaign.sensor->row_count(), motion.joint_twists.cols());
    campaign.sensor->differentiate(motion.world_from_flange, motion.joint_twists, sensor_unknowns,
                                   J);
    return J * campaign.joint_repeatability.asDiagonal();
}

InputError not_positive_definite(const MatrixXd& covariance) {
    const std::string rule = ", must be positive definite";
    if (!covariance.allFinite()) {
        return InputError(
            "the covariance of the observation's noise has a value that is not a "
            "finite number" +
            rule);
    }
    const auto eigen = eigen_decomposition(covariance, Eigen::EigenvaluesOnly);
    return InputError(fmt::format(
        "the covariance of the observation's noise ({0} x {0}) has the least eigenvalue {1:.3g} "
        "where the largest is {2:.3g}{3}",
        covariance.rows(), eigen.eigenvalues()[0], eigen.eigenvalues().tail(1)[0], rule));
}

bool is_sigma(double value) { return std::isfinite(value) && value >= 0; }

}  // namespace

void check_noise(const Campaign& campaign) {
    const auto check_model_error = [](double value, const char* unit) {
        if (is_sigma(value)) return;
        throw InputError(
            fmt::format("model error is {:g} {}, must be finite and not negative", value, unit));
    };
    check_model_error(campaign.model_error, "m");
    check_model_error(campaign.model_error_orientation, "rad");
    const VectorXd& s = campaign.joint_repeatability;
    if (s.size() != 0 && s.size() != campaign.robot.joint_count()) {
        throw InputError("joint repeatability has " + std::to_string(s.size()) +
                         " values, the robot has " + std::to_string(campaign.robot.joint_count()) +
                         " joints");
    }
    for (Index j = 0; j < s.size(); ++j) {
        if (is_sigma(s[j])) continue;
        throw InputError(
            fmt::format("repeatability of joint '{}' is {:g}, must be finite and not negative",
                        campaign.robot.joints()[static_cast<std::size_t>(j)].name, s[j]));
    }
}

VectorXd model_error_of_rows(const Campaign& campaign) {
    VectorXd errors(campaign.sensor->row_count());
    for (Index row = 0; row < errors.size(); ++row) {
        errors[row] = campaign.sensor->is_angle(row) ? campaign.model_error_orientation
                                                     : campaign.model_error;
    }
    return errors;
}

MatrixXd mean_covariance(const Campaign& campaign, const FlangeMotion& motion,
                         const VectorXd& sensor_unknowns, const VectorXd& repeats) {
    const Sensor& sensor = *campaign.sensor;
    const Index width = sensor.rows_per_target();
    const std::vector<Index> rows = seen_rows(repeats.array() > 0, width);
    MatrixXd covariance = sensor.covariance(motion.world_from_flange, sensor_unknowns)(rows, rows);
    for (Index k = 0; k < covariance.rows(); ++k) {  // targets are independent of each other
        covariance.row(k) /= repeats[rows[static_cast<std::size_t>(k)] / width];
    }
    covariance.diagonal() += model_error_of_rows(campaign)(rows).cwiseAbs2();
    if (campaign.joint_repeatability.size() > 0) {
        const RowMatrixXd effect =
            joint_noise_effect(campaign, motion, sensor_unknowns)(rows, Eigen::all);
        covariance.noalias() += effect * effect.transpose();
    }
    return covariance;
}

MatrixXd mean_covariance(const Campaign& campaign, const FlangeMotion& motion,
                         const VectorXd& sensor_unknowns, double repeats) {
    return mean_covariance(campaign, motion, sensor_unknowns,
                           VectorXd::Constant(campaign.sensor->target_count(), repeats));
}

bool has_constant_noise(const Campaign& campaign) {
    return campaign.joint_repeatability.size() == 0 && campaign.sensor->has_constant_covariance();
}

MatrixXd mean_covariance_rate(const Campaign& campaign, const FlangeMotion& motion, Index joint,
                              const FlangeMotionRate& rate, const VectorXd& sensor_unknowns,
                              double repeats) {
    const Twist direction = motion.joint_twists.col(joint);
    MatrixXd covariance_rate =
        campaign.sensor->covariance_rate(motion.world_from_flange, direction, sensor_unknowns) /
        repeats;
    if (campaign.joint_repeatability.size() > 0) {
        const RowMatrixXd effect = joint_noise_effect(campaign, motion, sensor_unknowns);
        RowMatrixXd effect_rate(effect.rows(), effect.cols());
        campaign.sensor->differentiate_along(motion.world_from_flange, motion.joint_twists,
                                             direction, rate.joint_twists, sensor_unknowns,
                                             effect_rate);
        const MatrixXd half =
            effect_rate * campaign.joint_repeatability.asDiagonal() * effect.transpose();
        covariance_rate += half + half.transpose();
    }
    return covariance_rate;
}

double whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows) {
    const auto variances = covariance.diagonal().array();
    if (covariance.isDiagonal(0) && (variances > 0).all()) {
        rows.array().colwise() *= variances.rsqrt();
        return variances.log().sum() / 2;
    }
    const MatrixXd L = cholesky_factor(covariance);
    L.triangularView<Eigen::Lower>().solveInPlace(rows);
    return L.diagonal().array().log().sum();
}

RowMatrixXd whiten_seen(const Campaign& campaign, const FlangeMotion& motion,
                        const VectorXd& sensor_unknowns, const VectorXd& repeats,
                        const RowMatrixXd& rows) {
    const Index width = campaign.sensor->rows_per_target();
    RowMatrixXd seen = rows(seen_rows(repeats.array() > 0, width), Eigen::all);
    whiten(mean_covariance(campaign, motion, sensor_unknowns, repeats), seen);
    return seen;
}

MatrixXd cholesky_factor(const MatrixXd& covariance) {
    const Eigen::LLT<MatrixXd> cholesky(covariance);
    // Of what is not a number LLT says success.
    if (cholesky.info() != Eigen::Success || !cholesky.matrixLLT().diagonal().allFinite()) {
        throw not_positive_definite(covariance);
    }
    return cholesky.matrixL();
}

}  // namespace posewise::detail
