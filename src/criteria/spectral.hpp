#pragma once

#include "objective.hpp"

namespace posewise::detail {

/// A function of several numbers and its slope by each of them.
struct Sloped {
    double value = 0;
    VectorXd slope;
};

/// Each to the power.
Eigen::ArrayXd powers(const Eigen::ArrayXd& x, double exponent);

/// (sum x^-p)^(-1/p) of positive numbers; the least itself for infinite p.
Sloped soft_least(const VectorXd& x, double p);

/// (sum x^p)^(1/p) of positive numbers; the largest itself for infinite p.
Sloped soft_largest(const VectorXd& x, double p);

/// D or O1 of a matrix with L rows by the logarithm of its determinant.
double value_of_log_determinant(const Objective& objective, double log_determinant, Index L);

/// All criteria but G and V as a function of M's eigenvalues (ascending, positive).
Sloped spectral_criterion(const Objective& objective, const VectorXd& eigenvalues);

}  // namespace posewise::detail
