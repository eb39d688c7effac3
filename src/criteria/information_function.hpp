#pragma once

#include "objective.hpp"

namespace posewise::detail {

/// Parameters of interest: those of M that are not nuisance.
Index interest_count(const Objective& objective, Index parameter_count);

/// Whether the criterion is an increasing function of a concave information function phi(M) of
/// degree 1 [Pukelsheim 1993, ch. 5]; all are but O2 and O4.
bool has_information_function(Criterion criterion);

/// phi at a criterion value: det^(1/L) for D, the square for O3 and O5, m times it for O1, the
/// value itself for the others.
double information_of_value(const Objective& objective, double value, Index parameter_count);
/// The way back.
double value_of_information(const Objective& objective, double phi, Index parameter_count);

/// Z with phi(M*) <= trace(Z M*) for every positive semidefinite M* (phi not smoothed), from any
/// positive definite M; equal at M* = M if the criterion is smooth or the sharpness infinite.
/// Requires has_information_function() and a finite evaluate(M).
MatrixXd supporting_matrix(const Objective& objective, const MatrixXd& M);

}  // namespace posewise::detail
