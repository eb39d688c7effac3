#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/parallel.hpp"
#include "core/progress_counter.hpp"
#include "model_error.hpp"
#include "normal_equations.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"

namespace posewise {
namespace {

using detail::IdentificationProblem;
using detail::LinearisedSystem;
using detail::Metric;
using detail::NormalEquations;

/// The configurations that are held out together: one after the other in turn, but those with the
/// same joint values together, so that none is judged by a robot identified from it. Fewer than so
/// many folds where fewer differ.
std::vector<std::vector<Index>> make_folds(const Measurements& measurements, Index joints,
                                           Index folds) {
    constexpr double tolerance = 1e-6;  // rad or m, as within one configuration
    const auto q = measurements.configurations.leftCols(joints);  // torques follow
    std::map<std::vector<double>, std::size_t> fold_of;
    std::vector<std::vector<Index>> members;
    for (Index i = 0; i < q.rows(); ++i) {
        const RowMatrixXd rounded = (q.row(i) / tolerance).array().round();
        const std::size_t next = fold_of.size() % static_cast<std::size_t>(folds);
        const std::vector<double> values(rounded.data(), rounded.data() + rounded.size());
        const std::size_t fold = fold_of.emplace(values, next).first->second;
        if (fold == members.size()) members.emplace_back();
        members[fold].push_back(i);
    }
    return members;
}

/// Every configuration linearised at the same parameters, so that what is left without some of them
/// is a difference.
class Linearisation {
  public:
    Linearisation(const IdentificationProblem& problem, const Parameters& parameters)
        : system_(linearise(problem, parameters)), all_(normal_equations(problem, system_)) {}

    NormalEquations without(const std::vector<Index>& configurations) const {
        NormalEquations others = all_;
        for (const Index i : configurations) {
            const auto k = static_cast<std::size_t>(i);
            const Index first = system_.first_row[k];
            const Index rows = system_.first_row[k + 1] - first;
            const MatrixXd J = system_.J().middleRows(first, rows);
            const auto r = system_.r().segment(first, rows);
            others.M.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose(), -1);
            others.g -= J.transpose() * r;
            others.squares -= r.squaredNorm();
        }
        return others;
    }

  private:
    LinearisedSystem system_;
    NormalEquations all_;
};

/// Identifications without some configurations each.
class Folds {
  public:
    Folds(const Campaign& campaign, const Measurements& measurements, const Parameters& start,
          const LevenbergMarquardtOptions& options)
        : campaign_(campaign), measurements_(measurements), start_(start), options_(options) {
        const bool are_squares = options.loss.kind == LossKind::Squares;
        const bool finds_model_error =
            options.finds_model_error && detail::is_model_error_open(campaign);
        if (!are_squares || finds_model_error) return;
        const IdentificationProblem problem = detail::make_problem(campaign, measurements);
        Parameters nominal = start;
        nominal.robot.setZero();
        at_nominal_.emplace(problem, nominal);
        at_start_.emplace(problem, start);
    }

    Estimate identify_without(const std::vector<Index>& held_out) const {
        const Measurements others =
            take(measurements_, all_but(measurements_.configuration_count(), held_out));
        if (auto parameters = refine(others, held_out)) {
            Estimate estimate;
            estimate.ending = Ending::Converged;
            estimate.parameters = std::move(*parameters);
            return estimate;
        }
        return identify(campaign_, others, start_, options_);
    }

  private:
    /// By steps of Gauss and Newton in information form. Nothing unless every step could gain far
    /// less than the last, as near an optimum, down to where identify() would stop.
    std::optional<Parameters> refine(const Measurements& others,
                                     const std::vector<Index>& held_out) const {
        constexpr double falling = 0.1;
        if (!at_start_ || !Metric(at_nominal_->without(held_out).M).is_regular()) {
            return std::nullopt;
        }
        const IdentificationProblem problem = detail::make_problem(campaign_, others);
        NormalEquations equations = at_start_->without(held_out);
        Parameters parameters = start_;
        double last_gain = std::numeric_limits<double>::infinity();
        for (Index step = 0; step < options_.iteration_limit && !options_.stop.is_set(); ++step) {
            const Metric metric(equations.M);
            if (!metric.is_regular()) return std::nullopt;
            const VectorXd d = metric.solve(equations.g);
            const double gain = equations.g.dot(d);
            if (!(gain <= falling * last_gain)) return std::nullopt;
            parameters = advance(campaign_, parameters, problem.units.step(d));
            if (gain <= converged_below(problem, options_.relative_tolerance, equations.squares)) {
                return parameters;
            }
            equations = normal_equations(problem, linearise(problem, parameters));
            last_gain = gain;
        }
        return std::nullopt;
    }

    const Campaign& campaign_;
    const Measurements& measurements_;
    const Parameters& start_;
    const LevenbergMarquardtOptions& options_;
    std::optional<Linearisation> at_nominal_;  ///< where a lost rank is exactly lost
    std::optional<Linearisation> at_start_;
};

/// The first row of residuals() of each configuration, and one more.
std::vector<Index> first_residuals(const Measurements& measurements) {
    std::vector<Index> first{0};
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        const Index sample = measurements.first_sample[static_cast<std::size_t>(i)];
        first.push_back(
            first.back() +
            measurements.is_seen.middleRows(sample, measurements.sample_count(i)).count());
    }
    return first;
}

/// Rows of the configurations held out in each fold, in the measurements' order.
RowMatrixXd order_residuals(const Measurements& measurements, Index width,
                            const std::vector<std::vector<Index>>& folds,
                            const std::vector<RowMatrixXd>& by_fold) {
    const std::vector<Index> first = first_residuals(measurements);
    RowMatrixXd ordered =
        RowMatrixXd::Constant(first.back(), width, std::numeric_limits<double>::quiet_NaN());
    for (std::size_t fold = 0; fold < folds.size(); ++fold) {
        const RowMatrixXd& rows = by_fold[fold];
        if (rows.rows() == 0) continue;  // a fold that failed
        Index row = 0;
        for (const Index i : folds[fold]) {
            const auto k = static_cast<std::size_t>(i);
            const Index count = first[k + 1] - first[k];
            ordered.middleRows(first[k], count) = rows.middleRows(row, count);
            row += count;
        }
    }
    return ordered;
}

}  // namespace

CrossValidation cross_validate(const Campaign& campaign, const Measurements& measurements,
                               const Parameters& start, Index folds,
                               const LevenbergMarquardtOptions& options,
                               const ProgressCallback& progress) {
    const Index count = measurements.configuration_count();
    if (folds < 2 || folds > count) {
        throw InputError("folds is " + std::to_string(folds) + ", must be 2 to the number of " +
                         "configurations, " + std::to_string(count));
    }
    const std::vector<std::vector<Index>> members =
        make_folds(measurements, campaign.robot.joint_count(), folds);
    if (members.size() < 2) {
        throw InputError("all configurations have the same joint values; none can be held out");
    }
    std::vector<RowMatrixXd> samples(members.size());
    std::vector<RowMatrixXd> means(members.size());
    RowMatrixXd distances = RowMatrixXd::Zero(count, measurements.is_seen.cols());
    RowMatrixXd angles = distances;
    std::vector<std::string> failures(members.size());
    detail::ProgressCounter counter(progress, folds);
    for (Index k = std::ssize(members); k < folds; ++k) counter.count();
    const Folds identifications(campaign, measurements, start, options);
    detail::for_each_index(std::ssize(members), [&](Index fold) {
        const auto f = static_cast<std::size_t>(fold);
        const std::vector<Index>& held_out = members[f];
        const Estimate estimate = identifications.identify_without(held_out);
        if (estimate.ending == Ending::NotIdentifiable) {
            failures[f] = "fold " + std::to_string(fold + 1) + ": " + estimate.undetermined;
        } else {
            const Measurements judged = take(measurements, held_out);
            samples[f] = residuals(campaign, estimate.parameters, judged);
            means[f] = mean_residuals(campaign, estimate.parameters, judged);
            distances(held_out, Eigen::all) =
                squared_distances(campaign, estimate.parameters, judged);
            angles(held_out, Eigen::all) = squared_angles(campaign, estimate.parameters, judged);
        }
        counter.count();
    });
    const auto join = [&](const std::vector<RowMatrixXd>& parts) {
        RowMatrixXd all(0, campaign.sensor->rows_per_target());
        for (const RowMatrixXd& part : parts) {
            if (part.rows() == 0) continue;  // a fold that failed
            all.conservativeResize(all.rows() + part.rows(), all.cols());
            all.bottomRows(part.rows()) = part;
        }
        return make_metrics(all, *campaign.sensor);
    };
    CrossValidation result{
        std::ssize(members), join(samples), join(means), distances, angles, {}, {}};
    result.residuals =
        order_residuals(measurements, campaign.sensor->rows_per_target(), members, samples);
    std::copy_if(failures.begin(), failures.end(), std::back_inserter(result.failures),
                 [](const std::string& failure) { return !failure.empty(); });
    return result;
}

}  // namespace posewise
