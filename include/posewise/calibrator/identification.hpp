#pragma once

#include <cstdint>
#include <numbers>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/progress.hpp"

namespace posewise {

/// Under a robust loss each target of a configuration's mean counts as loss(u), u the length of its
/// whitened residual in robust standard deviations: those stated times s, s = median length /
/// normal errors' * sqrt(n / dof), so that noise stated wrong does not make outliers. Of n
/// observations dof are left over by the parameters they determine: all, with a prior
/// trace(J^T J M^-1). s is found together with the parameters; s^2 is the estimate's variance
/// factor. The covariance is H^-1 V H^-1 with H = a J^T W J + P, V = b J^T W J + P, P the prior's
/// information or 0, a = mean(g) / mean(w), g = ((w u)' + (p - 1) w) / p for p rows a target,
/// b = K^2 sum |w r|^2 / dof / mean(w), K = 1 + (1 - dof / n) var(g) / mean(g)^2
/// [Huber & Ronchetti 2009, sec. 7.6, for vectors].
struct LevenbergMarquardtOptions {
    Index iteration_limit = 100;
    double relative_tolerance =
        1e-12;  ///< predicted relative fall of the sum of squares to stop at
    /// Where expected sizes are priors, finds the model error, too; else it is as stated.
    bool finds_model_error = true;
    Loss loss = {};        ///< width 0: 95 % of the efficiency of squares on normal errors
    StopSignal stop = {};  ///< ends it with the best so far
};

/// Joint identification of base, robot and targets by Levenberg-Marquardt on whitened means, with
/// the analytic Jacobian and QR factorisations (never normal equations), from `start`. Where the
/// campaign's spread is a prior, the maximum a posteriori: each error of the robot counts as
/// observed to be 0 with its scale as standard deviation, and the covariance is that of noise and
/// prior (else it is multiplied by the variance factor). The model error, if it is not stated to be
/// 0, is then found in turn with the parameters, of lengths and angles apart: its mean square by
/// how well each configuration is predicted by all the others and a log-normal prior about what the
/// campaign states, one standard deviation a factor of 2.5.
/// Ends NotIdentifiable where a target at an unknown place is seen in no sample, where there are
/// fewer equations than parameters, or where these poses do not show a direction of parameter
/// space, and names the parameters in it. Throws InputError for measurements that do not fit the
/// campaign.
Estimate identify(const Campaign& campaign, const Measurements& measurements,
                  const Parameters& start, const LevenbergMarquardtOptions& options = {});

/// The campaign's spread with the sizes that this robot's errors have, of lengths, angles, joint
/// offsets, gravity (torque) terms and harmonics: where the spread is a prior, the sizes under
/// which the measurements are most probable, by expectation and maximisation [Dempster, Laird &
/// Rubin 1977] of each error's square, estimate^2 + variance, with a log-normal density about the
/// size stated, its deviation a factor of error_size_factor. Sizes stated by parameter's name stay.
/// Throws InputError where the spread is no prior, and as identify() does.
ParameterSpread learn_sizes(const Campaign& campaign, const Measurements& measurements,
                            const Parameters& start, const LevenbergMarquardtOptions& options = {});

/// A size that was stated far too small to be learned.
struct HeldBackSize {
    SharedSize held;     ///< as learned
    double fitting = 0;  ///< m or rad
};

/// Where learn_sizes() got stuck: a size stated far too small holds its errors back, and others
/// take them up. `learned` has the sizes learned from `stated`, and the model error found with
/// them. Of the sizes that errors which nothing holds back go beyond by more than three times, the
/// one that alone makes the measurements most probable is tried: the sizes are learned again from
/// it. Nothing if the measurements are not clearly more probable then (150 to 1), or for losses but
/// squares.
std::optional<HeldBackSize> find_held_back_size(const Campaign& learned,
                                                const ParameterSpread& stated,
                                                const Measurements& measurements,
                                                const Parameters& start,
                                                const LevenbergMarquardtOptions& options = {});

struct TwoStepOptions {
    Index iteration_limit = 200;
    double alpha = 1;                  ///< part of each robot step taken, in (0, 1]
    double relative_tolerance = 1e-9;  ///< predicted relative fall of the sum of squares to stop at
    StopSignal stop = {};              ///< ends it with the best so far
};

/// The two-step identification of [Wu et al. 2015]: base and targets by linear least squares with
/// the robot fixed, then the robot's parameters with base and targets fixed, in turn. Heads to the
/// same optimum as identify(), slowly; the covariance is the joint one all the same.
/// Ends and throws as identify() does.
Estimate identify_two_step(const Campaign& campaign, const Measurements& measurements,
                           const Parameters& start, const TwoStepOptions& options = {});

/// Held-out residuals: the measurements are split into `folds` groups of configurations (in turn:
/// configuration i is in group i mod folds), each predicted by an identification of the others
/// that starts at `start`. folds = configuration count is leave-one-configuration-out. Quickest
/// from the estimate by all, near which the others' are: with squares, and the model error as
/// stated, a fold then takes a few Gauss-Newton steps by normal equations, the first by those of
/// all less those held out, and ends where identify() would, which takes over where steps do not
/// shrink fast or rounding might matter. `progress` is that of the folds.
struct CrossValidation {
    Index folds = 0;
    Metrics samples;  ///< over all samples of all groups
    Metrics means;
    RowMatrixXd squared_distances;      ///< of the means, see squared_distances(); 0 in failures
    RowMatrixXd squared_angles;         ///< likewise
    std::vector<std::string> failures;  ///< folds that could not be identified, and why
    /// As residuals() of the measurements has them, each row by the identification without it; NaN
    /// in failures.
    RowMatrixXd residuals{};
};
CrossValidation cross_validate(const Campaign& campaign, const Measurements& measurements,
                               const Parameters& start, Index folds,
                               const LevenbergMarquardtOptions& options = {},
                               const ProgressCallback& progress = {});

/// Where the starts of a global identification are: anywhere, or where a population search, over
/// the robot's errors alone with base and targets registered for each, has found its best.
enum class StartSearch { Random, Crs2, Esch, Isres, CmaEs };

/// How far the nominal robot may be off, and how hard to search.
struct GlobalOptions {
    double length_share = 0.3;                   ///< error of a length, as part of it
    double least_length = 0.05;                  ///< m; that of any length at least
    double angle = 20 * std::numbers::pi / 180;  ///< error of an angle, rad
    StartSearch search = StartSearch::Random;
    Index evaluation_limit = 20000;  ///< of one population search
    Index start_limit = 200;
    Index agreeing_starts = 3;  ///< stop when so many ended at the best sum of squares
    std::uint64_t seed = 1;     ///< start i draws from stream (seed, i)
    LevenbergMarquardtOptions start_options{};  ///< of each start; its loss must be squares
    ProgressCallback progress{};  ///< of the starts; agreeing ones end them before the total
};

struct GlobalEstimate {
    Estimate estimate;  ///< the best
    Index starts = 0;
    Index starts_at_best = 0;  ///< one alone: there may be better ones
};

/// Identification of a robot whose nominal parameters are far off: identify() from the nominal
/// robot and from others within the bounds, base and targets registered anew for each. The
/// same for any number of threads. Ends NotIdentifiable where every start does, as the first.
/// Throws InputError as identify() does, for options out of range, and where the spread is a prior,
/// since that says errors are small.
GlobalEstimate identify_globally(const Campaign& campaign, const Measurements& measurements,
                                 const GlobalOptions& options = {});

}  // namespace posewise
