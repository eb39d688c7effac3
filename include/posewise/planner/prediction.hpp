#pragma once

#include <cstdint>

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
    /// With a prior, directions of the parameters that are known independently of each other before
    /// and after measuring: which part of the mean square is by each (sum 1), and which part of
    /// what is known of it the prior tells. Empty without one.
    VectorXd by_direction{};
    VectorXd prior_part{};
    /// Which part of the noise's square the model error's is; the rest the sensor's and joints'.
    double model_share = 1;
    KnownWithin known_within{};

    /// By which part the mean square follows that of the expected sizes, by the logarithm; it
    /// follows that of the noise by the rest.
    double prior_share() const { return by_direction.dot(prior_part); }
    /// The mean square is so many times that predicted where the squares of the model error and of
    /// the parameters' sizes are so many times those expected. A calibration finds the former from
    /// what it leaves over and weights by it; sizes it takes as expected.
    double growth(double model_square, double size_square) const;
};

/// The same with what the model cannot express, which no number of poses reduces: RMS over
/// workspace and targets, m.
struct PredictedTotal {
    double rms = 0;    ///< with the model error as the campaign expects it
    double lower = 0;  ///< ends of the 90 % interval: the parameters' errors are drawn, the model
    double upper = 0;  ///< error and, with a prior, the size of all errors, log-normal (see below)
};

/// Of 4096 cases that fill what is not known evenly. Model error and sizes are drawn as
/// PredictedAccuracy says they are known; the parameters' errors follow by its growth(). The
/// instrument's noise is as stated.
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

/// How much the information of poses falls, by the logarithm, where the square of a noise grows
/// (scaled parameters).
struct InformationByNoise {
    MatrixXd model;  ///< of the model error
    MatrixXd noise;  ///< of the sensor's and joints' noise
};

/// Of poses (m x joints), each target measured so many `repeats` (m x targets). By differences.
InformationByNoise information_by_noise(const Campaign& campaign, const Parameters& parameters,
                                        const RowMatrixXd& configurations,
                                        const RowMatrixXd& repeats);

/// Accuracy over prediction blocks by the information matrix M (scaled parameters), of which
/// `prior` is what was expected before measuring (parameters square; empty or 0: nothing). The
/// percentile is of 200 draws a position, from stream (seed, position). Throws InputError if M is
/// not positive definite or there are no blocks.
PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const MatrixXd& prior = {}, std::uint64_t seed = 1);

/// The same with the campaign's prior, and known as surely as that says; `by_noise` of the poses
/// tells PredictedAccuracy::model_share, also for what is held of others.
PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const Campaign& campaign, const InformationByNoise& by_noise);

}  // namespace posewise
