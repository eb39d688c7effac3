#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace posewise::detail {

/// The enumerators of an enumeration and their words, in the order they are listed in.
template <typename Enum, std::size_t count>
using Names = std::array<std::pair<Enum, std::string_view>, count>;

/// The word of an enumerator; that of the first one for a value that is none.
template <typename Enum, std::size_t count>
constexpr std::string_view name_of(const Names<Enum, count>& names, Enum value) {
    for (const auto& [one, name] : names) {
        if (one == value) return name;
    }
    return names[0].second;
}

/// The enumerator of a word.
template <typename Enum, std::size_t count>
constexpr std::optional<Enum> find_named(const Names<Enum, count>& names, std::string_view word) {
    for (const auto& [one, name] : names) {
        if (name == word) return one;
    }
    return std::nullopt;
}

template <typename Enum, std::size_t count>
std::vector<std::string> words_of(const Names<Enum, count>& names) {
    std::vector<std::string> words;
    for (const auto& [unused, name] : names) words.emplace_back(name);
    return words;
}

}  // namespace posewise::detail
