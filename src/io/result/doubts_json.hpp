#pragma once

#include "io/format/json.hpp"
#include "posewise/task/doubts.hpp"

namespace posewise::detail {

/// In words, with RMS in mm and deg.
Json reading_to_json(const BetterReading& reading);

/// What looks wrong, in mm, mrad and deg; a key for each kind of doubt that there is.
Json doubts_to_json(const Campaign& campaign, const Doubts& doubts);
Json cures_to_json(const Campaign& campaign, const Cures& cures);

}  // namespace posewise::detail
