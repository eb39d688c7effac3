#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// Base and targets, for the robot as expected (its errors are those in Campaign::nominal: zero,
/// unless with_earlier() changed them).
struct Registration {
    Parameters parameters;
    /// Why the measurements do not determine base and targets, as a sentence; empty: they do.
    std::string undetermined;

    bool is_determined() const { return undetermined.empty(); }
};

/// Finds base pose and sensor unknowns without an initial guess, for the robot as expected. For
/// points, with X = R_base^T and c = -R_base^T p_base, the equations X p_ij + c - R_i t_j = p_i are
/// linear in (X, c, t): least squares, X projected on SO(3), then polished on the true residuals.
/// If they leave a part of X open (points in planes, axes that cross), X is searched among the
/// rotations. A measured pose counts as four points. Lengths, and a partly known base, are polished
/// from the campaign's nominal values instead. An earlier estimate that is the prior fills in what
/// few configurations leave open. Not determined if a target with unknown position is seen in no
/// sample, or if the configurations are too few or too similar. Throws InputError if nominal values
/// are needed and not stated, or for measurements that do not fit the campaign.
Registration register_base_and_targets(const Campaign& campaign, const Measurements& measurements);

struct LevenbergMarquardtOptions;
/// As above, polished so.
Registration register_base_and_targets(const Campaign& campaign, const Measurements& measurements,
                                       const LevenbergMarquardtOptions& options);

/// As above without the polish, and without an earlier estimate.
Registration register_roughly(const Campaign& campaign, const Measurements& measurements);

/// Smallest number of generic configurations that a calibration needs. They identify what can be
/// identified (least_pose_count()). If that takes no nominal values, they also determine base and
/// targets, or what an earlier estimate that is the prior leaves open of them. At least
/// Campaign::fitted_pose_count, unless there is such an estimate.
Index least_calibration_count(const Campaign& campaign, const StopSignal& stop = {});

/// Returns the parameters; throws InputError with the reason if they are not determined.
Parameters determined(Registration registration);

/// Under a robust loss, each target in the mean of a configuration counts as loss(u), with u the
/// length of its whitened residual in robust standard deviations: the stated ones times s, where
/// s = median length / median length of normal errors * sqrt(n / dof).
/// Misstated noise then makes no outliers. dof is n, the number of observations, less the number of
/// parameters they determine: all, or trace(J^T J M^-1) with a prior. s is found together with the
/// parameters; s^2 is the estimate's variance factor. The covariance is H^-1 V H^-1 with
/// H = a J^T W J + P, V = b J^T W J + P, P the prior's information or 0, a = mean(g) / mean(w),
/// g = ((w u)' + (p - 1) w) / p for p rows per target, b = K^2 sum |w r|^2 / dof / mean(w),
/// K = 1 + (1 - dof / n) var(g) / mean(g)^2 [Huber & Ronchetti 2009, sec. 7.6, for vectors].
struct LevenbergMarquardtOptions {
    Index iteration_limit = 100;
    double relative_tolerance =
        1e-12;  ///< stops at this predicted relative decrease of the squares
    /// Whether to find the model error, too, if expected sizes are priors, and to learn these where
    /// they are open; else they are as stated.
    bool finds_model_error = true;
    Loss loss = {};        ///< width 0: 95 % of the efficiency of squares on normal errors
    StopSignal stop = {};  ///< ends it with the best result so far
};

/// Identifies base, robot and targets jointly, from `start`, by Levenberg-Marquardt on whitened
/// means with the analytic Jacobian and QR factorisations (never normal equations). If the
/// campaign's spread is a prior, the result is the maximum a posteriori: each robot error counts as
/// observed to be 0 with its scale as standard deviation, and the covariance is that of noise and
/// prior (else it is multiplied by the variance factor). The model error, unless it is stated to be
/// 0, is then found in turn with the parameters, separately for lengths and angles. Its mean square
/// follows from how well all other configurations predict each one, and from a log-normal prior
/// about the stated value with a factor of 2.5 as one standard deviation.
/// The sizes of the robot's errors, where the spread says that they are open, are learned in turn,
/// too (with squares, and without an earlier estimate as prior): those under which the measurements
/// are most probable [expectation maximisation, Dempster, Laird & Rubin 1977], with a log-normal
/// density about the expected ones, one standard deviation a factor of error_size_factor.
/// Ends NotIdentifiable if a target at an unknown place is seen in no sample, if there are fewer
/// equations than parameters, or if these poses do not show a direction of parameter space, and
/// names the parameters in it. Throws InputError for measurements that do not fit the campaign.
Estimate identify(const Campaign& campaign, const Measurements& measurements,
                  const Parameters& start, const LevenbergMarquardtOptions& options = {});

struct TwoStepOptions {
    Index iteration_limit = 200;
    double alpha = 1;                  ///< share of each robot step taken, in (0, 1]
    double relative_tolerance = 1e-9;  ///< stops at this relative decrease of the sum of squares
    StopSignal stop = {};              ///< ends it with the best result so far
};

/// Two-step identification [Wu et al. 2015]: base and targets by linear least squares with the
/// robot fixed, then the robot's parameters with base and targets fixed, in turn. Converges slowly
/// to the optimum of identify(); the covariance is still the joint one. Ends and throws as
/// identify() does.
Estimate identify_two_step(const Campaign& campaign, const Measurements& measurements,
                           const Parameters& start, const TwoStepOptions& options = {});

/// Held-out residuals. The measurements are split into `folds` groups of configurations, in turn:
/// configuration i is in group i mod folds, but equal joint values share a group. Each group is
/// predicted by an identification of the others that starts at `start`; folds = configuration count
/// is leave-one-configuration-out. It is fastest from the estimate of all, which is near those of
/// the folds. With squares and the stated model error, a fold then takes a few Gauss-Newton steps
/// by normal equations; the first uses those of all less the rows held out. It ends where
/// identify() would. identify() takes over if steps do not shrink fast or rounding might matter.
/// `progress` counts folds.
struct CrossValidation {
    Index folds = 0;
    Metrics samples;  ///< over all samples of all groups
    Metrics means;
    RowMatrixXd squared_distances;      ///< for the means, see squared_distances(); 0 in failures
    RowMatrixXd squared_angles;         ///< likewise
    std::vector<std::string> failures;  ///< folds that could not be identified, and why
    /// Like residuals() of the measurements, each row from the identification without it; NaN in
    /// failures.
    RowMatrixXd residuals{};
};
CrossValidation cross_validate(const Campaign& campaign, const Measurements& measurements,
                               const Parameters& start, Index folds,
                               const LevenbergMarquardtOptions& options = {},
                               const ProgressCallback& progress = {});

/// Where a global identification starts: at random errors, or at the best ones that covariance
/// matrix adaptation has found, with base and targets registered for each.
enum class StartSearch { Random, CmaEs };

/// How far the nominal robot may be off, and how hard to search.
struct GlobalOptions {
    double length_share = 0.3;                   ///< error of a length, as a share of it
    double least_length = 0.05;                  ///< lower bound of that error, m
    double angle = 20 * std::numbers::pi / 180;  ///< error of an angle, rad
    StartSearch search = StartSearch::Random;
    Index evaluation_limit = 20000;  ///< for one search by covariance adaptation
    Index start_limit = 200;
    Index agreeing_starts = 3;  ///< stops when this many end at the best sum of squares
    std::uint64_t seed = 1;     ///< start i draws from stream (seed, i)
    LevenbergMarquardtOptions start_options{};  ///< for each start; its loss must be squares
    ProgressCallback progress{};  ///< counts starts; agreeing ones end them before the total
};

struct GlobalEstimate {
    Estimate estimate;  ///< the best
    Index starts = 0;
    Index starts_at_best = 0;  ///< only one: there may be better ones
};

/// Identifies a robot whose nominal parameters are far off: identify() from the nominal robot and
/// from others within the bounds, with base and targets registered anew for each. Independent of
/// the number of threads. Ends NotIdentifiable if every start does, like the first one. Throws
/// InputError as identify() does, for options out of range, and if the spread is a prior, because
/// that says that errors are small.
GlobalEstimate identify_globally(const Campaign& campaign, const Measurements& measurements,
                                 const GlobalOptions& options = {});

/// Some of a robot's error parameters, as a model to choose.
struct ParameterSet {
    std::string name;
    std::vector<std::string> parameters;  ///< the chain's parameters, by name
};

/// The chain's parameters as nested sets, each with all of the previous one: none (base and targets
/// only), joint offsets (constant errors of driven elements), + lengths (other constant errors
/// along an axis), + other geometric, + gravity terms, + free terms, + harmonics, + tilts of axes,
/// + scales and gear ratios.
/// Steps that add nothing are left out.
std::vector<ParameterSet> nested_parameter_sets(const Chain& chain);

/// One parameter set, calibrated. Distances are those of configuration means, m.
struct ModelTrial {
    ParameterSet set;
    Index parameter_count = 0;  ///< including base and targets
    double fit_rms = 0;         ///< over all configurations used
    double held_out_rms = 0;    ///< each group predicted from the others
    double standard_error = 0;  ///< standard error of held_out_rms, over configurations
    std::string failure = {};   ///< why there are no figures; empty: there are
};

struct ModelSelection {
    Index folds = 0;
    std::vector<ModelTrial> trials;  ///< smallest set first
    Index best = -1;  ///< the set with the least held-out error; -1: no set could be identified
    /// The smallest set within one standard error of the best [Breiman et al. 1984, sec. 3.4.3].
    Index recommended = -1;
    /// Under a robust loss: outliers of the largest set that could be identified. They take part in
    /// every calibration but are not used to judge any.
    std::vector<Outlier> not_judged;
};

/// Calibrates each of nested_parameter_sets() and compares the mean squared held-out errors of
/// cross_validate(). The standard error of a mean takes each configuration as one draw: with S_i
/// the sum over its n_i points, N points in m configurations, it is
/// sqrt(m / (m - 1) sum (S_i - mean n_i)^2) / N [Cochran 1977, ch. 6].
/// Every identification starts at `registered`, the result of register_base_and_targets().
/// `progress` counts sets. Throws InputError for folds as cross_validate() does.
ModelSelection select_model(const Campaign& campaign, const Measurements& measurements,
                            const Parameters& registered, Index folds,
                            const LevenbergMarquardtOptions& options = {},
                            const ProgressCallback& progress = {});

}  // namespace posewise
