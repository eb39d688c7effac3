#pragma once

#include "criteria/objective.hpp"
#include "posewise/core/progress.hpp"
#include "working_set.hpp"

namespace posewise::detail {

/// The nearest point of {0 <= w <= upper, sum w = total}. Requires sum upper >= total.
VectorXd project_on_capped_simplex(const VectorXd& point, const VectorXd& upper, double total);

/// Logarithm of the criterion (D: value / parameters, whose exponential is degree 1).
double log_value(const Objective& objective, const MatrixXd& M);
/// Its gradient by M and, unless null, log_value().
MatrixXd log_gradient(const Objective& objective, const MatrixXd& M, double* log_value = nullptr);

/// What spectral projected gradient works on: members' weights in [0, upper] that sum to total.
struct WeightProblem {
    const Objective& objective;
    const WorkingSet& set;
    const MatrixXd& held;
    const VectorXd& upper;
    double total = 0;
};

struct WeightSearch {
    VectorXd weights;
    MatrixXd M;            ///< held + weighted information
    double threshold = 0;  ///< sensitivity (of the logarithm) a candidate needs for a weight
    Index iterations = 0;
};

/// Ascends from `start` until the linear model promises less than `tolerance` of log_value().
WeightSearch ascend(const WeightProblem& problem, const VectorXd& start, double tolerance,
                    Index iteration_limit, const StopSignal& stop);

}  // namespace posewise::detail
