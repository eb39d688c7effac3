#pragma once

#include <span>

namespace posewise::detail {

/// Lengths that were written in one unit and read in another.
struct LengthUnitMistake {
    double factor;      ///< with which the lengths read are right
    const char* meant;  ///< "mm", "feet"
    const char* read;   ///< "m"
};

/// All that are tried.
std::span<const LengthUnitMistake> length_unit_mistakes();

/// The mistake that this factor of one of them mends.
const LengthUnitMistake& mistake_of(double factor);

/// The factor of the mistake that is nearest to this one by its ratio; 1 where none is nearer.
double nearest_length_factor(double factor);

}  // namespace posewise::detail
