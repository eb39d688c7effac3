#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// How much a large residual counts. All agree on small ones, where the loss is u^2.
enum class LossKind {
    Squares,  ///< u^2: best for normal errors, at the mercy of one bad point
    Huber,    ///< grows as |u| beyond the width: one optimum, gross errors still pull a little
    Cauchy,   ///< width^2 log(1 + (u / width)^2): gross errors hardly pull at all
};
std::string_view loss_name(LossKind kind);

/// The loss of the length u of one target's residual, in standard deviations of one coordinate.
struct Loss {
    LossKind kind = LossKind::Squares;
    double width = 0;  ///< where it leaves u^2, in standard deviations; not looked at for squares

    double value(double u) const;
    /// Part with which the residual counts in the weighted least squares with the same gradient:
    /// value'(u) / 2u, from 1 down.
    double weight(double u) const;
    /// Rate of weight(u) u.
    double influence_rate(double u) const;
};

/// Residual metrics over targets seen: distances between observed and predicted points, or by how
/// much measured lengths are off (m), and by how much orientations are (rad). For points the ten
/// numbers of the seed report.
struct Metrics {
    Index point_count = 0;
    Index coordinate_count = 3;  ///< 1: a length each; 0: angles only
    bool has_orientation = false;
    double distance_rms = 0;
    double distance_max = 0;
    double distance_mean = 0;
    double distance_p95 = 0;
    std::array<double, 3> coordinate_rms{};
    std::array<double, 3> coordinate_max{};
    double orientation_rms = 0;  ///< of the angle of the rotation that is left
    double orientation_max = 0;

    /// Of the distances; of the angles where no length is measured (rad).
    double rms() const { return coordinate_count > 0 ? distance_rms : orientation_rms; }
};

/// A target of a configuration whose mean is too far from what the other points say.
struct Outlier {
    Index configuration = 0;
    std::string id;  ///< of the configuration
    Index target = 0;
    double distance = 0;    ///< length of the residual, m
    double deviations = 0;  ///< the same in robust standard deviations of one coordinate
    double weight = 0;      ///< with which it counts, 0 to 1
};

/// Of whitened residuals: chi^2 per degree of freedom.
struct ResidualVariance {
    double factor = 1;
    double degrees_of_freedom = 0;
};

/// Identified parameters and how sure they are.
struct Estimate {
    Ending ending = Ending::NotRun;
    /// Where the ending is NotIdentifiable, what is not determined and what would determine it, as
    /// a sentence; then nothing else of the estimate but its start means anything.
    std::string undetermined;
    Index iterations = 0;
    Parameters parameters;
    std::vector<std::string> names;  ///< L, order of Parameters
    /// Covariance of all L parameters jointly (base and targets estimated too), m and rad.
    MatrixXd covariance;
    /// Residual variance of whitened means: chi^2 / degrees of freedom; 1 if sigma and model error
    /// were stated right, or if there is no degree of freedom. The covariance is scaled by it,
    /// unless there is a prior. Under a robust loss its robust counterpart, see robust losses at
    /// LevenbergMarquardtOptions.
    double variance_factor = 0;
    Index degrees_of_freedom = 0;
    /// Of lengths, then of angles, where both are measured and losses are squares; else empty: the
    /// one above is of all. Without priors by restricted maximum likelihood [Patterson & Thompson
    /// 1971], and the covariance is what noise with these two variances makes of the parameters;
    /// else each kind's chi^2 by the observations that the parameters leave over.
    std::vector<ResidualVariance> variance_by_kind;
    ResidualVariance variance_of(bool is_angle) const;
    /// What the model cannot express, of a length (m) and an angle (rad): as the campaign states
    /// it; where expected sizes are priors, what was found about that.
    double model_error = 0;
    double model_error_orientation = 0;
    /// One standard deviation of that of lengths is this factor; as large as among robots where it
    /// was not found.
    double model_error_within = model_error_factor;
    Metrics fit;        ///< all samples
    Metrics fit_means;  ///< means of each configuration
    Loss loss;          ///< as used
    /// Under a robust loss: targets farther off than normal errors are in 3e-5 of cases, in the
    /// measurements' order.
    std::vector<Outlier> outliers;
};

/// The campaign with the model error that an estimate of it has found.
Campaign with_model_error(const Campaign& campaign, const Estimate& estimate);

/// What measured points that an estimate has not seen are expected to be off by, RMS of distances
/// (m; of angles where no length is measured, rad).
struct ExpectedError {
    double parameters = 0;  ///< by the covariance of the parameters
    double model = 0;       ///< what is left over: the model error
    double noise = 0;       ///< of the instrument, after repeats, and the joints' repeatability
    double total() const;
};
/// Of means measured at these configurations, of the targets seen: the mean over them of
/// trace(J C J^T), model error and noise, of lengths if there are some; or as `is_angle` says.
ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured);
ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured, bool is_angle);
/// The same of each sample by itself, as residuals() are.
ExpectedError expected_sample_error(const Campaign& campaign, const Estimate& estimate,
                                    const Measurements& measured);

/// Of how many independent numbers the mean square of all samples at measured configurations is as
/// sure: chi-squared of the same mean and variance [Satterthwaite 1946]. All samples of a
/// configuration share its errors, and its targets as much of what the model leaves over as their
/// residuals show: with points three numbers a configuration at least, if errors are alike in all
/// directions and everywhere.
struct ErrorFreedom {
    /// For the mean over all poses of this robot: other configurations might have been measured.
    double of_poses = 0;
    /// For the mean that is expected of any robot: errors of the parameters are shared by all
    /// configurations.
    double of_robots = 0;
};
/// Of lengths; of angles where none is measured. At least one target must be seen.
ErrorFreedom error_freedom(const Campaign& campaign, const Estimate& estimate,
                           const Measurements& measured);

/// An expected error, and what 95 % of the points are off by less than.
struct PredictedError : ExpectedError {
    double percentile95 = 0;
};
/// What to expect at configurations that nobody has measured: of distances (m), or of angles (rad).
struct ErrorPrediction {
    bool is_angle = false;
    PredictedError overall;            ///< over the points of all configurations
    std::vector<PredictedError> each;  ///< of each configuration
};
/// Of configurations (m x joints, and measured torques), as one reading of all targets there would
/// find it: of distances, then of angles, as far as the sensor measures them. A point's squared
/// error is taken as scaled chi squared of the same mean and variance [Satterthwaite 1946]; without
/// priors as F, since the degrees of freedom of its kind are all that the variance factor rests on.
/// Throws InputError for configurations that are not the robot's.
std::vector<ErrorPrediction> predict_errors(const Campaign& campaign, const Estimate& estimate,
                                            const RowMatrixXd& configurations);

/// Standard deviations: sqrt of the covariance's diagonal (m, rad).
VectorXd standard_deviations(const Estimate& estimate);

struct Correlation {
    Index first = 0;
    Index second = 0;
    double coefficient = 0;
};
/// The `count` strongest correlations between two parameters, strongest first.
std::vector<Correlation> strongest_correlations(const Estimate& estimate, Index count);

/// Deviations of the observed from the predicted, of every target seen in every sample, one a row:
/// targets seen x rows_per_target(), m or rad.
RowMatrixXd residuals(const Campaign& campaign, const Parameters& parameters,
                      const Measurements& measurements);
/// The same of the means of each configuration.
RowMatrixXd mean_residuals(const Campaign& campaign, const Parameters& parameters,
                           const Measurements& measurements);

/// Squared distances of the means from what is predicted, configurations x targets, m^2; 0 where a
/// target was not seen. Angles count only where no length is measured (rad^2).
RowMatrixXd squared_distances(const Campaign& campaign, const Parameters& parameters,
                              const Measurements& measurements);
/// The same of angles, rad^2; 0 where none is measured.
RowMatrixXd squared_angles(const Campaign& campaign, const Parameters& parameters,
                           const Measurements& measurements);

/// Metrics of residuals as residuals() returns them, of which at most so many columns are lengths
/// (Sensor::lengths_per_target()), the others angles.
Metrics make_metrics(const RowMatrixXd& residuals, Index length_count = 3);
/// Those of all samples, or of means where the measurements are means: of residuals().
Metrics make_metrics(const Campaign& campaign, const Parameters& parameters,
                     const Measurements& measurements);

}  // namespace posewise
