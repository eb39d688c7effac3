#include <algorithm>
#include <cmath>
#include <limits>

#include "core/progress_counter.hpp"
#include "model/error_class.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "robust.hpp"

namespace posewise {
namespace {

constexpr const char* step_names[] = {
    "base and targets",  "+ joint offsets", "+ lengths",
    "+ other geometric", "+ gravity terms", "+ free terms",
    "+ harmonics",       "+ tilts of axes", "+ scales, gear ratios"};

/// The step, an index of step_names, that adds this parameter.
int step_of(const Chain& chain, Index parameter) {
    using detail::ErrorClass;
    switch (detail::error_class_of(chain, parameter)) {
        case ErrorClass::Offset:
        case ErrorClass::Slide:
            return 1;
        case ErrorClass::Length:
            return 2;
        case ErrorClass::Angle:
            return 3;
        case ErrorClass::Gravity:
        case ErrorClass::Torque:
            return 4;
        case ErrorClass::Other:
            return 5;
        case ErrorClass::Harmonic:
        case ErrorClass::SlideHarmonic:
            return 6;
        case ErrorClass::Tilt:
            return 7;
        case ErrorClass::Gain:
            break;
    }
    return 8;
}

/// A set with what its calibrations need and gave.
struct Candidate {
    ModelTrial trial;
    Campaign campaign;
    Parameters start;
    Estimate estimate = {};
};

Candidate calibrate_set(const Campaign& campaign, const Measurements& measurements,
                        const Parameters& registered, ParameterSet set,
                        const LevenbergMarquardtOptions& options) {
    Candidate candidate{
        {}, with_robot(campaign, keep_parameters(campaign.robot, set.parameters)), registered};
    candidate.trial.set = std::move(set);
    candidate.trial.parameter_count = parameter_count(candidate.campaign);
    candidate.start.robot = VectorXd::Zero(candidate.campaign.robot.parameter_count());
    candidate.estimate = identify(candidate.campaign, measurements, candidate.start, options);
    candidate.trial.failure = candidate.estimate.undetermined;
    return candidate;
}

/// Mean squared error and its standard error. Both arguments: configurations x targets.
struct MeanError {
    double mean = 0;
    double standard_error = 0;
};
MeanError average(const RowMatrixXd& squared_errors, const Seen& is_judged) {
    const RowMatrixXd judged = is_judged.select(squared_errors, 0);
    const VectorXd sums = judged.rowwise().sum();
    const VectorXd counts = is_judged.cast<double>().rowwise().sum().matrix();
    const double points = std::max(counts.sum(), 1.0);
    const auto m = static_cast<double>(sums.size());
    const double mean = sums.sum() / points;
    const double scatter = (sums - mean * counts).squaredNorm() * m / std::max(m - 1, 1.0);
    return {mean, std::sqrt(scatter) / points};
}

/// Fills the trial; the mean squared errors held out.
MeanError judge(Candidate& candidate, const Measurements& measurements, const Seen& is_judged,
                Index folds, const LevenbergMarquardtOptions& options) {
    ModelTrial& trial = candidate.trial;
    const CrossValidation held_out = cross_validate(candidate.campaign, measurements,
                                                    candidate.estimate.parameters, folds, options);
    if (!held_out.failures.empty()) {
        trial.failure = held_out.failures.front();
        return {};
    }
    const RowMatrixXd fit =
        squared_distances(candidate.campaign, candidate.estimate.parameters, measurements);
    const MeanError error = average(held_out.squared_distances, is_judged);
    trial.fit_rms = std::sqrt(average(fit, is_judged).mean);
    trial.held_out_rms = std::sqrt(error.mean);
    if (error.mean > 0) trial.standard_error = error.standard_error / (2 * trial.held_out_rms);
    return error;
}

/// Of the sets without a failure, the best and the smallest that is as good.
void recommend(const std::vector<MeanError>& errors, ModelSelection& selection) {
    MeanError best{std::numeric_limits<double>::infinity(), 0};
    for (std::size_t k = 0; k < errors.size(); ++k) {
        if (!selection.trials[k].failure.empty() || errors[k].mean >= best.mean) continue;
        best = errors[k];
        selection.best = static_cast<Index>(k);
    }
    for (std::size_t k = 0; k < errors.size() && selection.recommended < 0; ++k) {
        if (!selection.trials[k].failure.empty()) continue;
        if (errors[k].mean <= best.mean + best.standard_error) {
            selection.recommended = static_cast<Index>(k);
        }
    }
}

}  // namespace

std::vector<ParameterSet> nested_parameter_sets(const Chain& chain) {
    const std::vector<std::string> names = chain.parameter_names();
    std::vector<ParameterSet> sets;
    for (int step = 0; step < static_cast<int>(std::size(step_names)); ++step) {
        ParameterSet set{step_names[step], {}};
        for (Index k = 0; k < chain.parameter_count(); ++k) {
            if (step_of(chain, k) <= step) {
                set.parameters.push_back(names[static_cast<std::size_t>(k)]);
            }
        }
        if (sets.empty() || set.parameters.size() > sets.back().parameters.size()) {
            sets.push_back(std::move(set));
        }
    }
    return sets;
}

ModelSelection select_model(const Campaign& campaign, const Measurements& measurements,
                            const Parameters& registered, Index folds,
                            const LevenbergMarquardtOptions& options,
                            const ProgressCallback& progress) {
    ModelSelection selection;
    selection.folds = folds;
    std::vector<Candidate> candidates;
    for (ParameterSet& set : nested_parameter_sets(campaign.robot)) {
        candidates.push_back(
            calibrate_set(campaign, measurements, registered, std::move(set), options));
        if (candidates.back().trial.failure.empty()) {
            selection.not_judged = candidates.back().estimate.outliers;
        }
    }
    const Seen is_judged = detail::points_but_outliers(measurements, selection.not_judged);
    detail::ProgressCounter counter(progress, static_cast<Index>(candidates.size()));
    std::vector<MeanError> errors;
    for (Candidate& candidate : candidates) {
        errors.emplace_back();
        if (candidate.trial.failure.empty()) {
            errors.back() = judge(candidate, measurements, is_judged, folds, options);
        }
        selection.trials.push_back(std::move(candidate.trial));
        counter.count();
    }
    recommend(errors, selection);
    return selection;
}

}  // namespace posewise
