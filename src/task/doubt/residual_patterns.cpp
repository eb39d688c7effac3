#include "residual_patterns.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "task/calibration/identify_anew.hpp"

namespace posewise::detail {
namespace {

constexpr Index base_columns = 6;

/// Twists of the world's translations and of rotations about the base's origin, then of joints.
TwistMatrix twists_of(const Campaign& campaign, const Parameters& parameters, const VectorXd& q,
                      FlangeMotion& motion) {
    campaign.robot.differentiate(parameters.world_from_base, q, parameters.robot, motion);
    TwistMatrix twists = TwistMatrix::Zero(6, base_columns + motion.joint_twists.cols());
    const Vector3d origin = parameters.world_from_base.translation();
    for (Index k = 0; k < 3; ++k) {
        const Vector3d axis = Vector3d::Unit(k);
        twists.col(k).tail<3>() = axis;
        twists.col(3 + k).head<3>() = axis;
        twists.col(3 + k).tail<3>() = origin.cross(axis);
    }
    twists.rightCols(motion.joint_twists.cols()) = motion.joint_twists;
    return twists;
}

/// Of the robot's errors in their expected sizes.
double mean_square_error(const Campaign& campaign, const Estimate& estimate) {
    const VectorXd& errors = estimate.parameters.robot;
    const VectorXd sizes =
        parameter_scale(campaign).segment(base_parameter_count(campaign), errors.size());
    return errors.cwiseQuotient(sizes).squaredNorm() / static_cast<double>(errors.size());
}

Measurements with_scaled_lengths(const Sensor& sensor, Measurements measured, double factor) {
    for (Index row = 0; row < measured.observations.cols(); ++row) {
        if (!sensor.is_angle(row)) measured.observations.col(row) *= factor;
    }
    return measured;
}

}  // namespace

bool tells_lengths(const Sensor& sensor) { return sensor.has_lengths() && !sensor.has_contacts(); }

std::optional<Fitted> fit_again(const Campaign& campaign, const Measurements& measured,
                                const Loss& loss) {
    LevenbergMarquardtOptions options;
    options.loss.kind = loss.kind;
    const auto estimate = identify_anew(campaign, measured, options);
    if (!estimate) return std::nullopt;
    return Fitted{campaign, measured, *estimate};
}

FittedProblem::FittedProblem(const Fitted& fitted)
    : found(with_model_error(fitted.campaign, fitted.estimate)),
      problem(make_problem(found, fitted.measured)) {
    problem.loss = fitted.estimate.loss;
    problem.deviation = std::sqrt(fitted.estimate.variance_factor);
}

double held_out_rms(const Fitted& fitted) {
    const FittedProblem linearised(fitted);
    const auto fit = linear_fit(linearised.problem, fitted.estimate.parameters);
    if (!fit) return fitted.estimate.fit.rms();
    return fitted.estimate.fit.rms() * std::sqrt(held_out_ratio(*fit));
}

PatternColumns::PatternColumns(const FittedProblem& fitted, const Parameters& parameters) {
    const Campaign& campaign = fitted.found;
    const Sensor& sensor = *campaign.sensor;
    const Measurements& means = fitted.problem.means;
    first_unknown_ = base_columns + campaign.robot.joint_count();
    lengths_ = first_unknown_ + parameters.sensor.size();
    const Index shifts = sensor.lengths_per_target() == 3 ? 3 : 0;
    FlangeMotion motion;
    all_ = whitened_columns(fitted.problem, parameters, lengths_ + 1 + shifts,
                            [&](Index i, Eigen::Ref<RowMatrixXd> columns) {
                                const VectorXd q = means.configurations.row(i).transpose();
                                const TwistMatrix twists =
                                    twists_of(campaign, parameters, q, motion);
                                columns.setZero();
                                sensor.differentiate(motion.world_from_flange, twists,
                                                     parameters.sensor, columns.leftCols(lengths_));
                                for (Index row = 0; row < columns.rows(); ++row) {
                                    if (tells_lengths(sensor) && !sensor.is_angle(row) &&
                                        means.is_seen(i, sensor.target_of(row))) {
                                        columns(row, lengths_) = means.observations(i, row);
                                    }
                                    const Index axis = sensor.column_of(row);
                                    if (axis < shifts) columns(row, lengths_ + 1 + axis) = 1;
                                }
                            });
}

RowMatrixXd PatternColumns::unknowns(const std::vector<Index>& which) const {
    RowMatrixXd columns(all_.rows(), std::ssize(which));
    for (Index k = 0; k < columns.cols(); ++k) {
        columns.col(k) = all_.col(first_unknown_ + which[static_cast<std::size_t>(k)]);
    }
    return columns;
}

std::optional<LengthFactor> find_length_factor(const Fitted& fitted, const PatternColumns& columns,
                                               const LinearFit& fit) {
    constexpr double another_unit = 0.2;  // or another robot
    const Campaign& campaign = fitted.campaign;
    if (!tells_lengths(*campaign.sensor) || campaign.robot.parameter_count() == 0) {
        return std::nullopt;
    }
    // A robot whose errors are larger than expected may well be longer as a whole, too.
    const double before = mean_square_error(campaign, fitted.estimate);
    const double prior_scale = std::max(1.0, before);
    const Score found = score(fit, columns.lengths(), prior_scale);
    if (found.columns == 0) return std::nullopt;
    LengthFactor factor{found.effect[0], found.deviations[0]};
    const double excess = factor.excess;
    if (std::abs(excess) > another_unit) return std::nullopt;
    if (!found.is_beyond(chance_of_factor)) return factor;
    const auto scaled = fit_again(
        campaign, with_scaled_lengths(*campaign.sensor, fitted.measured, 1 / (1 + excess)),
        fitted.estimate.loss);
    if (!scaled) return factor;
    // What is left over, of a model that lacks something, may follow a factor, too: at least half
    // of what tells of it must be the robot's errors.
    const double after = mean_square_error(campaign, scaled->estimate);
    const auto count = static_cast<double>(campaign.robot.parameter_count());
    if ((before - after) * count >= 0.5 * found.statistic * prior_scale) {
        factor.errors = {std::sqrt(before), std::sqrt(after)};
    }
    return factor;
}

std::vector<JointPattern> find_joint_patterns(const Fitted& fitted, const PatternColumns& columns,
                                              const LinearFit& fit) {
    // Errors of joints that turn, as bending, go with their value in part.
    constexpr double plain = 0.5;
    const Chain& robot = fitted.campaign.robot;
    const RowMatrixXd& q = fitted.measured.configurations;
    const std::vector<Index> all = all_but(fit.count(), {});
    const double rms = held_out_rms(fitted);
    std::vector<JointPattern> patterns;
    double best = 1;
    const auto try_pattern = [&](const LinearFit& without, Index j, JointPattern::Kind kind,
                                 const auto& amount) {
        RowMatrixXd X = columns.joint(j);
        for (Index i = 0; i < fit.count(); ++i) {
            X.middleRows(fit.begin(i), fit.rows(i)) *= amount(i);
        }
        const Score found = score(without, X);
        if (!found.is_beyond(chance_of_joint / static_cast<double>(2 * robot.joint_count()))) {
            return;
        }
        const double share = held_out_squares(found.with, all) / held_out_squares(without, all);
        const bool turns = robot.joint(j).motion == Motion::Rotation;
        const bool is_scale = kind == JointPattern::Kind::Scale;
        if (share > std::min(best, is_scale && turns ? plain : material)) return;
        best = share;
        const double sides = kind == JointPattern::Kind::Backlash ? 2 : 1;
        patterns = {{robot.joint(j).name,
                     kind,
                     sides * found.effect[0],
                     turns,
                     {rms, rms * std::sqrt(share)}}};
    };
    for (Index j = 0; j < robot.joint_count(); ++j) {
        // Beside another zero of it, which not every model has.
        const LinearFit without = score(fit, columns.joint(j)).with;
        try_pattern(without, j, JointPattern::Kind::Scale, [&](Index i) { return q(i, j); });
        try_pattern(without, j, JointPattern::Kind::Backlash, [&](Index i) {
            const double step = i == 0 ? 0 : q(i, j) - q(i - 1, j);
            return step > 0 ? 1.0 : step < 0 ? -1.0 : 0.0;
        });
    }
    return patterns;
}

}  // namespace posewise::detail
