#pragma once

#include "core/names.hpp"
#include "posewise/calibrator/estimate.hpp"

namespace posewise::detail {

inline constexpr Names<LossKind, 3> loss_names{
    {{LossKind::Squares, "squares"}, {LossKind::Huber, "huber"}, {LossKind::Cauchy, "cauchy"}}};

/// The width for which the estimate has 95 % of the efficiency of least squares on normal errors of
/// `rows` coordinates: 1.345 (Huber) and 2.385 (Cauchy) for one, more for more.
double default_width(LossKind kind, Index rows);

/// Median length of a vector of so many independent standard normal numbers.
double median_length(Index rows);

/// Length beyond which such a vector is an outlier: as rare as a normal number beyond 4 (3e-5), by
/// the approximation of [Wilson & Hilferty 1931].
double outlier_length(Index rows);

}  // namespace posewise::detail
