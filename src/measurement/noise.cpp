#include "noise.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/decompositions.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// J_q diag(s): how far one standard deviation of each joint moves the observation.
void fill_joint_effect(const Campaign& campaign, const FlangeMotion& motion,
                       const VectorXd& sensor_unknowns, Eigen::Ref<RowMatrixXd> effect) {
    campaign.sensor->differentiate(motion.world_from_flange, motion.joint_twists, sensor_unknowns,
                                   effect);
    effect *= campaign.joint_repeatability.asDiagonal();
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

/// In its own memory: L is its lower half then. False: it is not positive definite.
bool factorise(MatrixXd& covariance) {
    const Eigen::LLT<Eigen::Ref<MatrixXd>> cholesky(covariance);
    // Of what is not a number LLT says success.
    return cholesky.info() == Eigen::Success && covariance.diagonal().allFinite();
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
    return PoseNoise(campaign).covariance(motion, sensor_unknowns, repeats);
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
        RowMatrixXd effect(campaign.sensor->row_count(), motion.joint_twists.cols());
        fill_joint_effect(campaign, motion, sensor_unknowns, effect);
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

void whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows) {
    MatrixXd factor;
    whiten(covariance, rows, factor);
}

void whiten(const MatrixXd& covariance, Eigen::Ref<RowMatrixXd> rows, MatrixXd& factor,
            double* log_deviations) {
    const auto variances = covariance.diagonal().array();
    if (covariance.isDiagonal(0) && (variances > 0).all()) {
        for (Index k = 0; k < rows.rows(); ++k) rows.row(k) *= 1 / std::sqrt(variances[k]);
        if (log_deviations != nullptr) *log_deviations += variances.log().sum() / 2;
        return;
    }
    factor = covariance;
    if (!factorise(factor)) throw not_positive_definite(covariance);
    factor.triangularView<Eigen::Lower>().solveInPlace(rows);
    if (log_deviations != nullptr) *log_deviations += factor.diagonal().array().log().sum();
}

PoseNoise::PoseNoise(const Campaign& campaign)
    : campaign_(campaign),
      is_constant_(has_constant_noise(campaign)),
      model_variances_(model_error_of_rows(campaign).cwiseAbs2()),
      of_sensor_(campaign.sensor->row_count(), campaign.sensor->row_count()),
      joint_effect_(campaign.sensor->row_count(), campaign.joint_repeatability.size()) {}

const MatrixXd& PoseNoise::covariance(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                                      const VectorXd& repeats) {
    const bool is_same = repeats_.size() > 0 && repeats_ == repeats;
    if (is_same && is_constant_) return covariance_;
    const Sensor& sensor = *campaign_.sensor;
    const Index width = sensor.rows_per_target();
    if (!is_same) {
        repeats_ = repeats;
        rows_ = seen_rows(repeats.array() > 0, width);
    }
    sensor.covariance(motion.world_from_flange, sensor_unknowns, of_sensor_);
    const Index count = std::ssize(rows_);
    covariance_.resize(count, count);
    for (Index k = 0; k < count; ++k) {  // targets are independent of each other
        const Index row = rows_[static_cast<std::size_t>(k)];
        for (Index i = 0; i < count; ++i) {
            const double of_one = of_sensor_(row, rows_[static_cast<std::size_t>(i)]);
            covariance_(k, i) = of_one / repeats[row / width];
        }
        covariance_(k, k) += model_variances_[row];
    }
    if (joint_effect_.cols() > 0) add_joint_noise(motion, sensor_unknowns);
    return covariance_;
}

void PoseNoise::add_joint_noise(const FlangeMotion& motion, const VectorXd& sensor_unknowns) {
    fill_joint_effect(campaign_, motion, sensor_unknowns, joint_effect_);
    seen_joint_effect_.resize(covariance_.rows(), joint_effect_.cols());
    for (Index k = 0; k < covariance_.rows(); ++k) {
        seen_joint_effect_.row(k) = joint_effect_.row(rows_[static_cast<std::size_t>(k)]);
    }
    covariance_.noalias() += seen_joint_effect_ * seen_joint_effect_.transpose();
}

Index PoseNoise::whiten_seen(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                             const VectorXd& repeats, Eigen::Ref<RowMatrixXd> rows) {
    const MatrixXd& of_mean = covariance(motion, sensor_unknowns, repeats);
    const Index count = of_mean.rows();
    for (Index k = 0; k < count; ++k) {
        const Index row = rows_[static_cast<std::size_t>(k)];
        if (row != k) rows.row(k) = rows.row(row);
    }
    whiten(of_mean, rows.topRows(count), factor_);
    return count;
}

MatrixXd cholesky_factor(const MatrixXd& covariance) {
    MatrixXd L;
    cholesky_factor(covariance, L);
    return L;
}

void cholesky_factor(const MatrixXd& covariance, MatrixXd& L) {
    L = covariance;
    if (!factorise(L)) throw not_positive_definite(covariance);
    L.triangularView<Eigen::StrictlyUpper>().setZero();
}

}  // namespace posewise::detail
