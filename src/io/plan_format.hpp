#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "json.hpp"
#include "posewise/task/plan.hpp"

/// What writer and readers of plan files share.
namespace posewise::detail {

inline constexpr const char* plan_kind = "plan";
inline constexpr const char* old_pose_plan_kind = "pose plan";  // of format 1
inline constexpr int plan_format = 2;

inline constexpr std::array<std::pair<CandidateKind, std::string_view>, 5> candidate_kinds{
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

/// A plan's file as a document of format 2, but for what those of format 1 lack. Throws InputError
/// for a newer one.
Json read_plan_document(const std::string& path);

/// A document of a pose plan of format 1 as one of format 2. What it lacks stays missing.
Json upgrade_pose_plan(const Json& old);

}  // namespace posewise::detail
