#pragma once

#include "choice_problem.hpp"

/// What a cell says of candidates that are chosen from.
namespace posewise::detail {

/// Leaves out candidates that the campaign's cell does not allow, and of the others the targets
/// that it lets nobody see; notes how many they are. `are_places_found`: base and targets are those
/// of ChoiceProblem::parameters though the campaign does not state them; where they are neither,
/// nothing is said of what is seen. Throws InputError if none is allowed.
void heed_cell(ChoiceProblem& problem, const Campaign& campaign, bool are_places_found);

/// Notes describe_unchecked_bodies() of poses that were not measured.
void add_unchecked_bodies(ChoiceProblem& problem, const Campaign& campaign);

}  // namespace posewise::detail
