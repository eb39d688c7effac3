#pragma once

#include "core/names.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::detail {

inline constexpr Names<Focus, 3> focus_names{
    {{Focus::All, "all"}, {Focus::Robot, "robot"}, {Focus::Place, "place"}}};

}  // namespace posewise::detail
