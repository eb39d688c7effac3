#include "answers.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "core/decompositions.hpp"
#include "core/statistics.hpp"
#include "posewise/task/calibration.hpp"

namespace posewise {
namespace detail {
namespace {

/// First row and number of rows that each configuration has in residuals().
std::vector<std::pair<Index, Index>> rows_of_configurations(const Measurements& measurements) {
    std::vector<std::pair<Index, Index>> rows;
    Index first = 0;
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const Index sample = measurements.first_sample[static_cast<std::size_t>(i)];
        const Index count =
            measurements.is_seen.middleRows(sample, measurements.sample_count(i)).count();
        rows.emplace_back(first, count);
        first += count;
    }
    return rows;
}

/// Axes that have the unit of the first: they are the first ones.
Index main_axis_count(const Sensor& sensor) {
    return sensor.has_lengths() ? sensor.lengths_per_target() : sensor.rows_per_target();
}

/// Mean square distance of each configuration; NaN where it has no reading or one is unknown. Of
/// several instruments those that measure no lengths do not count.
VectorXd mean_squares(const Campaign& campaign, const Measurements& measurements,
                      const RowMatrixXd& residuals) {
    const auto rows = rows_of_configurations(measurements);
    const Index axes = main_axis_count(*campaign.sensor);
    VectorXd squares(std::ssize(rows));
    for (Index i = 0; i < squares.size(); ++i) {
        const auto [first, count] = rows[static_cast<std::size_t>(i)];
        double sum = 0;
        double numbers = 0;
        for (Index row = first; row < first + count; ++row) {
            const auto own = residuals.row(row).array().isNaN();
            const auto left = residuals.row(row).head(axes);
            const bool is_other = own.head(axes).all() && !own.all();
            if (is_other) continue;
            const bool has_gaps = campaign.sensor->is_combined() && !own.all();
            sum += has_gaps ? own.head(axes).select(0, left.array()).square().sum()
                            : left.squaredNorm();
            ++numbers;
        }
        squares[i] = sum / numbers;
    }
    return squares;
}

/// What errors of a model may follow: 1, sine and cosine of each joint, sliding joints themselves.
MatrixXd position_columns(const Chain& robot, const RowMatrixXd& configurations) {
    MatrixXd columns = VectorXd::Ones(configurations.rows());
    const auto add = [&](const VectorXd& column) {
        columns.conservativeResize(Eigen::NoChange, columns.cols() + 1);
        columns.rightCols(1) = column;
    };
    for (Index j = 0; j < robot.joint_count(); ++j) {
        const VectorXd values = configurations.col(j);
        if (robot.joint(j).motion == Motion::Rotation) {
            add(values.array().sin());
            add(values.array().cos());
        } else {
            add(values);
        }
    }
    return columns;
}

/// Takes out what the columns express.
class Remainder {
  public:
    explicit Remainder(const MatrixXd& columns) {
        constexpr double dependent = 1e-6;
        basis_ = detail::PivotedReflections(detail::with_columns_of_norm_one(columns), dependent)
                     .basis();
    }
    VectorXd operator()(const VectorXd& values) const {
        return values - basis_ * (basis_.transpose() * values);
    }
    Index rank() const { return basis_.cols(); }

  private:
    MatrixXd basis_;
};

/// Slope of y over x once what the remainder takes out is out of both.
struct FittedLine {
    double slope = 0;
    double error = 0;    ///< its standard deviation
    double freedom = 1;  ///< degrees of freedom of that
};

std::optional<FittedLine> fit_line(const VectorXd& x, const VectorXd& y,
                                   const Remainder& remainder) {
    constexpr double explained = 1e-9;  // part of x's square below which nothing of it is left
    constexpr double most_alike = 0.95;
    const VectorXd own_x = remainder(x), own_y = remainder(y);
    const auto degrees = static_cast<double>(x.size() - remainder.rank() - 1);
    const double square = own_x.squaredNorm();
    if (degrees < 1 || !(square > explained * x.squaredNorm())) return std::nullopt;
    const double slope = own_x.dot(own_y) / square;
    const VectorXd rest = own_y - slope * own_x;
    const double left = rest.squaredNorm();
    const Index pairs = rest.size() - 1;
    const double alike =
        left > 0 ? std::clamp(rest.head(pairs).dot(rest.tail(pairs)) / left, 0.0, most_alike) : 0;
    const double wider = (1 + alike) / (1 - alike);
    return FittedLine{slope, std::sqrt(left / degrees / square * wider),
                      std::max(1.0, degrees / wider)};
}

}  // namespace

namespace {

/// Means of the residuals of configurations with readings.
struct MeanResiduals {
    std::vector<Index> shown;  ///< numbers of the configurations
    RowMatrixXd means;         ///< shown x axes
};

MeanResiduals mean_residuals(const Measurements& measurements, const RowMatrixXd& residuals) {
    MeanResiduals found;
    const auto rows = rows_of_configurations(measurements);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (rows[i].second > 0) found.shown.push_back(static_cast<Index>(i));
    }
    found.means.resize(std::ssize(found.shown), residuals.cols());
    for (Index k = 0; k < found.means.rows(); ++k) {
        const auto [first, number] =
            rows[static_cast<std::size_t>(found.shown[static_cast<std::size_t>(k)])];
        found.means.row(k) = residuals.middleRows(first, number).colwise().mean();
    }
    return found;
}

constexpr Index least_of_trend = 4;  // configurations

/// Lines over x, one value a row of the means, in its order; their changes are over its range.
std::optional<OrderTrend> find_trend(const Campaign& campaign, const RowMatrixXd& configurations,
                                     const RowMatrixXd& means, const VectorXd& x) {
    constexpr double level = 0.05;
    const Index count = means.rows();
    // The axes of several instruments are not alike.
    if (count < least_of_trend || campaign.sensor->is_combined()) return std::nullopt;
    MatrixXd columns = position_columns(campaign.robot, configurations);
    OrderTrend trend;
    trend.is_beside_joints = count >= 3 * (columns.cols() + 1);
    if (!trend.is_beside_joints) columns = columns.leftCols(1).eval();
    const Remainder remainder(columns);
    const std::vector<std::string> axes = residual_axes(campaign);
    const auto axis_count = static_cast<double>(axes.size());
    const double length = x.maxCoeff() - x.minCoeff();
    double rarest = 2;  // least probability by chance
    for (Index axis = 0; axis < means.cols(); ++axis) {
        const auto line = fit_line(x, means.col(axis), remainder);
        if (!line) continue;
        const double by_chance = line->error > 0
                                     ? two_sided(line->slope / line->error, line->freedom)
                                 : line->slope == 0 ? 1
                                                    : 0;
        if (by_chance < rarest) {
            rarest = by_chance;
            trend.strongest = trend.slopes.size();
        }
        trend.slopes.push_back(
            {axes[static_cast<std::size_t>(axis)], campaign.sensor->is_angle(axis),
             line->slope * length,
             student_quantile(1 - level / axis_count / 2, line->freedom) * line->error * length, 0,
             std::min(1.0, axis_count * by_chance), line->error * length});
    }
    if (trend.slopes.empty()) return std::nullopt;
    return trend;
}

}  // namespace

std::optional<OrderTrend> find_order_trend(const Campaign& campaign,
                                           const Measurements& measurements,
                                           const RowMatrixXd& residuals) {
    const auto [shown, means] = mean_residuals(measurements, residuals);
    const Index count = means.rows();
    if (count < least_of_trend) return std::nullopt;
    auto trend = find_trend(campaign, measurements.configurations(shown, Eigen::all), means,
                            VectorXd::LinSpaced(count, 1, static_cast<double>(count)));
    if (!trend) return std::nullopt;
    const std::vector<std::string> axes = residual_axes(campaign);
    const Index first_tenth = (count + 9) / 10;
    for (OrderSlope& slope : trend->slopes) {
        const Index axis = std::ranges::find(axes, slope.axis) - axes.begin();
        const VectorXd y = means.col(axis);
        slope.early = y.head(first_tenth).mean() - y.tail(count - first_tenth).mean();
    }
    return trend;
}

std::vector<ConditionTrend> find_condition_trends(const Campaign& campaign,
                                                  const Measurements& measurements,
                                                  const RowMatrixXd& residuals,
                                                  const std::vector<Condition>& conditions) {
    const auto [shown, means] = mean_residuals(measurements, residuals);
    std::vector<ConditionTrend> trends;
    for (const Condition& condition : conditions) {
        std::vector<std::pair<double, Index>> known;  // value, row of the means
        for (std::size_t k = 0; k < shown.size(); ++k) {
            const auto found =
                condition.values.find(measurements.ids[static_cast<std::size_t>(shown[k])]);
            if (found == condition.values.end()) continue;
            known.emplace_back(found->second, static_cast<Index>(k));
        }
        std::ranges::sort(known);  // neighbours in the condition are alike
        if (std::ssize(known) < least_of_trend) continue;
        const double range = known.back().first - known.front().first;
        if (!(range > 0)) continue;
        VectorXd x(std::ssize(known));
        std::vector<Index> rows;
        std::vector<Index> configurations;
        for (const auto& [value, row] : known) {
            x[std::ssize(rows)] = value;
            rows.push_back(row);
            configurations.push_back(shown[static_cast<std::size_t>(row)]);
        }
        const auto trend =
            find_trend(campaign, measurements.configurations(configurations, Eigen::all),
                       means(rows, Eigen::all), x);
        if (trend) trends.push_back({condition.name, condition.unit, range, *trend});
    }
    return trends;
}

std::optional<Influence> find_influence(const Campaign& campaign, const Measurements& measurements,
                                        const RowMatrixXd& residuals,
                                        const CrossValidation& held_out) {
    const VectorXd fit = mean_squares(campaign, measurements, residuals).cwiseSqrt();
    const VectorXd without = mean_squares(campaign, measurements, held_out.residuals).cwiseSqrt();
    std::optional<Index> most;
    for (Index i = 0; i < fit.size(); ++i) {
        const double grown = without[i] - fit[i];
        if (std::isnan(grown)) continue;
        if (!most || grown > without[*most] - fit[*most]) most = i;
    }
    if (!most) return std::nullopt;
    return Influence{measurements.ids[static_cast<std::size_t>(*most)], fit[*most], without[*most],
                     held_out.folds == fit.size()};
}

std::optional<RmsInterval> held_out_interval(const Campaign& campaign,
                                             const Measurements& measurements,
                                             const CrossValidation& held_out) {
    constexpr Index least = 3;
    constexpr double level = 0.05;
    std::vector<double> known;
    for (const double square : mean_squares(campaign, measurements, held_out.residuals)) {
        if (!std::isnan(square)) known.push_back(square);
    }
    const Index count = std::ssize(known);
    if (count < least) return std::nullopt;
    const Eigen::Map<const VectorXd> squares(known.data(), count);
    const double mean = squares.mean();
    if (!(mean > 0)) return std::nullopt;
    const auto freedom = static_cast<double>(count - 1);
    const double error =
        std::sqrt((squares.array() - mean).square().sum() / freedom / static_cast<double>(count));
    const double factor = std::exp(student_quantile(1 - level / 2, freedom) * error / (2 * mean));
    const double rms = held_out.samples.rms();
    return RmsInterval{rms / factor, rms * factor, freedom};
}

}  // namespace detail

namespace {

constexpr double wanted_part = 0.8;  // more poses shall leave this part of an error

/// Between the points, which are in the order of their counts, on logarithmic axes.
double error_at(const std::vector<ErrorAtCount>& points, double ErrorAtCount::*error, Index n) {
    const auto next = std::ranges::lower_bound(points, n, {}, &ErrorAtCount::pose_count);
    if (next->pose_count == n) return (*next).*error;
    const ErrorAtCount& last = *(next - 1);
    const auto log_of = [&](Index k) {
        return std::log(static_cast<double>(k) / static_cast<double>(last.pose_count));
    };
    return last.*error *
           std::pow((*next).*error / (last.*error), log_of(n) / log_of(next->pose_count));
}

std::optional<Index> find_more(const std::vector<ErrorAtCount>& points, double ErrorAtCount::*error,
                               Index count) {
    const double now = error_at(points, error, count);
    for (Index n = count + 1; n <= points.back().pose_count; ++n) {
        if (error_at(points, error, n) <= wanted_part * now) return n - count;
    }
    return std::nullopt;
}

}  // namespace

std::optional<MorePoses> more_poses(std::vector<ErrorAtCount> points, Index count) {
    std::erase_if(points, [](const ErrorAtCount& one) { return !(one.error > 0); });
    std::ranges::sort(points, {}, &ErrorAtCount::pose_count);
    if (points.empty() || count < points.front().pose_count || count > points.back().pose_count) {
        return std::nullopt;
    }
    MorePoses found;
    found.most = points.back().pose_count;
    found.more.expected = find_more(points, &ErrorAtCount::error, count);
    found.more.lower = found.more.upper = found.more.expected;
    if (std::ranges::all_of(points, &ErrorAtCount::has_ends)) {
        // Either end may be the one that needs more poses.
        const auto is_less = [](const std::optional<Index>& x, const std::optional<Index>& y) {
            return x && (!y || *x < *y);
        };
        std::tie(found.more.lower, found.more.upper) =
            std::minmax({found.more.expected, find_more(points, &ErrorAtCount::lower, count),
                         find_more(points, &ErrorAtCount::upper, count)},
                        is_less);
    }
    const Index reached = found.more.expected ? count + *found.more.expected : found.most;
    found.ratio = error_at(points, &ErrorAtCount::error, reached) /
                  error_at(points, &ErrorAtCount::error, count);
    return found;
}

}  // namespace posewise
