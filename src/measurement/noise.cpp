#include "noise.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "core/decompositions.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

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

/// Where the targets are on the flange: their middle, and the RMS of their distances from it, m.
struct TargetGroup {
    Vector3d middle = Vector3d::Zero();
    double lever = 0;
};
TargetGroup group_of_targets(const Sensor& sensor, const VectorXd& sensor_unknowns) {
    TargetGroup group;
    const Index count = sensor.position_count();
    for (Index j = 0; j < count; ++j) group.middle += sensor.counted_position(j, sensor_unknowns);
    group.middle /= static_cast<double>(count);
    double squares = 0;
    for (Index j = 0; j < count; ++j) {
        squares += (sensor.counted_position(j, sensor_unknowns) - group.middle).squaredNorm();
    }
    group.lever = std::sqrt(squares / static_cast<double>(count));
    return group;
}

// Half of a target's variance is the translation's, half the rotation's: of three turns about the
// axes, two move the end of a lever.
struct MotionShares {
    double translation = 1;
    double turn = 0;  ///< rad for 1 m at the targets
};
MotionShares shares_of(const Campaign& campaign, const TargetGroup& group) {
    if (campaign.sensor->has_pixels()) {
        const double turn = campaign.model_error_orientation;
        return {1, campaign.model_error > 0 ? turn / campaign.model_error : 0};
    }
    if (!(group.lever > 0)) return {};  // all in one place, which no turn moves
    return {std::sqrt(0.5), std::sqrt(0.75) / group.lever};
}

}  // namespace

void check_noise(const Campaign& campaign) {
    const auto check_model_error = [](double value, const char* unit) {
        if (is_sigma(value)) return;
        throw InputError(
            fmt::format("model error is {:g} {}, must be finite and not negative", value, unit));
    };
    check_model_error(campaign.model_error, "m");
    check_model_error(campaign.model_error_orientation, "rad");
    const double common = campaign.model_error_common.value_or(0);
    if (!(common >= 0 && common <= 1)) {
        throw InputError(
            fmt::format("the common part of the model error is {:g}, must be from 0 to 1", common));
    }
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

TwistMatrix model_error_twists(const Campaign& campaign, const Isometry3d& world_from_flange,
                               const VectorXd& sensor_unknowns) {
    TwistMatrix twists(6, 6);
    set_model_error_twists(campaign, world_from_flange, sensor_unknowns, twists);
    return twists;
}

void set_model_error_twists(const Campaign& campaign, const Isometry3d& world_from_flange,
                            const VectorXd& sensor_unknowns, TwistMatrix& twists) {
    const TargetGroup group = group_of_targets(*campaign.sensor, sensor_unknowns);
    const Vector3d p = world_from_flange * group.middle;
    const auto [translation, turn] = shares_of(campaign, group);
    twists.setZero(6, 6);
    for (Index k = 0; k < 3; ++k) {
        twists(3 + k, k) = translation;
        twists(k, 3 + k) = turn;
        twists.block<3, 1>(3, 3 + k) = turn * p.cross(Vector3d::Unit(k));
    }
}

double common_part(const Campaign& campaign) {
    const Sensor& sensor = *campaign.sensor;
    if (sensor.has_only_pixels()) return 1;
    if (sensor.seen_at_once() <= 1) return 0;
    const bool is_usual = campaign.spread.is_prior || sensor.has_pixels();
    return campaign.model_error_common.value_or(is_usual ? usual_model_error_common : 0);
}

double common_model_error(const Campaign& campaign) {
    return std::sqrt(common_part(campaign)) * campaign.model_error;
}

VectorXd own_model_errors(const Campaign& campaign) {
    const double own = std::sqrt(1 - common_part(campaign)) * campaign.model_error;
    VectorXd errors(campaign.sensor->row_count());
    for (Index row = 0; row < errors.size(); ++row) {
        const bool is_angle = campaign.sensor->is_angle(row);
        const double of_angle =
            campaign.sensor->has_pixels() ? 0 : campaign.model_error_orientation;
        errors[row] = is_angle ? of_angle : own;
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
    return campaign.joint_repeatability.size() == 0 && common_model_error(campaign) == 0 &&
           campaign.sensor->has_constant_covariance();
}

Matrix6d flange_covariance(const Campaign& campaign, const FlangeMotion& motion,
                           const VectorXd& sensor_unknowns) {
    Matrix6d C = Matrix6d::Zero();
    const VectorXd& sizes = campaign.joint_repeatability;
    if (sizes.size() > 0) {
        C = motion.joint_twists * sizes.cwiseAbs2().asDiagonal() * motion.joint_twists.transpose();
    }
    if (const double common = common_model_error(campaign); common > 0) {
        const Matrix6d twists =
            model_error_twists(campaign, motion.world_from_flange, sensor_unknowns);
        C += common * common * twists * twists.transpose();
    }
    return C;
}

Matrix6d flange_covariance_rate(const Campaign& campaign, const FlangeMotion& motion, Index joint,
                                const FlangeMotionRate& rate, const VectorXd& sensor_unknowns) {
    Matrix6d half = Matrix6d::Zero();
    const VectorXd& sizes = campaign.joint_repeatability;
    if (sizes.size() > 0) {
        half = rate.joint_twists * sizes.cwiseAbs2().asDiagonal() * motion.joint_twists.transpose();
    }
    if (const double common = common_model_error(campaign); common > 0) {
        const TargetGroup group = group_of_targets(*campaign.sensor, sensor_unknowns);
        const Vector3d p = motion.world_from_flange * group.middle;
        const Vector3d p_rate =
            shares_of(campaign, group).turn * velocity_of(p, motion.joint_twists.col(joint));
        Matrix6d rates = Matrix6d::Zero();
        for (Index k = 0; k < 3; ++k) {
            rates.block<3, 1>(3, 3 + k) = p_rate.cross(Vector3d::Unit(k));
        }
        const Matrix6d twists =
            model_error_twists(campaign, motion.world_from_flange, sensor_unknowns);
        half += common * common * rates * twists.transpose();
    }
    return half + half.transpose();
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
      common_(common_model_error(campaign)),
      own_variances_(own_model_errors(campaign).cwiseAbs2()),
      of_sensor_(campaign.sensor->row_count(), campaign.sensor->row_count()),
      effect_(campaign.sensor->row_count(),
              campaign.joint_repeatability.size() + (common_ > 0 ? 6 : 0)) {}

const MatrixXd& PoseNoise::covariance(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                                      const VectorXd& repeats) {
    const MatrixXd& own = own_covariance(motion, sensor_unknowns, repeats);
    if (effect_.cols() == 0) return own;
    covariance_ = own;
    add_effects(motion, sensor_unknowns);
    return covariance_;
}

const MatrixXd& PoseNoise::own_covariance(const FlangeMotion& motion,
                                          const VectorXd& sensor_unknowns,
                                          const VectorXd& repeats) {
    const Sensor& sensor = *campaign_.sensor;
    const bool is_same = repeats_.size() > 0 && repeats_ == repeats;
    if (is_same && sensor.has_constant_covariance()) return own_;
    if (!is_same) {
        repeats_ = repeats;
        rows_ = seen_rows(sensor, repeats.array() > 0);
    }
    sensor.covariance(motion.world_from_flange, sensor_unknowns, of_sensor_);
    const Index count = std::ssize(rows_);
    own_.resize(count, count);
    own_.setZero();
    for (Index k = 0; k < count;) {  // targets are independent of each other
        const Index row = rows_[static_cast<std::size_t>(k)];
        const Index target = sensor.target_of(row);
        const Index width = sensor.rows_of(target);
        auto of_target = own_.block(k, k, width, width);
        of_target = of_sensor_.block(row, row, width, width) / repeats[target];
        of_target.diagonal() += own_variances_.segment(row, width);
        k += width;
    }
    return own_;
}

void PoseNoise::add_effects(const FlangeMotion& motion, const VectorXd& sensor_unknowns) {
    const Index joints = campaign_.joint_repeatability.size();
    const auto fill = [&](const TwistMatrix& twists, auto columns) {
        campaign_.sensor->differentiate(motion.world_from_flange, twists, sensor_unknowns, columns);
    };
    if (joints > 0) {
        fill(motion.joint_twists, effect_.leftCols(joints));
        effect_.leftCols(joints) *= campaign_.joint_repeatability.asDiagonal();
    }
    if (common_ > 0) {
        set_model_error_twists(campaign_, motion.world_from_flange, sensor_unknowns, twists_);
        fill(twists_, effect_.rightCols<6>());
        effect_.rightCols<6>() *= common_;
    }
    seen_effect_.resize(covariance_.rows(), effect_.cols());
    for (Index k = 0; k < covariance_.rows(); ++k) {
        seen_effect_.row(k) = effect_.row(rows_[static_cast<std::size_t>(k)]);
    }
    raise_to_rounding(covariance_, seen_effect_.squaredNorm());
    covariance_.noalias() += seen_effect_ * seen_effect_.transpose();
}

void raise_to_rounding(MatrixXd& covariance, double trace) {
    constexpr double rounding = 1e-14;
    if (covariance.rows() == 0) return;  // nothing is seen
    if (covariance.diagonal().minCoeff() > rounding * trace) return;
    covariance.diagonal().array() += rounding * trace;
}

Index PoseNoise::whiten_seen(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                             const VectorXd& repeats, Eigen::Ref<RowMatrixXd> rows) {
    const MatrixXd& of_mean = covariance(motion, sensor_unknowns, repeats);
    const Index count = take_seen(rows);
    whiten(of_mean, rows.topRows(count), factor_);
    return count;
}

Index PoseNoise::take_seen(Eigen::Ref<RowMatrixXd> rows) const {
    const Index count = std::ssize(rows_);
    for (Index k = 0; k < count; ++k) {
        const Index row = rows_[static_cast<std::size_t>(k)];
        if (row != k) rows.row(k) = rows.row(row);
    }
    return count;
}

RowMatrixXd PoseNoise::triangle_of_seen(const FlangeMotion& motion, const VectorXd& sensor_unknowns,
                                        const VectorXd& repeats, Eigen::Ref<RowMatrixXd> rows) {
    const MatrixXd& own = own_covariance(motion, sensor_unknowns, repeats);
    const Index count = take_seen(rows);
    whiten(own, rows.topRows(count), factor_);
    RowMatrixXd R = triangular_factor(rows.topRows(count));
    whiten(
        with_flange_motion(R.leftCols<6>(), flange_covariance(campaign_, motion, sensor_unknowns)),
        R);
    return R;
}

MatrixXd with_flange_motion(const Eigen::Ref<const MatrixXd>& R_6, const Matrix6d& C) {
    MatrixXd shared = MatrixXd::Identity(R_6.rows(), R_6.rows());
    const MatrixXd by_flange = R_6 * C * R_6.transpose();
    raise_to_rounding(shared, by_flange.trace());
    shared += by_flange;
    return shared;
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
