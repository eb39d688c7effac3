#pragma once

#include "least_squares.hpp"

/// What a robust loss adds to least squares; the formulas stand at LevenbergMarquardtOptions.
namespace posewise::detail {

/// With the default width for this sensor where it is 0. Throws InputError for a width that is
/// negative or not finite.
Loss complete_loss(const Loss& loss, const Campaign& campaign);

/// How many of the parameters squares would determine from what is observed: all without a prior.
double parameters_used(const IdentificationProblem& problem, const Parameters& parameters);

/// Standard deviation of a whitened coordinate from the median length of the residuals of
/// parameters_used(): half of the targets may be anywhere. At least 1e-6, 1 without a degree of
/// freedom.
double robust_deviation(const IdentificationProblem& problem, const Parameters& parameters,
                        double used);

/// Covariance of scaled parameters, see LevenbergMarquardtOptions; R is the triangle of the
/// weighted equations, those of the prior among them.
MatrixXd robust_covariance(const IdentificationProblem& problem, const Parameters& parameters,
                           const MatrixXd& R);

/// The campaign with a noise that the loss can weigh: robust losses weigh targets one by one, so
/// that each has all of the model error by itself.
Campaign weighed_campaign(const Campaign& campaign, const Loss& loss);

std::vector<Outlier> find_outliers(const IdentificationProblem& problem,
                                   const Parameters& parameters);

/// Points that were seen and are no outliers: configurations x targets.
Seen points_but_outliers(const Measurements& measurements, const std::vector<Outlier>& outliers);

}  // namespace posewise::detail
