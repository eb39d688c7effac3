#pragma once

#include <string>

#include "io/format/json_reader.hpp"

/// Paths of other files in plan files.
namespace posewise::detail {

/// A relative path as seen from the folder of the plan; null if there is none.
Json path_to_json(const std::string& path, const std::string& plan_path);

/// A stored path as one that leads there from here; empty if null.
std::string read_path(const JsonValue& value, const std::string& plan_path);

}  // namespace posewise::detail
