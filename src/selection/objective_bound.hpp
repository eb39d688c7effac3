#pragma once

#include "bound.hpp"
#include "pricing.hpp"

namespace posewise::detail {

/// The information of options.held_rows; zeros without.
MatrixXd held_information(const Blocks& candidates, const SelectOptions& options);

/// All choices that the options allow; holds references.
OpenChoices all_open(const Blocks& candidates, const SelectOptions& options, const MatrixXd& held);

/// choice_value() with the objective made once for many choices.
double choice_value(const Objective& objective, const Blocks& candidates,
                    const SelectOptions& options, const std::vector<Index>& poses);

}  // namespace posewise::detail
