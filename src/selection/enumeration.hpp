#pragma once

#include <optional>

#include "local_search.hpp"
#include "relaxation.hpp"

namespace posewise::detail {

/// How long an enumeration may take.
enum class Patience {
    Short,  ///< about half a second of a CPU
    Full,   ///< about ten seconds
};

/// What is left when choices were tried.
struct Enumerated {
    ScoredPoses best;
    Index tried = 0;           ///< choices that the bound left open
    bool is_complete = false;  ///< so `best` is proven optimal; else there was no time for all
};

/// Tries every choice that the bound of the relaxation's certificate allows to be as good as
/// `best`: depth first over the candidates, eight choices at a time. Of choices that are equally
/// good the lexicographically first is kept. Nothing if more than options.enumeration are open, if
/// their factorisations would take longer than `patience`, or if `best` identifies nothing.
std::optional<Enumerated> enumerate_open_choices(const SearchProblem& problem,
                                                 const Relaxation& relaxation,
                                                 const ScoredPoses& best, Patience patience);

}  // namespace posewise::detail
