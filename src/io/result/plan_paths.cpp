#include "plan_paths.hpp"

#include <filesystem>

namespace posewise::detail {

Json path_to_json(const std::string& path, const std::string& plan_path) {
    if (path.empty()) return nullptr;
    if (std::filesystem::path(path).is_absolute()) return path;
    std::error_code failed;
    const auto folder = std::filesystem::absolute(plan_path, failed).parent_path();
    const auto from_folder = std::filesystem::proximate(path, folder, failed);
    return failed ? path : from_folder.generic_string();
}

std::string read_path(const JsonValue& value, const std::string& plan_path) {
    if (value.is_null()) return "";
    const std::filesystem::path path = value.text();
    const auto from_plan = std::filesystem::path(plan_path).parent_path() / path;
    std::error_code ignored;
    return std::filesystem::exists(from_plan, ignored) ? from_plan.string() : path.string();
}

}  // namespace posewise::detail
