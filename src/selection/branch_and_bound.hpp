#pragma once

#include "bound.hpp"
#include "local_search.hpp"

namespace posewise::detail {

/// Seconds of a CPU that a proof may take where nothing is said of it.
constexpr double usual_proof = 0.7;

/// What a search of all choices proves.
struct Proof {
    ScoredPoses best;
    double bound = std::numeric_limits<double>::infinity();  ///< no choice has a larger value
    Index tried = 0;                                         ///< choices that no bound ruled out
    bool is_complete = false;                                ///< so `best` is optimal
};

/// When a proof ends before it is complete.
struct ProofLimits {
    double seconds = 0;  ///< of a CPU, about
    /// Whether to give up after a tenth of them where that settled less than a tenth of the
    /// choices, and not to begin where there are too many for any hope.
    bool is_only_if_likely = false;
    double bound = -std::numeric_limits<double>::infinity();  ///< is enough
};

/// Branch and bound over the candidates: parts of all choices that take some candidates and rule
/// out others (see Explorer), that of the largest bound first. Of choices that are equally good the
/// lexicographically first is kept. Time is counted in operations, so that the result depends
/// neither on the machine's speed nor on the number of threads. Nothing beyond the certificate's
/// bound is proven where `best` identifies nothing or there is no time, or no memory for all
/// candidates' information matrices.
Proof prove(const SearchProblem& problem, const Certificate& certificate, const ScoredPoses& best,
            const ProofLimits& limits);

/// The same of a choice that is known, until its `bound` is proven, or for ten times as long as it
/// may have taken.
Proof prove_choice(const Blocks& candidates, const SelectOptions& options,
                   const std::vector<Index>& poses, const Certificate& certificate, double bound);

}  // namespace posewise::detail
