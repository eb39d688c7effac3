#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/names.hpp"
#include "io/format/json.hpp"
#include "posewise/task/plan.hpp"

/// What writer and readers of plan files share.
namespace posewise::detail {

inline constexpr Names<CandidateKind, 5> candidate_kinds{
    {{CandidateKind::Measurements, "measurements"},
     {CandidateKind::Configurations, "configurations"},
     {CandidateKind::Random, "random"},
     {CandidateKind::Blocks, "blocks"},
     {CandidateKind::Pool, "pool"}}};

inline constexpr std::array plan_endings{Ending::Converged, Ending::Optimal, Ending::TimeLimit,
                                         Ending::Interrupted, Ending::NotRun};

/// A joint in degrees or mm, its column's name with that unit; nothing of a column that is neither
/// in rad nor in m.
std::optional<NamedNumber> readable_joint(const std::string& column, double value);

/// What the file of a plan at that path holds.
Json plan_to_json(const Plan& plan, const std::string& path);

}  // namespace posewise::detail
