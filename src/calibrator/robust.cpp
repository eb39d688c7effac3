#include "robust.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// How many parameters the observations determine, the prior the others: trace of (M - P) M^-1,
/// M^-1 = root root^T.
double determined_by_data(const IdentificationProblem& problem, const MatrixXd& root) {
    return static_cast<double>(root.cols()) -
           root.middleRows(problem.prior_begin(), problem.prior_count()).squaredNorm();
}

}  // namespace

Loss complete_loss(const Loss& loss, const Campaign& campaign) {
    if (!std::isfinite(loss.width) || loss.width < 0) {
        throw InputError(
            fmt::format("width of the loss is {:g}, must be finite and not negative", loss.width));
    }
    if (loss.kind != LossKind::Squares && campaign.sensor->is_combined()) {
        throw InputError(
            "a robust loss weighs readings of one kind, not those of several sensors; must be "
            "squares (`loss`)");
    }
    Loss complete = loss;
    if (loss.width == 0 && loss.kind != LossKind::Squares) {
        complete.width = default_width(loss.kind, campaign.sensor->rows_per_target());
    }
    return complete;
}

double parameters_used(const IdentificationProblem& problem, const Parameters& parameters) {
    IdentificationProblem of_squares = problem;
    of_squares.loss = {};
    const MatrixXd R = triangularise(linearise(of_squares, parameters)).R;
    return determined_by_data(problem, invert_triangle(R));
}

double robust_deviation(const IdentificationProblem& problem, const Parameters& parameters,
                        double used) {
    constexpr double least = 1e-6;
    const auto observed = static_cast<double>(problem.observation_count());
    if (observed <= used) return 1;
    const double middle = quantile(residual_lengths(problem, parameters), 0.5, QuantileRule::Upper);
    const double median = middle / median_length(problem.campaign.sensor->rows_per_target());
    return std::max(median * std::sqrt(observed / (observed - used)), least);
}

MatrixXd robust_covariance(const IdentificationProblem& problem, const Parameters& parameters,
                           const MatrixXd& R) {
    const VectorXd lengths = residual_lengths(problem, parameters);
    const auto p = static_cast<double>(problem.campaign.sensor->rows_per_target());
    double weights = 0;
    double rates = 0;
    double squared_rates = 0;
    double squares = 0;
    for (const double length : lengths) {
        const double u = length / problem.deviation;
        const double weight = problem.loss.weight(u);
        weights += weight;
        const double rate = (problem.loss.influence_rate(u) + (p - 1) * weight) / p;
        rates += rate;
        squared_rates += rate * rate;
        squares += weight * weight * length * length;
    }
    // H = a J^T W J + P = a R^T R + (1 - a) P: a is at most 1, influence never grows faster.
    const double a = rates / weights;
    MatrixXd P = MatrixXd::Zero(R.cols(), R.cols());
    P.diagonal().segment(problem.prior_begin(), problem.prior_count()).setOnes();
    MatrixXd stacked(2 * R.rows(), R.cols());
    stacked << std::sqrt(a) * R, std::sqrt(1 - a) * P;
    const MatrixXd root = invert_triangle(triangular_factor(std::move(stacked)));
    const MatrixXd inverse = root * root.transpose();
    const auto observed = static_cast<double>(problem.observation_count());
    const double used = determined_by_data(problem, root);
    const auto count = static_cast<double>(lengths.size());
    const double K = 1 + used / observed * (squared_rates * count / (rates * rates) - 1);
    const double spread = observed > used ? K * K * squares / (observed - used) * count / rates : 1;
    return spread * inverse + (1 - spread) * inverse * P * inverse;
}

Campaign weighed_campaign(const Campaign& campaign, const Loss& loss) {
    Campaign weighed = campaign;
    if (loss.kind != LossKind::Squares) weighed.model_error_common = 0;
    return weighed;
}

std::vector<Outlier> find_outliers(const IdentificationProblem& problem,
                                   const Parameters& parameters) {
    const Measurements& means = problem.means;
    const VectorXd lengths = residual_lengths(problem, parameters);
    const RowMatrixXd distances = residuals(problem.campaign, parameters, means);
    const Sensor& sensor = *problem.campaign.sensor;
    const double farthest = outlier_length(sensor.rows_per_target());
    const Index lengths_end =
        sensor.has_lengths() ? sensor.lengths_per_target() : sensor.rows_per_target();
    std::vector<Outlier> outliers;
    Index row = 0;
    for (Index i = 0; i < means.configuration_count(); ++i) {
        for (Index j = 0; j < means.is_seen.cols(); ++j) {
            if (!means.is_seen(i, j)) continue;
            const double u = lengths[row] / problem.deviation;
            if (u > farthest) {
                outliers.push_back({i, means.ids[static_cast<std::size_t>(i)], j,
                                    distances.row(row).head(lengths_end).norm(), u,
                                    problem.loss.weight(u)});
            }
            ++row;
        }
    }
    return outliers;
}

Seen points_but_outliers(const Measurements& measurements, const std::vector<Outlier>& outliers) {
    Seen points = times_seen(measurements).array() > 0;
    for (const Outlier& outlier : outliers) points(outlier.configuration, outlier.target) = false;
    return points;
}

}  // namespace posewise::detail
