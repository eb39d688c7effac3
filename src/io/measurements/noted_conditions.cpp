#include "noted_conditions.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <string>

#include "io/format/text.hpp"
#include "measurement_columns.hpp"

namespace posewise::detail {
namespace {

constexpr double seconds_per_day = 86400;
constexpr double seconds_per_hour = 3600;

/// Digits only.
std::optional<int> whole(std::string_view text) {
    int value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || text.starts_with('-')) {
        return std::nullopt;
    }
    return value;
}

/// "12:30" or "12:30:05.2", perhaps with "Z" or "+01:00" behind.
std::optional<double> seconds_of_day(std::string_view text) {
    text = text.substr(0, text.find_first_of("Z+-"));
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) return std::nullopt;
    const std::size_t second = std::min(text.find(':', colon + 1), text.size());
    const auto hours = whole(text.substr(0, colon));
    const auto minutes = whole(text.substr(colon + 1, second - colon - 1));
    double seconds = 0;
    if (second < text.size()) {
        const ParsedNumber number = parse_number(text.substr(second + 1));
        if (!number.ok()) return std::nullopt;
        seconds = number.value;
    }
    const bool is_right =
        hours && *hours <= 24 && minutes && *minutes < 60 && seconds >= 0 && seconds < 61;
    if (!is_right) return std::nullopt;
    return seconds_per_hour * *hours + 60.0 * *minutes + seconds;
}

/// Seconds of "2026-01-31", of whatever day is the first.
std::optional<double> seconds_of_date(std::string_view text) {
    const std::size_t dash = text.find('-');
    const std::size_t second = text.find('-', std::min(dash, text.size() - 1) + 1);
    if (dash == std::string_view::npos || second == std::string_view::npos) return std::nullopt;
    const auto year = whole(text.substr(0, dash));
    const auto month = whole(text.substr(dash + 1, second - dash - 1));
    const auto day = whole(text.substr(second + 1));
    if (!year || !month || !day || *year > 9999) return std::nullopt;
    const std::chrono::year_month_day date{std::chrono::year(*year),
                                           std::chrono::month(static_cast<unsigned>(*month)),
                                           std::chrono::day(static_cast<unsigned>(*day))};
    if (!date.ok()) return std::nullopt;
    return seconds_per_day *
           static_cast<double>(std::chrono::sys_days(date).time_since_epoch().count());
}

std::optional<double> seconds_of(std::string_view text) {
    if (const ParsedNumber number = parse_number(text); number.ok()) return number.value;
    const std::size_t between = text.find_first_of(" T");
    if (between == std::string_view::npos) return seconds_of_day(text);
    const auto date = seconds_of_date(text.substr(0, between));
    const auto time = seconds_of_day(trim(text.substr(between + 1)));
    if (!date || !time) return std::nullopt;
    return *date + *time;
}

/// What the text counts from, as io::NotedTimes::clock has it.
std::string clock_of(std::string_view text) {
    if (parse_number(text).ok()) return "seconds";
    const std::size_t between = text.find_first_of(" T");
    const bool is_date = between != std::string_view::npos;
    const std::string_view time = is_date ? text.substr(between + 1) : text;
    const std::size_t zone = time.find_first_of("Z+-");
    return (is_date ? "date" : "time of day") +
           (zone == std::string_view::npos ? "" : std::string(time.substr(zone)));
}

/// Means by configuration; nothing: a cell that cannot be read.
template <typename Read>
std::optional<std::map<std::string, double>> means_of(const Notes& notes, const Read& read) {
    std::map<std::string, std::pair<double, int>> sums;
    for (const auto& [id, text] : notes) {
        if (text.empty()) continue;
        const std::optional<double> value = read(text);
        if (!value) return std::nullopt;
        auto& [sum, count] = sums[id];
        sum += *value;
        ++count;
    }
    std::map<std::string, double> means;
    for (const auto& [id, sum] : sums) means[id] = sum.first / sum.second;
    return means;
}

}  // namespace

NotedConditions mean_conditions(const Notes& times, const Notes& temperatures) {
    NotedConditions noted;
    std::optional<std::string> clock;
    std::optional<double> before;
    double midnights = 0;  // s
    const auto read_time = [&](std::string_view text) -> std::optional<double> {
        auto seconds = seconds_of(text);
        const std::string own = clock_of(text);
        if (own != clock) clock = clock ? "" : own;
        const bool is_of_day = text.find(':') != std::string_view::npos &&
                               text.find_first_of(" T") == std::string_view::npos;
        if (!seconds || !is_of_day) return seconds;
        if (before && *seconds + seconds_per_day / 2 < *before) midnights += seconds_per_day;
        before = *seconds;
        return *seconds + midnights;
    };
    if (auto means = means_of(times, read_time); means && !means->empty()) {
        const auto is_earlier = [](const auto& one, const auto& other) {
            return one.second < other.second;
        };
        const auto [earliest, latest] = std::ranges::minmax_element(*means, is_earlier);
        const double first = earliest->second;
        noted.times = {clock.value_or(""), first, latest->second};
        for (auto& [id, seconds] : *means) seconds = (seconds - first) / seconds_per_hour;
        noted.conditions.push_back({"time", "h", *means});
    }
    const auto read_degrees = [](std::string_view text) -> std::optional<double> {
        const ParsedNumber number = parse_number(text);
        return number.ok() ? std::optional(number.value) : std::nullopt;
    };
    if (auto means = means_of(temperatures, read_degrees); means && !means->empty()) {
        noted.conditions.push_back({"temperature", "C", *means});
    }
    return noted;
}

void keep_conditions(NotedConditions noted, bool has_time, bool has_temperature,
                     io::MeasurementsFile& file) {
    file.conditions = std::move(noted.conditions);
    file.times = std::move(noted.times);
    for (const auto& [column, is_there] :
         {std::pair{time_column, has_time}, std::pair{temperature_column, has_temperature}}) {
        const bool is_read = std::ranges::any_of(
            file.conditions,
            [&column = column](const Condition& one) { return column.starts_with(one.name); });
        if (is_there && !is_read) file.unused_columns.emplace_back(column);
    }
}

}  // namespace posewise::detail
