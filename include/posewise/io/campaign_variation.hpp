#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::io {

/// One key of a campaign file, and the values it takes in turn.
struct VariedKey {
    std::string key;                  ///< with those it stands under: "sensor.sigma_mm"
    std::vector<std::string> values;  ///< as YAML: "0.05", "[1, 2, 3]", "full"
    std::optional<std::pair<double, double>> range{};  ///< instead: any number between
};

/// From "sensor.sigma_mm=0.01,0.05" or "sensor.sigma_mm=0.01..0.05". Throws InputError for a text
/// that is none such, and for a range that is empty.
VariedKey parse_varied_key(const std::string& text);

/// A campaign file's text with other values of some keys.
struct Variation {
    std::string name;  ///< "sensor.sigma_mm=0.01 sensor.targets.count=3"; empty: as it is
    std::string content;
};

/// Every combination of the values, the last key's change first; without keys the text as it is. A
/// number in a key is an item of a list, from 1: "sensor.targets.1.position_mm". Keys that are not
/// there are added; whether they may be there is for parse_campaign() to say. Ranges, if there are
/// some, are filled together by so many points, each beside every combination of the values: an
/// additive recurrence with the powers of the root of x^(d+1) = x + 1 for d ranges, of which fewer
/// points are the first ones; evenly by ratio where the upper end is at least ten times a positive
/// lower one. Throws InputError if the text at `path` is no YAML, for a key under something that is
/// not a map or list, and for ranges without points or points without ranges.
std::vector<Variation> vary_campaign(const std::string& content, const std::string& path,
                                     const std::vector<VariedKey>& keys, Index point_count = 0);

}  // namespace posewise::io
