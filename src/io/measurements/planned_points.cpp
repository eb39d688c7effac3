#include "planned_points.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/text.hpp"
#include "noted_conditions.hpp"
#include "points_list.hpp"
#include "posewise/task/plan.hpp"
#include "sample_collector.hpp"
#include "target_names.hpp"

namespace posewise::detail {
namespace {

/// The first few, by commas.
std::string some_of(const std::vector<std::string>& names) {
    constexpr std::size_t most = 5;
    const std::size_t shown = std::min(most, names.size());
    return fmt::format("{}{}",
                       fmt::join(names.begin(), names.begin() + static_cast<long>(shown), ", "),
                       shown < names.size() ? ", ..." : "");
}

class Join {
  public:
    Join(const std::string& path, const Campaign& campaign, const io::PointsSource& source,
         PointsList list)
        : path_(path), campaign_(campaign), list_(std::move(list)) {
        const Plan& plan = *source.plan;
        for (const PlannedPose& pose : plan.poses) poses_.push_back(&pose);
        to_calibrate_ = poses_.size();
        for (const PlannedPose& pose : plan.verification) poses_.push_back(&pose);
        targets_ = static_cast<std::size_t>(campaign.sensor->target_count());
        measured_.resize(poses_.size() * targets_, nullptr);
        name_points(source.plan_path);
    }

    io::MeasurementsFile join() {
        const bool is_by_name = std::ranges::any_of(
            list_.points, [&](const NamedPoint& point) { return find(point.name) != nothing; });
        if (is_by_name) {
            for (const NamedPoint& point : list_.points) put(point);
        } else {
            put_in_order();
        }
        check_unit();
        io::MeasurementsFile file{collect(), std::move(list_.unused), true, describe(is_by_name)};
        note_conditions(file);
        return file;
    }

  private:
    static constexpr std::size_t nothing = static_cast<std::size_t>(-1);

    const std::string& id(std::size_t place) const { return poses_[place / targets_]->id; }
    std::string name(std::size_t place) const {
        return target_name(id(place), static_cast<Index>(place % targets_));
    }

    void name_points(const std::string& plan_path) {
        std::vector<std::string> ids;
        for (const PlannedPose* const pose : poses_) ids.push_back(pose->id);
        if (const auto same = find_same_name(ids, static_cast<Index>(targets_))) {
            throw input_error_at(
                {plan_path},
                fmt::format("its poses {} and {} have the same name for an instrument, {}; must "
                            "differ",
                            quote(same->first), quote(same->second), same->name));
        }
        for (std::size_t place = 0; place < measured_.size(); ++place) {
            place_of_.emplace(name_key(name(place)), place);
        }
        for (std::size_t place = 0; place < measured_.size(); ++place) {
            place_of_.emplace(name_key(fmt::format("{}_T{}", id(place), place % targets_ + 1)),
                              place);
            if (targets_ > 1) continue;
            place_of_.emplace(name_key(pose_name(id(place))), place);
            place_of_.emplace(name_key(id(place)), place);
        }
    }

    std::size_t find(const std::string& name) const {
        const auto found = place_of_.find(name_key(name));
        return found == place_of_.end() ? nothing : found->second;
    }

    void put(const NamedPoint& point) {
        const std::size_t place = find(point.name);
        if (place == nothing) {
            throw input_error_at(point.place,
                                 fmt::format("{} is no point of the plan; must be one, such as {}, "
                                             "or be left out",
                                             quote(point.name), name(0)));
        }
        if (measured_[place] != nullptr) {
            throw input_error_at(
                point.place,
                fmt::format("{} is point {} once more, which line {} has; keep one (repeats need a "
                            "table with the columns config and sample)",
                            quote(point.name), name(place), measured_[place]->place.line));
        }
        measured_[place] = &point;
    }

    bool is_planned(std::size_t place) const {
        const std::vector<Index>& targets = poses_[place / targets_]->targets;
        return targets.empty() ||
               std::ranges::find(targets, static_cast<Index>(place % targets_)) != targets.end();
    }

    void put_in_order() {
        std::vector<std::size_t> places;
        std::size_t to_calibrate = 0;
        for (std::size_t place = 0; place < measured_.size(); ++place) {
            if (!is_planned(place)) continue;
            places.push_back(place);
            if (place < to_calibrate_ * targets_) ++to_calibrate;
        }
        const std::size_t count = list_.points.size();
        if (count != places.size() && count != to_calibrate) {
            const std::string& first = list_.points.front().name;
            throw input_error_at(
                list_.points.front().place,
                fmt::format("no name{} is one of the plan's, such as {}, and in order {} cannot be "
                            "the plan's {}; name them as the plan does, or leave none out",
                            first.empty() ? "" : " (the first is " + quote(first) + ")", name(0),
                            count_of(static_cast<Index>(count), "point"), places.size()));
        }
        for (std::size_t k = 0; k < count; ++k) measured_[places[k]] = &list_.points[k];
    }

    /// Throws InputError if no unit is stated, or if the points are as far apart as planned in
    /// another one.
    void check_unit() const {
        const double ratio = spread_ratio();
        // Within a fifth, since neither the robot's errors nor targets that are not stated matter
        // then. Numbers without a unit are as they stand in the file, others in m.
        const double scale = list_.unit == nullptr ? 1 : list_.unit->to_si(1);
        std::string fitting;
        for (const std::string& name : point_unit_names()) {
            if (std::abs(find_point_unit(name)->to_si(ratio / scale) - 1) < 0.2) fitting = name;
        }
        if (list_.unit == nullptr) {
            throw input_error_at(
                {path_},
                "does not state the unit of its points; state `points_unit`, or x_mm, "
                "y_mm, z_mm in a header" +
                    (fitting.empty() ? ""
                                     : "; they are as far apart as planned if it is " + fitting));
        }
        if (fitting.empty() || fitting == list_.unit->name) return;
        throw input_error_at(
            {path_},
            fmt::format("its points are in {} as is stated, but as far apart as planned if they "
                        "are in {}; `points_unit` or the header must state the right unit",
                        list_.unit->name, fitting));
    }

    /// The spread of the points against that of the plan's.
    double spread_ratio() const {
        std::vector<Vector3d> measured;
        std::vector<Vector3d> planned;
        for (std::size_t place = 0; place < measured_.size(); ++place) {
            if (measured_[place] == nullptr) continue;
            measured.push_back(measured_[place]->position);
            planned.push_back(world_from_flange(campaign_, campaign_.nominal,
                                                poses_[place / targets_]->configuration) *
                              campaign_.sensor->target_position(
                                  static_cast<Index>(place % targets_), campaign_.nominal.sensor));
        }
        const auto spread = [](const std::vector<Vector3d>& points) {
            Vector3d mean = Vector3d::Zero();
            for (const Vector3d& point : points) mean += point / static_cast<double>(points.size());
            double sum = 0;
            for (const Vector3d& point : points) sum += (point - mean).squaredNorm();
            return std::sqrt(sum);
        };
        return spread(measured) / spread(planned);
    }

    Measurements collect() const {
        SampleCollector samples(campaign_);
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            Sample sample{poses_[i]->id, "", poses_[i]->configuration,
                          VectorXd::Zero(campaign_.sensor->row_count()),
                          SeenTargets::Constant(static_cast<Index>(targets_), false)};
            const NamedPoint* first = nullptr;
            for (std::size_t target = 0; target < targets_; ++target) {
                const NamedPoint* const point = measured_[i * targets_ + target];
                if (point == nullptr) continue;
                if (first == nullptr) first = point;
                const auto k = static_cast<Index>(target);
                sample.observation.segment<3>(3 * k) = point->position;
                sample.is_seen[k] = true;
            }
            if (first == nullptr) continue;
            samples.add(sample, [&](Index) { return first->place; });
        }
        return samples.finish(path_);
    }

    /// In the order of the list, as they were measured.
    void note_conditions(io::MeasurementsFile& file) const {
        std::unordered_map<const NamedPoint*, const std::string*> id_of;
        for (std::size_t place = 0; place < measured_.size(); ++place) {
            if (measured_[place] != nullptr) id_of.emplace(measured_[place], &id(place));
        }
        Notes times, temperatures;
        for (const NamedPoint& point : list_.points) {
            const auto found = id_of.find(&point);
            if (found == id_of.end()) continue;
            times.emplace_back(*found->second, point.time);
            temperatures.emplace_back(*found->second, point.temperature);
        }
        keep_conditions(mean_conditions(times, temperatures), list_.has_time, list_.has_temperature,
                        file);
    }

    /// "18 of 20 poses, without p4, p9, 3 points missing: P001_T2, ..."; empty if all are there.
    std::string describe(bool is_by_name) const {
        std::vector<std::string> poses;
        std::vector<std::string> points;
        for (std::size_t i = 0; i < poses_.size(); ++i) {
            std::vector<std::string> missing;
            bool is_measured = false;
            for (std::size_t place = i * targets_; place < (i + 1) * targets_; ++place) {
                is_measured = is_measured || measured_[place] != nullptr;
                if (is_planned(place) && measured_[place] == nullptr)
                    missing.push_back(name(place));
            }
            if (is_measured) {
                points.insert(points.end(), missing.begin(), missing.end());
            } else {
                poses.push_back(quote(poses_[i]->id));
            }
        }
        if (is_by_name && poses.empty() && points.empty()) return "";
        const auto count = static_cast<Index>(poses_.size());
        std::string text =
            is_by_name ? "" : "no name is one of the plan's, so they are taken in its order: ";
        text += fmt::format("{} of {}", count - std::ssize(poses), count_of(count, "pose"));
        if (!poses.empty()) text += ", without " + some_of(poses);
        if (!points.empty()) {
            text += fmt::format(", {} missing: {}", count_of(std::ssize(points), "point"),
                                some_of(points));
        }
        return text;
    }

    const std::string& path_;
    const Campaign& campaign_;
    PointsList list_;
    std::vector<const PlannedPose*> poses_;  // to calibrate with, then to verify
    std::size_t to_calibrate_ = 0;           // how many of them
    std::size_t targets_ = 0;
    std::unordered_map<std::string, std::size_t> place_of_;  // of a name's key
    std::vector<const NamedPoint*> measured_;  // poses x targets; nullptr: not measured
};

}  // namespace

io::MeasurementsFile read_planned_points(const std::string& path, std::string content,
                                         const Campaign& campaign, const io::PointsSource& source) {
    const auto error = [&](const std::string& problem) { return input_error_at({path}, problem); };
    if (!campaign.sensor->observes_targets() || !campaign.robot.torques().empty()) {
        throw error(
            "is a list of points, which is read where the sensor measures points and no "
            "torques are measured; must be a table with the column config");
    }
    if (source.plan == nullptr) {
        throw error(
            "is a list of points without joint values; must come with the plan whose poses were "
            "measured (`plan` of calibrate, indices, inspect, select and study, `augment_plan` of "
            "plan), or be a table with the column config");
    }
    const Unit* const unit = source.unit.empty() ? nullptr : find_point_unit(source.unit);
    if (unit == nullptr && !source.unit.empty()) {
        throw error(fmt::format("`points_unit` is {}; must be {}", quote(source.unit),
                                list_words(point_unit_names())));
    }
    PointsList list = read_points_list(path, std::move(content), unit);
    if (list.unit == nullptr) list.unit = unit;
    const std::string mismatch = describe_mismatch(*source.plan, campaign);
    if (!mismatch.empty()) throw input_error_at({source.plan_path}, mismatch);
    return Join(path, campaign, source, std::move(list)).join();
}

}  // namespace posewise::detail
