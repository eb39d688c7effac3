#include "model_error.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../measurement/noise.hpp"
#include "posewise/jacobian/identification.hpp"

namespace posewise::detail {
namespace {

/// What is found is from this part of the expected to so many times it: beyond, the model or a
/// measurement is wrong.
constexpr double least_part = 0.1;
constexpr double most_times = 40;
/// More configurations would not tell the two numbers any better.
constexpr Index most_configurations = 400;
/// A direction that one configuration alone determines has no prediction by the others.
constexpr double undetermined = 1e-10;

/// What one configuration tells, not whitened: covariance but for the model error, Jacobian by
/// scaled parameters and residual beside it, each row times the root of its weight.
struct Rows {
    MatrixXd covariance;
    RowMatrixXd augmented;
    std::vector<bool> is_angle;
    VectorXd root_weights;
};

/// log of the model errors of lengths and angles.
using LogErrors = std::array<double, 2>;

class PredictiveScore {
  public:
    PredictiveScore(const IdentificationProblem& problem, const Parameters& parameters,
                    const Campaign& expected)
        : expected_{std::log(expected.model_error), std::log(expected.model_error_orientation)},
          size_(problem.scale.size()),
          prior_begin_(base_parameter_count(problem.campaign)),
          prior_errors_(parameters.robot.cwiseQuotient(
              problem.scale.segment(prior_begin_, parameters.robot.size()))) {
        collect(problem, parameters);
    }

    bool has(std::size_t kind) const { return has_[kind]; }

    double operator()(const LogErrors& errors) const {
        const std::array<double, 2> squares{std::exp(2 * errors[0]), std::exp(2 * errors[1])};
        RowMatrixXd stacked(row_count_, size_ + 1);
        double score = 0;
        Index row = 0;
        for (const Rows& of_pose : rows_) {
            RowMatrixXd whitened = of_pose.augmented;
            MatrixXd covariance = of_pose.covariance;
            for (Index k = 0; k < covariance.rows(); ++k) {
                covariance(k, k) += squares[of_pose.is_angle[static_cast<std::size_t>(k)] ? 1 : 0];
            }
            const MatrixXd L = cholesky_factor(covariance);
            score -= L.diagonal().array().log().sum();
            L.triangularView<Eigen::Lower>().solveInPlace(whitened);
            stacked.middleRows(row, whitened.rows()) = of_pose.root_weights.asDiagonal() * whitened;
            row += whitened.rows();
        }
        return score + predict(stacked) + population(errors);
    }

  private:
    void collect(const IdentificationProblem& problem, const Parameters& parameters) {
        Campaign without = problem.campaign;
        without.model_error = without.model_error_orientation = 0;
        const Sensor& sensor = *without.sensor;
        const Index count = problem.means.configuration_count();
        const Index taken = std::min(count, most_configurations);
        const bool is_robust = problem.loss.kind != LossKind::Squares;
        const VectorXd lengths = is_robust ? residual_lengths(problem, parameters) : VectorXd();
        std::vector<Index> first_length{0};
        for (Index i = 0; i < count; ++i) {
            first_length.push_back(first_length.back() +
                                   (problem.repeats.row(i).array() > 0).count());
        }
        RowMatrixXd augmented(sensor.row_count(), size_ + 1);
        FlangeMotion motion;
        for (Index k = 0; k < taken; ++k) {
            const Index i = k * count / taken;
            const VectorXd q = problem.means.configurations.row(i).transpose();
            differentiate_pose(without, parameters, q, motion, augmented.leftCols(size_));
            augmented.leftCols(size_) *= problem.scale.asDiagonal();
            augmented.col(size_) =
                sensor.deviation(problem.means.observations.row(i).transpose(),
                                 sensor.predict(motion.world_from_flange, parameters.sensor));
            const VectorXd repeats = problem.repeats.row(i).transpose();
            const auto seen = seen_rows(repeats.array() > 0, sensor.rows_per_target());
            Rows rows{mean_covariance(without, motion, parameters.sensor, repeats),
                      augmented(seen, Eigen::all),
                      {},
                      VectorXd::Ones(static_cast<Index>(seen.size()))};
            for (const Index row : seen) {
                rows.is_angle.push_back(sensor.is_angle(row));
                const std::size_t kind = sensor.is_angle(row) ? 1 : 0;
                has_[kind] = std::isfinite(expected_[kind]);
            }
            for (Index j = 0; is_robust && j < rows.root_weights.size(); ++j) {
                const Index target =
                    first_length[static_cast<std::size_t>(i)] + j / sensor.rows_per_target();
                rows.root_weights[j] =
                    std::sqrt(problem.loss.weight(lengths[target] / problem.deviation));
            }
            row_count_ += rows.augmented.rows();
            rows_.push_back(std::move(rows));
        }
    }

    /// The part of the predictions that depends on the parameters.
    double predict(const RowMatrixXd& stacked) const {
        const auto B = stacked.leftCols(size_);
        MatrixXd M = MatrixXd::Zero(size_, size_);
        M.selfadjointView<Eigen::Lower>().rankUpdate(B.transpose());
        VectorXd gradient = B.transpose() * stacked.col(size_);
        M.diagonal().segment(prior_begin_, prior_errors_.size()).array() += 1;
        gradient.segment(prior_begin_, prior_errors_.size()) -= prior_errors_;
        const Eigen::LLT<MatrixXd> cholesky(M);
        if (cholesky.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
        const VectorXd residuals = stacked.col(size_) - B * cholesky.solve(gradient);
        const MatrixXd V = cholesky.matrixL().solve(B.transpose());
        double score = 0;
        Index row = 0;
        for (const Rows& of_pose : rows_) {
            const Index count = of_pose.augmented.rows();
            const auto V_i = V.middleCols(row, count);
            MatrixXd A = -V_i.transpose() * V_i;
            A.diagonal().array() += 1 + undetermined;
            const Eigen::LLT<MatrixXd> root(A);
            if (root.info() != Eigen::Success) return -std::numeric_limits<double>::infinity();
            score += root.matrixLLT().diagonal().array().log().sum() -
                     root.matrixL().solve(residuals.segment(row, count)).squaredNorm() / 2;
            row += count;
        }
        return score;
    }

    double population(const LogErrors& errors) const {
        double sum = 0;
        for (std::size_t kind = 0; kind < 2; ++kind) {
            if (!has_[kind]) continue;
            const double u = (errors[kind] - expected_[kind]) / std::log(model_error_factor);
            sum -= u * u / 2;
        }
        return sum;
    }

    LogErrors expected_;
    Index size_;
    Index prior_begin_;
    VectorXd prior_errors_;
    Index row_count_ = 0;
    std::array<bool, 2> has_{};
    std::vector<Rows> rows_;
};

/// Where the smooth function `f` is largest: uphill from `x` in steps that grow, then by parabolas
/// through the best three points, until they move it by less than 1 %.
template <typename Function>
double climb(const Function& f, double x) {
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
    return at[1];
}

/// log of the root of what exp(2 x) is on average where exp(f) is the density of x, taken as normal
/// about its maximum `x`: with few poses larger numbers remain possible, and count.
template <typename Function>
double average(const Function& f, double x) {
    constexpr double step = 0.25;
    const double curvature = (2 * f(x) - f(x - step) - f(x + step)) / (step * step);
    const double least = 1 / (std::log(model_error_factor) * std::log(model_error_factor));
    return x + 1 / std::max(curvature, least);
}

double within_reach(double found, double expected) {
    return std::clamp(found, expected * least_part, expected * most_times);
}

}  // namespace

bool is_model_error_open(const Campaign& campaign) {
    return campaign.spread.is_prior && campaign.robot.parameter_count() > 0 &&
           (campaign.model_error > 0 || campaign.model_error_orientation > 0);
}

Campaign find_model_error(const IdentificationProblem& problem, const Parameters& parameters,
                          const Campaign& expected) {
    const PredictiveScore score(problem, parameters, expected);
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
                return score(moved);
            };
            errors[kind] = climb(along, errors[kind]);
            if (sweep + 1 == sweeps) averages[kind] = average(along, errors[kind]);
        }
    }
    Campaign found = expected;
    found.model_error = within_reach(std::exp(averages[0]), expected.model_error);
    found.model_error_orientation =
        within_reach(std::exp(averages[1]), expected.model_error_orientation);
    return found;
}

}  // namespace posewise::detail
