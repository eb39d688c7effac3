#pragma once

#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "posewise/core/random.hpp"

/// JSON files whose values went wrong on the way.
namespace posewise::testing {

/// Mutants a run: POSEWISE_MUTANTS, or 600.
inline int mutant_count() {
    const char* const asked = std::getenv("POSEWISE_MUTANTS");
    return asked != nullptr ? std::atoi(asked) : 600;
}

/// A place in a tree, drawn level by level.
inline nlohmann::ordered_json& draw_leaf(nlohmann::ordered_json& root, RandomStream& random) {
    nlohmann::ordered_json* at = &root;
    while (at->is_structured() && !at->empty()) {
        at = &*std::next(at->begin(), random.index(static_cast<Index>(at->size())));
    }
    return *at;
}

/// Another number, of those that go wrong: sign, units, nothing, far too large.
inline double other_number(double number, RandomStream& random) {
    constexpr std::array<double, 8> factors{-1, 1e3, 1e-3, 57.29577951308232, 1e9, 0, 2, 1e-9};
    const auto k = random.index(static_cast<Index>(factors.size()) + 2);
    if (k == 0) return number + 1;
    if (k == 1) return 1e3 * random.normal();
    return factors[static_cast<std::size_t>(k - 2)] * number;
}

/// Another value of the same kind; a text becomes empty, longer or one of `words`. Rarely nothing.
inline void mutate(nlohmann::ordered_json& leaf, const std::vector<std::string>& words,
                   RandomStream& random) {
    if (random.index(20) == 0) {
        leaf = nullptr;
    } else if (leaf.is_number_integer()) {
        leaf = random.index(1000) - 100;
    } else if (leaf.is_number()) {
        leaf = other_number(leaf.get<double>(), random);
    } else if (leaf.is_string()) {
        const auto k = static_cast<std::size_t>(random.index(std::ssize(words) + 2));
        leaf = k < words.size() ? words[k] : k == words.size() ? "" : leaf.get<std::string>() + "x";
    } else if (leaf.is_boolean()) {
        leaf = !leaf.get<bool>();
    }
}

}  // namespace posewise::testing
