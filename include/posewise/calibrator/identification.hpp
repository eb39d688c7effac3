#pragma once

#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/core/stop.hpp"

namespace posewise {

/// Under a robust loss each target of a configuration's mean counts as loss(u), u the length of its
/// whitened residual in robust standard deviations: those stated times s, s = median length /
/// median_length() * sqrt(equations / degrees of freedom), so that noise stated wrong does not make
/// outliers. s is found together with the parameters; s^2 is the estimate's variance factor. The
/// weighted least squares J^T W J of the optimum give the covariance f (J^T W J)^-1,
/// f = sum |w r|^2 / dof * mean(w) / mean(((w u)' + (p - 1) w) / p)^2 for p rows a target
/// [Huber & Ronchetti 2009, sec. 7.6, for vectors]; with a prior f = 1.
struct LevenbergMarquardtOptions {
    Index iteration_limit = 100;
    double relative_tolerance =
        1e-12;             ///< predicted relative fall of the sum of squares to stop at
    Loss loss = {};        ///< width 0: default_width()
    StopSignal stop = {};  ///< ends it with the best so far
};

/// Joint identification of base, robot and targets by Levenberg-Marquardt on whitened means, with
/// the analytic Jacobian and QR factorisations (never normal equations), from `start`. Where the
/// campaign's spread is a prior, the maximum a posteriori: each error of the robot counts as
/// observed to be 0 with its scale as standard deviation, and the covariance is that of the stated
/// noise and prior (else it is multiplied by the variance factor).
/// Ends NotIdentifiable where a target at an unknown place is seen in no sample, where there are
/// fewer equations than parameters, or where these poses do not show a direction of parameter
/// space, and names the parameters in it. Throws InputError for measurements that do not fit the
/// campaign.
Estimate identify(const Campaign& campaign, const Measurements& measurements,
                  const Parameters& start, const LevenbergMarquardtOptions& options = {});

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
/// that starts at `start`. folds = configuration count is leave-one-configuration-out. `progress`
/// is that of the folds.
struct CrossValidation {
    Index folds = 0;
    Metrics samples;  ///< over all samples of all groups
    Metrics means;
    RowMatrixXd squared_distances;      ///< of the means, see squared_distances(); 0 in failures
    std::vector<std::string> failures;  ///< folds that could not be identified, and why
};
CrossValidation cross_validate(const Campaign& campaign, const Measurements& measurements,
                               const Parameters& start, Index folds,
                               const LevenbergMarquardtOptions& options = {},
                               const ProgressCallback& progress = {});

}  // namespace posewise
