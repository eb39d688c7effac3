#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// How much a large residual counts. All kinds agree on small ones, where the loss is u^2.
enum class LossKind {
    Squares,  ///< u^2: best for normal errors, sensitive to one bad point
    Huber,    ///< grows as |u| beyond the width: one optimum, gross errors still pull a little
    Cauchy,   ///< width^2 log(1 + (u / width)^2): gross errors hardly pull at all
};
std::string_view loss_name(LossKind kind);

/// Loss for the length u of one target's residual, in standard deviations of one coordinate.
struct Loss {
    LossKind kind = LossKind::Squares;
    double width = 0;  ///< where it departs from u^2, in standard deviations; ignored for squares

    double value(double u) const;
    /// Weight of the residual in weighted least squares with the same gradient: value'(u) / 2u,
    /// from 1 down.
    double weight(double u) const;
    /// Derivative of weight(u) u.
    double influence_rate(double u) const;
};

/// Residual statistics over the targets seen: distances between observed and predicted points, or
/// errors of measured lengths (m), and errors of orientations (rad).
struct Metrics {
    Index point_count = 0;
    Index coordinate_count = 3;  ///< 1: one length each; 0: angles only
    bool has_orientation = false;
    double distance_rms = 0;
    double distance_max = 0;
    double distance_mean = 0;
    double distance_p95 = 0;
    std::array<double, 3> coordinate_rms{};
    std::array<double, 3> coordinate_max{};
    double orientation_rms = 0;  ///< angle of the remaining rotation, or distance in an image
    double orientation_max = 0;
    double orientation_p95 = 0;
    /// Of `orientation_rms`: rad, or 1000 px of a sensor with has_pixels().
    const AmountUnits* orientation_units = &angle_units;

    /// RMS of the distances; of the angles (rad) where no length is measured.
    double rms() const { return coordinate_count > 0 ? distance_rms : orientation_rms; }
};

/// A target at a configuration whose mean is too far from what the other points predict.
struct Outlier {
    Index configuration = 0;
    std::string id;  ///< id of the configuration
    Index target = 0;
    double distance = 0;    ///< length of the residual, m
    double deviations = 0;  ///< whitened residual in robust standard deviations of one coordinate
    double weight = 0;      ///< weight in the fit, 0 to 1
};

/// Variance of whitened residuals: chi^2 per degree of freedom.
struct ResidualVariance {
    double factor = 1;
    double degrees_of_freedom = 0;
};

/// Identified parameters and their uncertainty.
struct Estimate {
    Ending ending = Ending::NotRun;
    /// If the ending is NotIdentifiable: what is not determined and what would determine it, as a
    /// sentence. Then nothing else in the estimate but its start means anything.
    std::string undetermined;
    Index iterations = 0;
    Parameters parameters;
    std::vector<std::string> names;  ///< L, order of Parameters
    /// Joint covariance of all L parameters (base and targets are estimated, too), m and rad.
    MatrixXd covariance;
    /// Residual variance of whitened means, chi^2 / degrees of freedom: 1 if sigma and model error
    /// are stated right, or without degrees of freedom. It scales the covariance, unless there is a
    /// prior. Under a robust loss it is the robust counterpart, see LevenbergMarquardtOptions.
    double variance_factor = 0;
    Index degrees_of_freedom = 0;
    /// Variances of lengths and of angles, if both are measured and losses are squares; else empty,
    /// and the factor above covers all. Without priors they follow from restricted maximum
    /// likelihood [Patterson & Thompson 1971], and the covariance is what noise with these two
    /// variances makes of the parameters. With priors each is the kind's chi^2 over the
    /// observations that the parameters leave.
    std::vector<ResidualVariance> variance_by_kind;
    ResidualVariance variance_of(bool is_angle) const;
    /// What the model cannot express, for a length (m) and an angle (rad): as the campaign states
    /// it or, with expected sizes as priors, as found.
    double model_error = 0;
    double model_error_orientation = 0;
    /// Sizes of the robot's errors, where they were learned.
    std::optional<ParameterSpread> spread;
    /// Uncertainty of that for lengths: one standard deviation is this factor. Where it was not
    /// found, the factor among robots.
    double model_error_within = model_error_factor;
    Metrics fit;        ///< over all samples
    Metrics fit_means;  ///< over the means of each configuration
    Loss loss;          ///< as used
    /// Under a robust loss: targets farther off than all but 3e-5 of normal errors, in the
    /// measurements' order.
    std::vector<Outlier> outliers;
};

/// The campaign with the model error that its estimate has found.
Campaign with_model_error(const Campaign& campaign, const Estimate& estimate);

/// Expected error of measured points that an estimate has not seen, RMS of distances (m) or, where
/// no length is measured, angles (rad).
struct ExpectedError {
    double parameters = 0;  ///< from the covariance of the parameters
    double model = 0;       ///< from the model error
    double noise = 0;       ///< from the instrument, after repeats, and the joints' repeatability
    double total() const;
    /// Whether the parameters, hence the number of poses, cause most of it.
    bool is_by_few_poses() const;
};
/// For means at these configurations: RMS over the targets seen, from trace(J C J^T), model error
/// and noise. For lengths if there are any, else for angles; or as `is_angle` states.
ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured);
ExpectedError expected_error(const Campaign& campaign, const Estimate& estimate,
                             const Measurements& measured, bool is_angle);
/// What the calibrated robot's places in space are off by, m: RMS over the points of
/// Sensor::targets(), whatever is measured of them. Of the instrument they have no noise.
ExpectedError expected_place_error(const Campaign& campaign, const Estimate& estimate,
                                   const RowMatrixXd& configurations);

/// RMS of the same places' errors where base and targets are fitted to them, as when another
/// instrument judges the robot, m.
struct RobotError {
    double nominal = 0;
    double calibrated = 0;
};
/// By the estimate and its covariance.
RobotError expected_robot_error(const Campaign& campaign, const Estimate& estimate,
                                const RowMatrixXd& configurations);
/// For single samples instead of means, like residuals().
ExpectedError expected_sample_error(const Campaign& campaign, const Estimate& estimate,
                                    const Measurements& measured);

/// Degrees of freedom of the mean square over all samples at measured configurations: those of
/// chi-squared with the same mean and variance [Satterthwaite 1946]. Samples of one configuration
/// share its errors. Its targets share as much of what the model leaves over as their residuals
/// show. For points there are at least three per configuration, if errors are alike in all
/// directions and everywhere.
struct ErrorFreedom {
    /// For the mean over all poses of this robot: other configurations might have been measured.
    double of_poses = 0;
    /// For the mean expected over robots: all configurations share the errors of the parameters.
    double of_robots = 0;
};
/// For lengths; for angles where no length is measured. At least one target must be seen.
ErrorFreedom error_freedom(const Campaign& campaign, const Estimate& estimate,
                           const Measurements& measured);

/// An expected error, and the bound that 95 % of the points keep.
struct PredictedError : ExpectedError {
    double percentile95 = 0;
};
/// Expected error at configurations that nobody has measured, for distances (m) or angles (rad).
struct ErrorPrediction {
    bool is_angle = false;
    const AmountUnits* units = &length_units;
    PredictedError overall;            ///< over the points of all configurations
    std::vector<PredictedError> each;  ///< for each configuration
};
/// Predicts the error of one reading of all targets at each configuration (m x joints, and measured
/// torques): for distances, then for angles, as far as the sensor measures them. The squared
/// error of a point is taken as scaled chi squared of the same mean and variance [Satterthwaite
/// 1946]; without priors as F, because the variance factor rests on the degrees of freedom of its
/// kind; with priors averaged over what the model error and the learned sizes may be.
/// Throws InputError for configurations that are not the robot's, and if it is stopped.
std::vector<ErrorPrediction> predict_errors(const Campaign& campaign, const Estimate& estimate,
                                            const RowMatrixXd& configurations,
                                            const StopSignal& stop = {});

/// Standard deviations: sqrt of the covariance's diagonal (m, rad).
VectorXd standard_deviations(const Estimate& estimate);

struct Correlation {
    Index first = 0;
    Index second = 0;
    double coefficient = 0;
};
/// The `count` strongest correlations between two parameters, strongest first.
std::vector<Correlation> strongest_correlations(const Estimate& estimate, Index count);

/// Observed minus predicted for every target seen in every sample, one per row: targets seen x
/// rows_per_target(), m or rad; NaN for a number that a target does not have.
RowMatrixXd residuals(const Campaign& campaign, const Parameters& parameters,
                      const Measurements& measurements);
/// Residuals of the means of each configuration.
RowMatrixXd mean_residuals(const Campaign& campaign, const Parameters& parameters,
                           const Measurements& measurements);

/// Squared distances between means and prediction, configurations x targets, m^2; 0 where a target
/// was not seen. Angles count only where no length is measured (rad^2).
RowMatrixXd squared_distances(const Campaign& campaign, const Parameters& parameters,
                              const Measurements& measurements);
/// Squared angles, likewise, rad^2; 0 where none is measured.
RowMatrixXd squared_angles(const Campaign& campaign, const Parameters& parameters,
                           const Measurements& measurements);

/// Metrics of residuals as residuals() returns them. At most the first `length_count` columns are
/// lengths (Sensor::lengths_per_target()), the others angles.
Metrics make_metrics(const RowMatrixXd& residuals, Index length_count = 3);
/// The same of residuals of such a sensor.
Metrics make_metrics(const RowMatrixXd& residuals, const Sensor& sensor);
/// Metrics of residuals(): over all samples, or over means if the measurements are means.
Metrics make_metrics(const Campaign& campaign, const Parameters& parameters,
                     const Measurements& measurements);

}  // namespace posewise
