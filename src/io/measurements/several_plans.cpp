#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "posewise/core/errors.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/task/plan.hpp"

namespace posewise::io {
namespace {

/// "old/p1" for p1 of old.json, see join_plans().
std::string id_among(const std::vector<std::string>& paths, const std::string& own,
                     const std::string& id) {
    const auto stem = [](const std::string& path) {
        return std::filesystem::path(path).stem().string();
    };
    const bool is_clear = std::ranges::count(paths, stem(own), stem) == 1;
    return (is_clear ? stem(own) : own) + '/' + id;
}

const Condition* find_condition(const MeasurementsFile& part, std::string_view name) {
    const auto found = std::ranges::find(part.conditions, name, &Condition::name);
    return found == part.conditions.end() ? nullptr : &*found;
}

bool is_one_clock(const std::vector<MeasurementsFile>& parts) {
    const std::string& clock = parts.front().times->clock;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        const NotedTimes& own = *parts[k].times;
        if (clock.empty() || own.clock != clock) return false;
        if (k == 0 || clock.starts_with("date")) continue;
        if (own.first <= parts[k - 1].times->last) return false;
    }
    return true;
}

/// The condition of all parts, if each has it; times since the first of all.
void join_condition(const std::vector<MeasurementsFile>& parts, const std::string& name,
                    MeasurementsFile& all, std::vector<std::string>& left_out) {
    const auto has = [&](const MeasurementsFile& part) { return find_condition(part, name); };
    if (std::ranges::none_of(parts, has)) return;
    if (!std::ranges::all_of(parts, has)) {
        left_out.push_back(name + " is not in all of them");
        return;
    }
    const bool is_time = name == "time";
    if (is_time && !is_one_clock(parts)) {
        left_out.push_back(name +
                           " is not shown to be of one clock (no dates, and a later file "
                           "does not begin after the one before ended)");
        return;
    }
    constexpr double seconds_per_hour = 3600;
    double first = 0;
    if (is_time) {
        first = std::ranges::min(parts, {}, [](const MeasurementsFile& part) {
                    return part.times->first;
                }).times->first;
    }
    Condition joined{name, find_condition(parts.front(), name)->unit, {}};
    for (const MeasurementsFile& part : parts) {
        const double shift = is_time ? (part.times->first - first) / seconds_per_hour : 0;
        for (const auto& [id, value] : find_condition(part, name)->values) {
            joined.values[id] = value + shift;
        }
    }
    all.conditions.push_back(std::move(joined));
}

void rename(MeasurementsFile& part, const std::vector<std::string>& paths, const std::string& own) {
    for (std::string& id : part.ids) id = id_among(paths, own, id);
    for (Condition& condition : part.conditions) {
        std::map<std::string, double> values;
        for (const auto& [id, value] : condition.values) values[id_among(paths, own, id)] = value;
        condition.values = std::move(values);
    }
}

}  // namespace

Plan join_plans(std::vector<Plan> plans, const std::vector<std::string>& paths,
                const Campaign& campaign) {
    for (std::size_t k = 0; k < plans.size(); ++k) {
        const std::string mismatch = describe_mismatch(plans[k], campaign);
        if (!mismatch.empty()) throw input_error_at({paths[k]}, mismatch);
        for (auto* const poses : {&plans[k].poses, &plans[k].verification}) {
            for (PlannedPose& pose : *poses) pose.id = id_among(paths, paths[k], pose.id);
        }
    }
    Plan all = std::move(plans.front());
    for (std::size_t k = 1; k < plans.size(); ++k) {
        all.request.pose_count += plans[k].request.pose_count;
        std::ranges::move(plans[k].poses, std::back_inserter(all.poses));
        std::ranges::move(plans[k].verification, std::back_inserter(all.verification));
    }
    return all;
}

MeasurementsFile join_measurements(std::vector<MeasurementsFile> parts,
                                   const std::vector<std::string>& paths,
                                   const std::vector<std::string>& plan_paths) {
    MeasurementsFile all;
    std::vector<Measurements> measured;
    for (std::size_t k = 0; k < parts.size(); ++k) {
        rename(parts[k], plan_paths, plan_paths[k]);
        for (std::size_t earlier = 0; earlier < k; ++earlier) {
            if (parts[earlier].observations.rows() != parts[k].observations.rows() ||
                parts[earlier].observations != parts[k].observations) {
                continue;
            }
            throw input_error_at(
                {paths[k]},
                fmt::format("has the same readings as {}; must be others", paths[earlier]));
        }
        all.is_joined |= parts[k].is_joined;
        measured.push_back(parts[k]);
    }
    static_cast<Measurements&>(all) = put_together(measured);
    std::vector<std::string> left_out;
    for (const char* const name : {"time", "temperature"}) {
        join_condition(parts, name, all, left_out);
    }
    if (!left_out.empty()) {
        all.joined =
            fmt::format("{}, and not looked for in the residuals", fmt::join(left_out, "; "));
    }
    return all;
}

}  // namespace posewise::io
