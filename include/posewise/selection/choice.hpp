#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/criteria/criterion.hpp"

namespace posewise {

/// What proves the bound of a choice: verify() needs nothing else, so it can be verified
/// without an optimiser. Any positive definite M proves some bound; the optimum of the continuous
/// relaxation the best one.
struct Certificate {
    MatrixXd M;
    double sharpness =
        std::numeric_limits<double>::infinity();  ///< of smoothing at M; infinity: none
};

/// A choice of poses out of candidates.
struct Choice {
    std::vector<Index> poses;  ///< candidate indices, ascending; one listed twice is measured twice
    Criterion criterion = Criterion::D;
    double value = -std::numeric_limits<double>::infinity();
    /// No K candidates have a larger value. Infinity: nothing proven.
    double bound = std::numeric_limits<double>::infinity();
    /// In [0, 1]: the part of the best possible value that is proven reached. D: exp((value -
    /// bound) / parameters), others: value / bound.
    double efficiency = 0;
    Certificate certificate;
    std::uint64_t seed = 0;
    Index starts = 0;          ///< independent ones that ended; a stop cuts others short
    Index starts_at_best = 0;  ///< how many of them ended at this value
    /// Choices that no bound ruled out and that were tried: of an optimal choice all such. None:
    /// branch and bound did not come so far.
    Index tried = 0;
    Ending ending = Ending::NotRun;
    /// Where the ending is NotIdentifiable, which directions stay open and what would close them,
    /// as a sentence; then there are no poses.
    std::string undetermined;
};

/// The choice, for those to whom candidates that do not identify the parameters are no input:
/// throws InputError with the reason.
Choice determined(Choice choice);

}  // namespace posewise
