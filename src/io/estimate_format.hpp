#pragma once

#include <string>

#include "json.hpp"

/// What writer and readers of estimate files share.
namespace posewise::detail {

inline constexpr int estimate_format = 1;

/// Throws InputError for a format that this version does not know.
Json read_estimate_document(const std::string& path);

}  // namespace posewise::detail
