#include "target_names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <unordered_map>

namespace posewise::detail {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_small(char c) { return c >= 'a' && c <= 'z'; }
bool is_capital(char c) { return c >= 'A' && c <= 'Z'; }

}  // namespace

std::string pose_name(std::string_view id) {
    std::string name;
    for (std::size_t k = 0; k < id.size();) {
        const std::string_view digits =
            id.substr(k, std::min(id.find_first_not_of("0123456789", k), id.size()) - k);
        if (digits.empty()) {
            const char c = id[k++];
            const bool is_plain = is_capital(c) || c == '-';
            name += is_small(c) ? static_cast<char>(c - 'a' + 'A') : is_plain ? c : '_';
            continue;
        }
        name += fmt::format("{:0>3}", digits);
        k += digits.size();
    }
    return name.empty() || !is_capital(name.front()) ? 'P' + name : name;
}

std::string target_name(std::string_view id, Index target) {
    return fmt::format("{}_T{}", pose_name(id), target + 1);
}

std::optional<SameName> find_same_name(const std::vector<std::string>& ids, Index target_count) {
    std::unordered_map<std::string, std::size_t> taken;
    for (std::size_t k = 0; k < ids.size(); ++k) {
        for (Index target = 0; target < target_count; ++target) {
            const std::string name = target_name(ids[k], target);
            const auto [found, is_new] = taken.emplace(name_key(name), k);
            if (!is_new) return SameName{ids[found->second], ids[k], name};
        }
    }
    return std::nullopt;
}

std::string name_key(std::string_view name) {
    const std::size_t colons = name.rfind("::");
    if (colons != std::string_view::npos) name.remove_prefix(colons + 2);
    std::string key;
    bool is_parted = false;  // by what stands between two characters
    for (std::size_t k = 0; k < name.size(); ++k) {
        const char c = name[k];
        if (std::string_view("_-. *").find(c) != std::string_view::npos) {
            is_parted = true;
            continue;
        }
        const bool is_inside = !key.empty() && is_digit(key.back()) && is_digit(c);
        const bool is_leading_zero =
            c == '0' && (!is_inside || is_parted) && k + 1 < name.size() && is_digit(name[k + 1]);
        if (is_leading_zero) continue;
        if (is_inside && is_parted) key += '_';
        key += is_capital(c) ? static_cast<char>(c - 'A' + 'a') : c;
        is_parted = false;
    }
    return key;
}

}  // namespace posewise::detail
