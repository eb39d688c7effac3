#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "io/format/text.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"

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

/// "0.01..0.05"; nothing if it is something else.
std::optional<std::pair<double, double>> parse_range(const std::string& text) {
    const auto dots = text.find("..");
    if (dots == std::string::npos) return std::nullopt;
    const char* const begin = text.data();
    const char* const end = begin + text.size();
    std::pair<double, double> range;
    const auto lower = std::from_chars(begin, begin + dots, range.first);
    const auto upper = std::from_chars(begin + dots + 2, end, range.second);
    if (lower.ec != std::errc() || lower.ptr != begin + dots || upper.ec != std::errc() ||
        upper.ptr != end) {
        return std::nullopt;
    }
    if (!(range.first < range.second) || !std::isfinite(range.second - range.first)) {
        throw InputError("the range " + detail::quote(text) +
                         " is empty; must be from a lower to an upper number");
    }
    return range;
}

/// A value in a range, as far along it as `part` says.
double value_at(const std::pair<double, double>& range, double part) {
    constexpr double wide = 10;
    const auto& [lower, upper] = range;
    if (lower > 0 && upper >= wide * lower) return lower * std::pow(upper / lower, part);
    return lower + part * (upper - lower);
}

/// The positive root of x^(d+1) = x + 1.
double recurrence_root(std::size_t d) {
    double x = 2;
    for (int k = 0; k < 100; ++k) x = std::pow(1 + x, 1 / (static_cast<double>(d) + 1));
    return x;
}

/// For each point a value for each of these keys, which are ranges.
std::vector<std::vector<VariedKey>> fill_ranges(const std::vector<VariedKey>& ranges,
                                                Index point_count) {
    const double root = recurrence_root(ranges.size());
    std::vector<std::vector<VariedKey>> points;
    for (Index i = 0; i < point_count; ++i) {
        std::vector<VariedKey>& point = points.emplace_back();
        double step = 1;
        for (const VariedKey& varied : ranges) {
            step /= root;
            const double along = 0.5 + static_cast<double>(i) * step;
            const double value = value_at(*varied.range, along - std::floor(along));
            point.push_back({varied.key, {fmt::format("{:.4g}", value)}});
        }
    }
    return points;
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
        if (varied.values.size() == 1) varied.range = parse_range(varied.values.front());
        if (varied.range) varied.values.clear();
    }
    const auto parts = split_outside_brackets(varied.key, '.');
    const auto is_empty = [](const std::string& part) { return part.empty(); };
    if (equals == std::string::npos || std::any_of(parts.begin(), parts.end(), is_empty) ||
        std::any_of(varied.values.begin(), varied.values.end(), is_empty)) {
        throw InputError(detail::quote(text) +
                         " is not a key and its values; must be like sensor.sigma_mm=0.01,0.05 or "
                         "sensor.sigma_mm=0.01..0.05");
    }
    return varied;
}

namespace {

/// Every combination of the values.
std::vector<Variation> combine(const std::string& content, const std::string& path,
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

}  // namespace

std::vector<Variation> vary_campaign(const std::string& content, const std::string& path,
                                     const std::vector<VariedKey>& keys, Index point_count) {
    std::vector<VariedKey> ranges;
    std::vector<VariedKey> listed;
    for (const VariedKey& varied : keys) {
        if (std::ranges::count(keys, varied.key, &VariedKey::key) > 1) {
            throw InputError(detail::quote(varied.key) +
                             " is varied twice; must be once, with all values");
        }
        (varied.range ? ranges : listed).push_back(varied);
    }
    if (ranges.empty() != (point_count == 0)) {
        throw InputError(
            ranges.empty()
                ? "no range is varied, which points (--points) could fill; must be like "
                  "sensor.sigma_mm=0.01..0.05"
                : detail::quote(ranges.front().key) +
                      " is varied over a range: how many points fill it must be said (--points)");
    }
    if (ranges.empty()) return combine(content, path, listed);
    std::vector<Variation> variations;
    for (std::vector<VariedKey>& point : fill_ranges(ranges, point_count)) {
        point.insert(point.end(), listed.begin(), listed.end());
        for (Variation& one : combine(content, path, point)) {
            variations.push_back(std::move(one));
        }
    }
    return variations;
}

}  // namespace posewise::io
