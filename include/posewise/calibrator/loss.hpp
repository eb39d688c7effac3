#pragma once

#include <string_view>

#include "posewise/core/types.hpp"

namespace posewise {

/// How much a large residual counts. All agree on small ones, where the loss is u^2.
enum class LossKind {
    Squares,  ///< u^2: best for normal errors, at the mercy of one bad point
    Huber,    ///< grows as |u| beyond the width: one optimum, gross errors still pull a little
    Cauchy,   ///< width^2 log(1 + (u / width)^2): gross errors hardly pull at all
};
std::string_view loss_name(LossKind kind);

/// The loss of the length u of one target's residual, in standard deviations of one coordinate.
struct Loss {
    LossKind kind = LossKind::Squares;
    double width = 0;  ///< where it leaves u^2, in standard deviations; not looked at for squares

    double value(double u) const;
    /// Part with which the residual counts in the weighted least squares with the same gradient:
    /// value'(u) / 2u, from 1 down.
    double weight(double u) const;
    /// Rate of weight(u) u.
    double influence_rate(double u) const;
};

/// The width for which the estimate has 95 % of the efficiency of least squares on normal errors of
/// `rows` coordinates: 1.345 (Huber) and 2.385 (Cauchy) for one, more for more.
double default_width(LossKind kind, Index rows);

/// Median length of a vector of so many independent standard normal numbers.
double median_length(Index rows);

/// Length beyond which such a vector is an outlier: as rare as a normal number beyond 4 (3e-5), by
/// the approximation of [Wilson & Hilferty 1931].
double outlier_length(Index rows);

}  // namespace posewise
