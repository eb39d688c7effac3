#pragma once

#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// What a campaign file may state to be as it says, by the words of its keys `known`.
struct KnownAxes {
    std::vector<std::string> base;     ///< x .. rz
    std::vector<std::string> targets;  ///< x, y, z, of all of them
};

/// What of base and sensor's unknowns no number of poses tells, as with a robot whose axes are all
/// parallel the heights of its base and of its targets.
struct Unknowable {
    std::vector<std::string> parameters;  ///< by their names; empty: nothing
    /// Each by itself enough: of the base alone, of the targets alone or, where neither is, of
    /// both.
    std::vector<KnownAxes> cures;
};

/// The robot taken as known; nothing where an earlier calibration tells of base and sensor. Throws
/// InputError if it is stopped.
Unknowable find_unknowable(const Campaign& campaign, const StopSignal& stop = {});

/// What to state: "known: [z], keys base.known or sensor.targets.known".
std::string describe_cures(const Unknowable& unknowable, const Campaign& campaign);

/// Throws InputError, which says what to state, where something is unknowable.
void check_knowable(const Campaign& campaign, const StopSignal& stop = {});

}  // namespace posewise
