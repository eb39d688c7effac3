#pragma once

#include "bound.hpp"
#include "pricing.hpp"

namespace posewise::detail {

/// options.held, or zeros.
MatrixXd held_information(const Blocks& candidates, const SelectOptions& options);

/// All choices that the options allow; holds references.
OpenChoices all_open(const Blocks& candidates, const SelectOptions& options, const MatrixXd& held);

/// upper_bound() with the objective made once for many M.
double upper_bound(const Objective& objective, const Blocks& candidates,
                   const SelectOptions& options, const MatrixXd& M);

}  // namespace posewise::detail
