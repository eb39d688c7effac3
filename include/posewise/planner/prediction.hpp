#pragma once

#include <cstdint>
#include <optional>

#include "posewise/core/blocks.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// How wrong the calibrated model's positions of targets will be, by the covariance M^-1 of the
/// parameters alone (no noise of a later measurement), m.
struct PredictedAccuracy {
    double rms = 0;           ///< of the position error over workspace and targets
    double percentile95 = 0;  ///< 95 % of position errors are below
    double worst_rms = 0;     ///< of the worst configuration and target
    /// Of the scaled chi-squared with the mean and variance that the mean square over the workspace
    /// has [Satterthwaite 1946].
    double degrees_of_freedom = 1;
    /// By which part its square follows that of the expected sizes if they are stated larger or
    /// smaller; it follows that of the noise by the rest. Nothing without a prior.
    std::optional<double> prior_share{};
    KnownWithin known_within{};
};

/// The same with what the model cannot express, which no number of poses reduces: RMS over
/// workspace and targets, m.
struct PredictedTotal {
    double rms = 0;    ///< with the model error as the campaign expects it
    double lower = 0;  ///< ends of the 90 % interval: the parameters' errors are drawn, the model
    double upper = 0;  ///< error and, with a prior, the size of all errors, log-normal (see below)
};

/// Of 4096 cases that fill what is not known evenly. Model error and sizes are drawn as
/// PredictedAccuracy says they are known; the parameters' errors grow with the sizes as
/// PredictedAccuracy::prior_share says: by the model error, too, which is taken for most of the
/// noise.
PredictedTotal predict_total(const PredictedAccuracy& accuracy, double model_error);

/// The RMS, by cases, of which predict_total() gives the interval; `repeatability` (m, RMS of a
/// position) is added to each.
VectorXd total_cases(const PredictedAccuracy& accuracy, double model_error,
                     double repeatability = 0);

/// Derivative of target positions at workspace configurations by the scaled parameters, in m:
/// blocks of 3 rows a target. As test poses they make V the inverse of the predicted mean square
/// position error and G that of the worst. `target`: that one only (from 0); -1: all.
/// Throws InputError for a target the sensor does not have.
Blocks make_prediction_blocks(const Campaign& campaign, const Parameters& parameters,
                              const RowMatrixXd& workspace, Index target = -1);

/// Accuracy over prediction blocks by the information matrix M (scaled parameters), of which
/// `prior` is what was expected before measuring (parameters square; empty or 0: nothing). The
/// percentile is of 200 draws a position, from stream (seed, position). Throws InputError if M is
/// not positive definite or there are no blocks.
PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const MatrixXd& prior = {}, std::uint64_t seed = 1);

/// The same with the campaign's prior, and known as surely as that says.
PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const Campaign& campaign);

}  // namespace posewise
