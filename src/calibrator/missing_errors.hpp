#pragma once

#include "least_squares.hpp"

namespace posewise::detail {

/// How much of the squares that `parameters`, an optimum, leave over follows errors of the joints
/// that the robot's model has not, torque shapes (where it has no torque at all) and harmonics of
/// the orders 1 and 2; about, 0 to 1, and 0 if chance would do it once in a thousand cases. Nothing
/// is identified for it: with C the missing errors' columns, scaled by their expected sizes, less
/// what the model's explain, and r the residuals in units of their deviation, |C^T r|^2 has the
/// mean tr(C^T C) and the variance 2 tr((C^T C)^2) where the errors are none, about as chi squared
/// times a factor [Satterthwaite 1946]; errors of s times their sizes add s^2 tr((C^T C)^2): the
/// score test of a variance component [Lin 1997, Biometrika 84].
double missing_errors(const IdentificationProblem& problem, const Parameters& parameters);

}  // namespace posewise::detail
