#include "posewise/io/campaign_variation.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>

#include "posewise/core/errors.hpp"
#include "text.hpp"

namespace posewise::io {
namespace {

/// Parts between separators that stand in no bracket, brace or quotes.
std::vector<std::string> split_outside_brackets(const std::string& text, char separator) {
    std::vector<std::string> parts{""};
    int depth = 0;
    char quoted_by = 0;
    for (const char c : text) {
        if (quoted_by != 0) {
            if (c == quoted_by) quoted_by = 0;
        } else if (c == '"' || c == '\'') {
            quoted_by = c;
        } else if (c == '[' || c == '{') {
            ++depth;
        } else if (c == ']' || c == '}') {
            --depth;
        } else if (c == separator && depth == 0) {
            parts.emplace_back();
            continue;
        }
        parts.back() += c;
    }
    return parts;
}

InputError no_place(const VariedKey& varied, const std::string& part) {
    return InputError(
        fmt::format("{} cannot be varied: nothing stands under {}, must name a key of "
                    "a map or the number of an item of a list",
                    detail::quote(varied.key), detail::quote(part)));
}

/// The item of a list that a part of a key names, from 0.
std::size_t item_of(const VariedKey& varied, const std::string& part, std::size_t size) {
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), number);
    if (error != std::errc() || end != part.data() + part.size() || number < 1 || number > size) {
        throw no_place(varied, part);
    }
    return number - 1;
}

/// The tree with another value of a key; shares nothing with the tree given.
YAML::Node with_value(const YAML::Node& tree, const VariedKey& varied, const YAML::Node& value,
                      const std::vector<std::string>& parts, std::size_t depth = 0) {
    if (depth == parts.size()) return value;
    const std::string& part = parts[depth];
    YAML::Node changed;
    if (tree.IsSequence()) {
        const std::size_t item = item_of(varied, part, tree.size());
        for (std::size_t i = 0; i < tree.size(); ++i) {
            changed.push_back(i == item ? with_value(tree[i], varied, value, parts, depth + 1)
                                        : tree[i]);
        }
        return changed;
    }
    if (tree.IsScalar()) throw no_place(varied, part);
    bool is_there = false;
    for (const auto& entry : tree) {
        const bool is_it = entry.first.IsScalar() && entry.first.Scalar() == part;
        is_there = is_there || is_it;
        changed[entry.first] =
            is_it ? with_value(entry.second, varied, value, parts, depth + 1) : entry.second;
    }
    if (!is_there) {
        changed[part] =
            with_value(YAML::Node(YAML::NodeType::Map), varied, value, parts, depth + 1);
    }
    return changed;
}

YAML::Node load(const std::string& text, const std::string& what) {
    try {
        return YAML::Load(text);
    } catch (const YAML::Exception& error) {
        throw InputError(fmt::format("{} is not YAML: {}", what, error.msg));
    }
}

}  // namespace

VariedKey parse_varied_key(const std::string& text) {
    const auto equals = text.find('=');
    VariedKey varied;
    if (equals != std::string::npos) {
        varied.key = text.substr(0, equals);
        varied.values = split_outside_brackets(text.substr(equals + 1), ',');
    }
    const auto parts = split_outside_brackets(varied.key, '.');
    const auto is_empty = [](const std::string& part) { return part.empty(); };
    if (equals == std::string::npos || std::any_of(parts.begin(), parts.end(), is_empty) ||
        std::any_of(varied.values.begin(), varied.values.end(), is_empty)) {
        throw InputError(detail::quote(text) +
                         " is not a key and its values; must be like sensor.sigma_mm=0.01,0.05");
    }
    return varied;
}

std::vector<Variation> vary_campaign(const std::string& content, const std::string& path,
                                     const std::vector<VariedKey>& keys) {
    std::vector<Variation> variations{{"", content}};
    for (const VariedKey& varied : keys) {
        std::vector<Variation> more;
        for (const Variation& variation : variations) {
            const YAML::Node tree = load(variation.content, path);
            for (const std::string& value : varied.values) {
                YAML::Emitter text;
                text << with_value(tree, varied, load(value, detail::quote(value)),
                                   split_outside_brackets(varied.key, '.'));
                more.push_back({fmt::format("{}{}{}={}", variation.name,
                                            variation.name.empty() ? "" : " ", varied.key, value),
                                text.c_str()});
            }
        }
        variations = std::move(more);
    }
    return variations;
}

}  // namespace posewise::io
