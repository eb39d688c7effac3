#include "sample_collector.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "core/text.hpp"

namespace posewise::detail {
namespace {

constexpr double joint_tolerance = 1e-6;  // rad or m, within one configuration

/// " (line 3)", or nothing for a file without lines.
std::string in_line(const FileLocation& location) {
    return location.line > 0 ? fmt::format(" (line {})", location.line) : "";
}

}  // namespace

void SampleCollector::add(const Sample& sample, const LocateJoint& locate, bool is_apart) {
    check_torques(sample.joints, locate);
    const auto next = static_cast<Index>(ids_.size());
    const Index i = is_apart ? next : configuration_of_id_.emplace(sample.id, next).first->second;
    if (i == next) {
        ids_.push_back(sample.id);
        configurations_.push_back(sample.joints);
        first_places_.push_back(locate(0));
        first_seen_.push_back(sample.is_seen);
    } else {
        check_same_joints(i, sample.joints, locate);
        check_same_contact(i, sample.is_seen, locate(0));
        const Index torques = sample.joints.size() - campaign_.robot.joint_count();
        configurations_[static_cast<std::size_t>(i)].tail(torques) += sample.joints.tail(torques);
    }
    configuration_.push_back(i);
    names_.push_back(sample.name);
    observations_.insert(observations_.end(), sample.observation.begin(), sample.observation.end());
    is_seen_.push_back(sample.is_seen);
}

void SampleCollector::check_same_joints(Index configuration, const VectorXd& joints,
                                        const LocateJoint& locate) const {
    const auto i = static_cast<std::size_t>(configuration);
    for (Index j = 0; j < campaign_.robot.joint_count(); ++j) {
        const double first = configurations_[i][j];
        if (std::abs(joints[j] - first) <= joint_tolerance) continue;
        throw input_error_at(
            locate(j),
            fmt::format("configuration {} has {} = {:g} here and {:g} before{}; samples of one "
                        "configuration must agree within 1e-6 (rad or m)",
                        quote(ids_[i]), campaign_.robot.joints()[static_cast<std::size_t>(j)].name,
                        joints[j], first, in_line(first_places_[i])));
    }
}

void SampleCollector::check_same_contact(Index configuration, const SeenTargets& is_seen,
                                         const FileLocation& location) const {
    const auto i = static_cast<std::size_t>(configuration);
    const std::vector<std::string> contacts = campaign_.sensor->contact_names();
    if (contacts.empty() || (is_seen == first_seen_[i]).all()) return;
    const auto name = [&](const SeenTargets& seen) {
        return contacts[static_cast<std::size_t>(targets_seen(seen).front())];
    };
    throw input_error_at(
        location, fmt::format("configuration {} touches {} here and {} before{}; must be one of "
                              "them, the ball is in one place",
                              quote(ids_[i]), name(is_seen), name(first_seen_[i]),
                              in_line(first_places_[i])));
}

void SampleCollector::check_torques(const VectorXd& configuration,
                                    const LocateJoint& locate) const {
    const Chain& robot = campaign_.robot;
    Index k = robot.joint_count();
    for (const MeasuredTorque& torque : robot.torques()) {
        const double value = configuration[k++];
        if (std::abs(value) <= 2 * torque.largest) continue;
        throw input_error_at(
            locate(k - 1),
            fmt::format("the torque of {} is {:g} N m, over twice the largest that the campaign "
                        "states, {:g}; correct compliance.torques_Nm or the unit here",
                        robot.joints()[static_cast<std::size_t>(torque.joint)].name, value,
                        torque.largest));
    }
}

void SampleCollector::check_not_copied(const Measurements& measurements) const {
    if (measurements.observations.cols() == 0 || campaign_.sensor->has_contacts()) return;
    std::map<std::vector<double>, Index> first_of;
    Index copies = 0;
    Index first = 0;
    Index copy = 0;
    for (Index i = 0; i < measurements.configuration_count(); ++i) {
        std::vector<double> numbers;
        const auto add = [&](const auto& row) {
            numbers.insert(numbers.end(), row.begin(), row.end());
        };
        add(measurements.configurations.row(i));
        const Index begin = measurements.first_sample[static_cast<std::size_t>(i)];
        for (Index k = begin; k < begin + measurements.sample_count(i); ++k) {
            add(measurements.observations.row(k));
        }
        const auto [found, is_new] = first_of.emplace(std::move(numbers), i);
        if (is_new || ++copies > 1) continue;
        first = found->second;
        copy = i;
    }
    if (copies == 0 || 2 * copies < measurements.configuration_count()) return;
    const auto f = static_cast<std::size_t>(first);
    const auto c = static_cast<std::size_t>(copy);
    throw input_error_at(
        first_places_[c],
        fmt::format("configuration {} has the same joint values and readings as {}{}, and {} of {} "
                    "are such copies; every reading must be in the file once",
                    quote(ids_[c]), quote(ids_[f]), in_line(first_places_[f]), copies,
                    measurements.configuration_count()));
}

Measurements SampleCollector::finish(const std::string& path) const {
    if (ids_.empty()) {
        throw input_error_at({path}, "has a header but no rows; must have at least one row");
    }
    Measurements measurements;
    measurements.ids = ids_;
    const Chain& robot = campaign_.robot;
    measurements.configurations.resize(static_cast<Index>(ids_.size()), robot.configuration_size());
    std::vector<Index>& first = measurements.first_sample;
    first.assign(ids_.size() + 1, 0);
    for (const Index i : configuration_) ++first[static_cast<std::size_t>(i) + 1];
    for (std::size_t i = 0; i < ids_.size(); ++i) {
        auto row = measurements.configurations.row(static_cast<Index>(i));
        row = configurations_[i].transpose();
        row.tail(row.size() - robot.joint_count()) /= static_cast<double>(first[i + 1]);
    }
    std::partial_sum(first.begin(), first.end(), first.begin());

    const auto samples = static_cast<Index>(configuration_.size());
    const auto width = static_cast<Index>(observations_.size()) / samples;
    const Eigen::Map<const RowMatrixXd> observations(observations_.data(), samples, width);
    measurements.observations.resize(samples, width);
    measurements.is_seen.resize(samples, is_seen_.front().size());
    const bool has_names = std::ranges::none_of(names_, &std::string::empty);
    if (has_names) measurements.sample_names.resize(names_.size());
    std::vector<Index> next = first;
    for (Index sample = 0; sample < samples; ++sample) {
        const Index i = configuration_[static_cast<std::size_t>(sample)];
        const Index row = next[static_cast<std::size_t>(i)]++;
        measurements.observations.row(row) = observations.row(sample);
        measurements.is_seen.row(row) = is_seen_[static_cast<std::size_t>(sample)];
        if (!has_names) continue;
        measurements.sample_names[static_cast<std::size_t>(row)] =
            names_[static_cast<std::size_t>(sample)];
    }
    check_not_copied(measurements);
    return measurements;
}

void check_not_degrees(const Chain& robot, Index joint, double value,
                       const std::function<FileLocation()>& locate) {
    const Joint& limits = robot.joints()[static_cast<std::size_t>(joint)];
    // A campaign's limits may be narrower than the robot's: what is a little beyond them is taken.
    constexpr double impossible = 4 * 2 * std::numbers::pi;
    if (robot.joint(joint).motion != Motion::Rotation ||
        (value >= limits.lower - impossible && value <= limits.upper + impossible)) {
        return;
    }
    throw input_error_at(
        locate(), fmt::format("{} = {:g} rad is more than four turns beyond its limits ({:g} to "
                              "{:g} rad) and looks like degrees; state degrees as such",
                              limits.name, value, limits.lower, limits.upper));
}

}  // namespace posewise::detail
