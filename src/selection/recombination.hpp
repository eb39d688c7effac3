#pragma once

#include "local_search.hpp"

namespace posewise::detail {

/// The best of `best` and what choices lead to when they are crossed two by two [memetic search:
/// Moscato 1989]: a child has the poses that both have, draws the others from those of either, is
/// improved (where the shortlist has_far(), with the candidates nearest() the best; with all of it
/// only if that makes it good enough), and takes the place of the worst of a population whose
/// members all differ. Local optima share most of their poses with better ones, which kicks of a
/// single one seldom reach. Ends when several generations in a row change nothing. `options.seed`
/// decides what is drawn, whatever the number of threads.
ScoredPoses recombine(const SearchProblem& problem, const Shortlist& shortlist,
                      const ScoredPoses& best, const std::vector<ScoredPoses>& choices);

}  // namespace posewise::detail
