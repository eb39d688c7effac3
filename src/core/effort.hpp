#pragma once

#include <optional>

#include "core/names.hpp"
#include "posewise/core/types.hpp"

namespace posewise::detail {

/// How long a search goes on, in one word for every command.
enum class Effort { Quick, Usual, Thorough };

inline constexpr Names<Effort, 3> effort_names{
    {{Effort::Quick, "quick"}, {Effort::Usual, "usual"}, {Effort::Thorough, "thorough"}}};

/// Quick: one start, and nothing proven beyond the first bound. Thorough: 40 starts and up to 20 s
/// (of one core) of proof. Usual leaves both as they are.
inline void set_effort(Effort effort, Index& starts, std::optional<double>* proof = nullptr) {
    constexpr Index many_starts = 40;
    constexpr double long_proof = 20;
    if (effort == Effort::Usual) return;
    starts = effort == Effort::Quick ? 1 : many_starts;
    if (proof != nullptr) *proof = effort == Effort::Quick ? 0 : long_proof;
}

}  // namespace posewise::detail
