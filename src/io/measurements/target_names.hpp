#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/types.hpp"

/// Names under which an instrument knows the targets of planned poses.
namespace posewise::detail {

/// "P001" for the id p1, "P017" for 17: capital letters, numbers of three digits at least, nothing
/// but letters, digits, `_` and `-`, and a letter first.
std::string pose_name(std::string_view id);

/// "P001_T1": a pose's target, from 0.
std::string target_name(std::string_view id, Index target);

/// Two ids of which some targets have names that mean the same, and such a name.
struct SameName {
    std::string first;
    std::string second;
    std::string name;
};
std::optional<SameName> find_same_name(const std::vector<std::string>& ids, Index target_count);

/// What names that mean the same have in common: what stands behind the last `::`, without regard
/// to case, leading zeros, and separators unless between two digits. "p1t1" of "A::B::P001_T1".
std::string name_key(std::string_view name);

}  // namespace posewise::detail
