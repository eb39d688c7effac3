#include "model_error.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/decompositions.hpp"
#include "core/products.hpp"
#include "jacobian/whitened_pose.hpp"
#include "measurement/noise.hpp"
#include "posewise/jacobian/identification.hpp"
#include "robust.hpp"

namespace posewise::detail {
namespace {

/// The smallest that is looked for, in expected ones.
constexpr double least_part = 0.1;
/// More configurations would not tell the two numbers any better.
constexpr Index most_configurations = 400;
/// A direction that one configuration alone determines has no prediction by the others.
constexpr double undetermined = 1e-10;

const double log_factor = std::log(model_error_factor);

/// log of the model error's translation and rotation.
using LogErrors = std::array<double, 2>;

/// How a configuration's readings follow from far fewer numbers x with variance 1: they are
/// basis x + rest, with errors of the covariance `remainder`.
struct Narrowed {
    MatrixXd basis;
    VectorXd rest;
    MatrixXd remainder;
};

class PredictiveScore {
  public:
    PredictiveScore(const IdentificationProblem& problem, const Parameters& parameters,
                    const Campaign& expected)
        : expected_{std::log(expected.model_error), std::log(expected.model_error_orientation)},
          common_(common_part(expected)),
          size_(problem.units.size()),
          prior_begin_(problem.prior_begin()),
          prior_errors_(problem.prior_count() > 0
                            ? problem.units.prior_coordinates(problem.campaign, parameters)
                            : VectorXd()) {
        collect(problem, parameters);
        count_freedom({std::log(problem.campaign.model_error),
                       std::log(problem.campaign.model_error_orientation)});
    }

    bool has(std::size_t kind) const { return has_[kind]; }

    double operator()(const LogErrors& errors, std::size_t kind) {
        whiten(errors);
        return freedom_[kind] * predict() + population(errors);
    }

  private:
    void collect(const IdentificationProblem& problem, const Parameters& parameters) {
        Campaign without = problem.campaign;
        without.model_error = without.model_error_orientation = 0;
        const Sensor& sensor = *without.sensor;
        RowMatrixXd times = problem.repeats;
        if (problem.loss.kind != LossKind::Squares) {
            for (const Outlier& outlier : find_outliers(problem, parameters)) {
                times(outlier.configuration, outlier.target) = 0;
            }
        }
        const std::vector<Index> configurations =
            evenly_spaced(problem.means.configuration_count(), most_configurations);
        const Index most_rows = std::ssize(configurations) * sensor.row_count();
        stated_.resize(most_rows, size_ + 1);
        covariances_.resize(most_rows, sensor.row_count());
        effects_.resize(most_rows, 6);
        RowMatrixXd all(sensor.row_count(), size_ + 1);
        RowMatrixXd effect = RowMatrixXd::Zero(sensor.row_count(), 6);
        const bool is_narrow = sensor.has_only_pixels() && pays_narrowly(sensor, parameters);
        PoseNoise noise(without);
        FlangeMotion motion;
        VectorXd q, repeats, predicted(sensor.row_count()), deviation(sensor.row_count());
        Index row = 0;
        for (const Index i : configurations) {
            q = problem.means.configurations.row(i).transpose();
            repeats = times.row(i).transpose();
            if ((repeats.array() == 0).all()) continue;
            differentiate_flange(without, parameters, q, motion);
            sensor.predict(motion.world_from_flange, parameters.sensor, predicted);
            sensor.deviation(problem.means.observations.row(i).transpose(), predicted, deviation);
            TwistMatrix moves;
            if (common_ > 0) {
                moves = model_error_twists(problem.campaign, motion.world_from_flange,
                                           parameters.sensor);
            }
            const MatrixXd& covariance = noise.covariance(motion, parameters.sensor, repeats);
            if (is_narrow) {
                RowMatrixXd A(sensor.row_count(), 6 + parameters.sensor.size());
                sensor.differentiate(motion.world_from_flange, TwistMatrix::Identity(6, 6),
                                     parameters.sensor, A);
                row += take_narrowly(A(noise.rows(), Eigen::all), deviation(noise.rows()),
                                     covariance, motion.twists, moves, row);
                first_row_.push_back(row);
                continue;
            }
            sensor.differentiate(motion.world_from_flange, motion.twists, parameters.sensor,
                                 all.leftCols(size_));
            all.col(size_) = deviation;
            if (common_ > 0) {
                sensor.differentiate(motion.world_from_flange, moves, parameters.sensor, effect);
            }
            const Index count = covariance.rows();
            covariances_.block(row, 0, count, count) = covariance;
            for (const Index of_all : noise.rows()) {
                effects_.row(row) = effect.row(of_all);
                stated_.row(row++) = all.row(of_all);
                is_angle_.push_back(sensor.is_angle(of_all));
                target_.push_back(sensor.target_of(of_all));
            }
            first_row_.push_back(row);
        }
        // Of pixels both move the flange together: one number is found.
        const bool has_pixels = sensor.has_pixels();
        has_pixels_ = has_pixels;
        has_ = {(sensor.has_lengths() || has_pixels) && std::isfinite(expected_[0]),
                sensor.has_angles() && !has_pixels && std::isfinite(expected_[1])};
        stated_.conservativeResize(row, Eigen::NoChange);
        problem.units.scale_columns(stated_.leftCols(size_));
        whitened_.resize(row, size_ + 1);
        if (common_ > 0) factors_.resize(row, sensor.row_count());
    }

    /// Writes one configuration in as few rows as tell the same, from `row` on; returns how many.
    /// With the readings' derivative A and residual r (WhitenedPose), L L^T = covariance and
    /// L^-1 A = Q R these are R E and x = Q^T L^-1 r. All that the flange moves is within them.
    Index take_narrowly(const RowMatrixXd& A, const VectorXd& r, const MatrixXd& covariance,
                        const TwistMatrix& twists, const TwistMatrix& moves, Index row) {
        const auto L = cholesky_factor(covariance);
        const auto lower = L.triangularView<Eigen::Lower>();
        const auto [Q, R] = orthogonal_factors(lower.solve(MatrixXd(A)));
        const Index count = R.rows();
        const VectorXd x = Q.transpose() * lower.solve(r);
        spread(RowMatrixXd(R), twists, stated_.block(row, 0, count, size_));
        stated_.col(size_).segment(row, count) = x;
        effects_.middleRows(row, count) = R.leftCols<6>() * moves;
        covariances_.block(row, 0, count, count).setIdentity();
        is_angle_.resize(is_angle_.size() + static_cast<std::size_t>(count), true);
        MatrixXd basis = lower * Q;
        VectorXd rest = r - basis * x;
        MatrixXd remainder = covariance - basis * basis.transpose();
        narrowed_.push_back({std::move(basis), std::move(rest), std::move(remainder)});
        return count;
    }

    Index row_count() const { return stated_.rows(); }
    /// Calls visit(configuration, first row, how many) for each.
    template <typename Visit>
    void for_each_configuration(const Visit& visit) const {
        for (std::size_t i = 0; i + 1 < first_row_.size(); ++i) {
            visit(i, first_row_[i], first_row_[i + 1] - first_row_[i]);
        }
    }

    /// All configurations under one pair of model errors.
    void whiten(const LogErrors& errors) {
        const std::array<double, 2> squares{std::exp(2 * errors[0]), std::exp(2 * errors[1])};
        whitened_ = stated_;
        log_deviations_ = 0;
        for_each_configuration([&](std::size_t, Index first, Index count) {
            covariance_ = covariances_.block(first, 0, count, count);
            if (common_ > 0) {
                const auto moved = effects_.middleRows(first, count);
                detail::raise_to_rounding(covariance_, common_ * squares[0] * moved.squaredNorm());
                covariance_.noalias() += common_ * squares[0] * moved * moved.transpose();
            }
            for (Index k = 0; k < count; ++k) {
                const bool is_angle = is_angle_[static_cast<std::size_t>(first + k)];
                if (is_angle && has_pixels_) continue;  // they have no error of their own
                covariance_(k, k) += has_[1] && is_angle ? squares[1] : (1 - common_) * squares[0];
            }
            if (common_ == 0) {
                detail::whiten(covariance_, whitened_.middleRows(first, count), factor_,
                               &log_deviations_);
                return;
            }
            cholesky_factor(covariance_, factor_);
            factor_.triangularView<Eigen::Lower>().solveInPlace(whitened_.middleRows(first, count));
            factors_.block(first, 0, count, count) = factor_;
        });
        const auto B = whitened_.leftCols(size_);
        const MatrixXd all = gram(whitened_);
        MatrixXd M = all.topLeftCorner(size_, size_);
        M.diagonal().segment(prior_begin_, prior_errors_.size()).array() += 1;
        const MatrixXd L = cholesky(M);
        V_.resize(0, 0);
        if (L.rows() < size_) return;
        const auto r = whitened_.col(size_);
        RowMatrixXd sides(size_, row_count() + 1);
        sides << B.transpose(), all.row(size_).head(size_).transpose();
        sides.col(row_count()).segment(prior_begin_, prior_errors_.size()) -= prior_errors_;
        const RowMatrixXd solved = solve_lower(L, sides);
        V_ = solved.leftCols(row_count());
        residuals_ = r - V_.transpose() * solved.col(row_count());
    }

    void count_freedom(const LogErrors& errors) {
        whiten(errors);
        if (V_.cols() < row_count()) return;
        const VectorXd used = V_.colwise().squaredNorm().transpose();
        std::array<double, 2> left{}, counts{};
        for (Index row = 0; row < row_count(); ++row) {
            const std::size_t kind = is_angle_[static_cast<std::size_t>(row)] ? 1 : 0;
            left[kind] += 1 - used[row];
            ++counts[kind];
        }
        for (const Narrowed& narrowed : narrowed_) {  // angles, of which nothing is used
            const auto dropped = static_cast<double>(narrowed.basis.rows() - narrowed.basis.cols());
            left[1] += dropped;
            counts[1] += dropped;
        }
        for (std::size_t kind = 0; kind < 2; ++kind) {
            const std::size_t rows = counts[kind] > 0 ? kind : 1 - kind;
            if (has_[kind]) freedom_[kind] = std::max(left[rows] / counts[rows], 0.0);
        }
    }

    /// Log of the predictive densities of the observations of each configuration, given all others.
    /// Where the targets of one share errors, those of each target by itself: how errors are shared
    /// is hardly known, and a wrong share would make the whole look smaller. They count as many as
    /// a body that moves has directions.
    double predict() {
        if (V_.cols() < row_count()) return -std::numeric_limits<double>::infinity();
        double score = -log_deviations_;
        for_each_configuration([&](std::size_t configuration, Index first, Index count) {
            const auto V_i = V_.middleCols(first, count);
            factor_.noalias() = -V_i.transpose() * V_i;
            factor_.diagonal().array() += 1 + undetermined;
            const Eigen::LLT<Eigen::Ref<MatrixXd>> root(factor_);
            if (root.info() != Eigen::Success) {
                score = -std::numeric_limits<double>::infinity();
                return;
            }
            predicted_ = residuals_.segment(first, count);
            root.matrixL().solveInPlace(predicted_);
            if (common_ == 0) {
                score += factor_.diagonal().array().log().sum() - predicted_.squaredNorm() / 2;
                return;
            }
            // The residuals left out, F (I - G)^-1 r, and their covariance F (I - G)^-1 F^T.
            const auto F = factors_.block(first, 0, count, count).triangularView<Eigen::Lower>();
            spread_.setIdentity(count, count);
            root.matrixL().solveInPlace(spread_);
            spread_ = spread_ * MatrixXd(F).transpose();
            root.matrixU().solveInPlace(predicted_);
            predicted_ = F * predicted_;
            if (narrowed_.empty()) {
                covariance_.noalias() = spread_.transpose() * spread_;
            } else {
                const auto& [basis, rest, remainder] = narrowed_[configuration];
                spread_ = spread_ * basis.transpose();
                covariance_ = remainder;
                covariance_.noalias() += spread_.transpose() * spread_;
                predicted_ = basis * predicted_ + rest;
            }
            constexpr double directions = 6;
            const Index readings = predicted_.size();
            score += std::min(1.0, directions / static_cast<double>(readings)) *
                     log_density_by_target(first, readings);
        });
        return score;
    }

    /// That of predicted_ under covariance_, target by target. `first`: the configuration's row.
    double log_density_by_target(Index first, Index count) {
        double sum = 0;
        for (Index row = 0; row < count;) {
            const Index width = width_of_target(first, row, count);
            const MatrixXd of_target = covariance_.block(row, row, width, width);
            const Eigen::LLT<MatrixXd> root(of_target);
            VectorXd e = predicted_.segment(row, width);
            root.matrixL().solveInPlace(e);
            sum -= root.matrixLLT().diagonal().array().log().sum() + e.squaredNorm() / 2;
            row += width;
        }
        return sum;
    }

    /// Of narrowed readings two: they are pixels.
    Index width_of_target(Index first, Index row, Index count) const {
        if (!narrowed_.empty()) return 2;
        const auto target = [&](Index k) { return target_[static_cast<std::size_t>(first + k)]; };
        Index end = row + 1;
        while (end < count && target(end) == target(row)) ++end;
        return end - row;
    }

    double population(const LogErrors& errors) const {
        double sum = 0;
        for (std::size_t kind = 0; kind < 2; ++kind) {
            if (!has_[kind]) continue;
            const double u = (errors[kind] - expected_[kind]) / log_factor;
            sum -= u * u / 2;
        }
        return sum;
    }

    LogErrors expected_;
    double common_;  ///< common_part()
    Index size_;
    Index prior_begin_;
    VectorXd prior_errors_;
    std::array<bool, 2> has_{};
    std::array<double, 2> freedom_{};  ///< part of the observations that parameters leave over

    // What the configurations tell, one after another.
    std::vector<Index> first_row_{0};  ///< configurations + 1
    std::vector<bool> is_angle_;
    std::vector<Index> target_;  ///< of each row, but of narrowed ones
    bool has_pixels_ = false;
    RowMatrixXd stated_;       ///< Jacobian by scaled parameters and residual, not whitened
    RowMatrixXd covariances_;  ///< but for the model error, of each as many columns as it has rows
    RowMatrixXd effects_;      ///< derivative by model_error_twists(), 6 columns
    std::vector<Narrowed> narrowed_;  ///< one for each; empty where all readings have rows

    // The same under one pair of model errors.
    RowMatrixXd whitened_;
    RowMatrixXd factors_;  ///< Cholesky factors of the covariances; only where targets share errors
    double log_deviations_ = 0;  ///< of the observations, summed up
    RowMatrixXd V_;              ///< B M^-1 B^T = V^T V; empty where M has no inverse
    VectorXd residuals_;         ///< at the optimum

    // Of one configuration.
    MatrixXd covariance_;
    MatrixXd factor_;
    MatrixXd spread_;
    VectorXd predicted_;
};

/// Where the smooth function `f` is largest: uphill from `x` in steps that grow, then by parabolas
/// through the best three points, until they move it by less than 1 %. That place and the value
/// there.
template <typename Function>
std::pair<double, double> climb(const Function& f, double x) {
    constexpr double tolerance = 0.01;
    constexpr double step = 0.5;
    std::array<double, 3> at{x - step, x, x + step};
    std::array<double, 3> value{f(at[0]), f(at[1]), f(at[2])};
    for (int moves = 0; moves < 20 && (value[0] > value[1] || value[2] > value[1]); ++moves) {
        if (value[0] > value[1]) {
            at = {2 * at[0] - at[1] - step, at[0], at[1]};
            value = {f(at[0]), value[0], value[1]};
        } else {
            at = {at[1], at[2], 2 * at[2] - at[1] + step};
            value = {value[1], value[2], f(at[2])};
        }
    }
    for (int refinement = 0; refinement < 8; ++refinement) {
        const double left = (at[1] - at[0]) * (value[1] - value[2]);
        const double right = (at[1] - at[2]) * (value[1] - value[0]);
        if (!(left - right > 0)) break;  // flat, or no number
        const double vertex =
            at[1] - ((at[1] - at[0]) * left - (at[1] - at[2]) * right) / (2 * (left - right));
        if (!(std::abs(vertex - at[1]) > tolerance)) break;
        const double reached = f(vertex);
        const std::size_t side = vertex < at[1] ? 0 : 2;
        if (reached > value[1]) {
            at[2 - side] = at[1];
            value[2 - side] = value[1];
            at[1] = vertex;
            value[1] = reached;
        } else {
            at[side] = vertex;
            value[side] = reached;
        }
    }
    return {at[1], value[1]};
}

/// Of x, where exp(f) is its density, by the curvature at the maximum, `highest` at x.
template <typename Function>
double deviation_at(const Function& f, double x, double highest) {
    constexpr double step = 0.25;
    const double least_curvature = 1 / (log_factor * log_factor);
    if (!std::isfinite(highest)) return log_factor;
    const double curvature = (2 * highest - f(x - step) - f(x + step)) / (step * step);
    return 1 / std::sqrt(std::max(least_curvature, curvature));
}

/// log of the root of what exp(2 x) is on average where exp(f) is the density of x, by its maximum,
/// `highest` at x:
/// with few poses larger numbers remain possible, the more as the density is skew, and count.
/// Adaptive Gauss-Hermite quadrature with five points [Liu & Pierce 1994].
template <typename Function>
double average(const Function& f, double x, double highest, double deviation) {
    constexpr std::array<std::pair<double, double>, 2> nodes_and_weights{
        {{1.3556261799742659, 0.2220759220056126}, {2.8569700138728056, 0.0112574113277207}}};
    if (!std::isfinite(highest)) return x;
    double density = 8.0 / 15;
    double squares = density;
    for (const auto& [node, weight] : nodes_and_weights) {
        for (const double t : {-node, node}) {
            const double part = weight * std::exp(f(x + t * deviation) - highest + node * node / 2);
            density += part;
            squares += part * std::exp(2 * t * deviation);
        }
    }
    return x + std::log(squares / density) / 2;
}

double within_reach(double found, double expected) {
    return std::clamp(found, expected * least_part, expected * most_model_errors);
}

}  // namespace

bool is_model_error_open(const Campaign& campaign) {
    return campaign.spread.is_prior && campaign.robot.parameter_count() > 0 &&
           (campaign.model_error > 0 || campaign.model_error_orientation > 0);
}

Campaign find_model_error(const IdentificationProblem& problem, const Parameters& parameters,
                          const Campaign& expected) {
    Campaign found = expected;
    PredictiveScore score(problem, parameters, expected);
    LogErrors errors{std::log(problem.campaign.model_error),
                     std::log(problem.campaign.model_error_orientation)};
    LogErrors averages = errors;
    const int sweeps = score.has(0) && score.has(1) ? 2 : 1;
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (std::size_t kind = 0; kind < 2; ++kind) {
            if (!score.has(kind)) continue;
            const auto along = [&](double x) {
                LogErrors moved = errors;
                moved[kind] = x;
                return score(moved, kind);
            };
            const auto [most_probable, highest] = climb(along, errors[kind]);
            errors[kind] = most_probable;
            if (sweep + 1 < sweeps) continue;
            const double deviation = deviation_at(along, most_probable, highest);
            averages[kind] = average(along, most_probable, highest, deviation);
            const double within = std::min(std::exp(deviation), model_error_factor);
            if (kind == 0) found.known_within.model_error = within;
        }
    }
    found.model_error = within_reach(std::exp(averages[0]), expected.model_error);
    found.model_error_orientation =
        within_reach(std::exp(averages[1]), expected.model_error_orientation);
    if (expected.sensor->has_pixels() && expected.model_error > 0) {
        found.model_error_orientation =
            expected.model_error_orientation * found.model_error / expected.model_error;
    }
    return found;
}

}  // namespace posewise::detail
