#pragma once

#include "posewise/planner/planning.hpp"

namespace posewise::detail {

/// One case of what is not known before measuring.
struct Unknowns {
    double uniform = 0.5;  ///< between 0 and 1: of the parameters' errors
    double model = 1;      ///< the model error is so many times the expected one
    double growth = 1;     ///< and the squares of the parameters' errors of those predicted
};

/// Case k of `count` that fill the space of all cases evenly, so that few make a sure quantile: the
/// model error in steps of equal probability, the others by an additive recurrence with the powers
/// of the root of x^3 = x + 1.
Unknowns draw_unknowns(Index k, Index count, const PredictedAccuracy& accuracy);

}  // namespace posewise::detail
