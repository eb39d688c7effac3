#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "posewise/io/plan_file.hpp"

/// Words of plan files, for writer and reader.
namespace posewise::io {

inline constexpr std::array<std::pair<CandidateSource::Kind, std::string_view>, 4> source_kinds{
    {{CandidateSource::Kind::Measurements, "measurements"},
     {CandidateSource::Kind::Configurations, "configurations"},
     {CandidateSource::Kind::Random, "random"},
     {CandidateSource::Kind::Blocks, "blocks"}}};

inline constexpr std::array stop_reasons{Ending::Converged, Ending::Optimal,
                                         Ending::TimeLimit, Ending::Interrupted,
                                         Ending::NotRun};

}  // namespace posewise::io
