#pragma once

#include <vector>

namespace posewise::detail {

/// x^(-1/2) = sum_k weight_k / (x + shift_k).
struct InverseRoot {
    std::vector<double> shifts;
    std::vector<double> weights;
};

/// To nine digits for x from `least` to `largest`, both positive; below `least` the sum is too
/// small, but never smaller than at `least` [Hale, Higham & Trefethen 2008, method 3].
InverseRoot make_inverse_root(double least, double largest);

}  // namespace posewise::detail
