#include <cstdlib>
#include <numbers>

#include "length_units.hpp"
#include "reading_change.hpp"

namespace posewise::detail {
namespace {

using Kind = ReadingChange::Kind;

/// Of more joints the choices of those that are reversed are too many to try.
constexpr Index most_signed_joints = 12;
constexpr double deg_per_rad = 180 / std::numbers::pi;
constexpr double quarter_turn = std::numbers::pi / 2;

/// Every choice of reversed joints, none first.
void add_reversals(Index joints, std::vector<ReadingChanges>& all) {
    const bool are_all = joints <= most_signed_joints;
    const Index count = are_all ? Index{1} << joints : joints + 1;
    for (Index k = 0; k < count; ++k) {
        ReadingChanges reversed;
        for (Index j = 0; j < joints; ++j) {
            const bool is_reversed = are_all ? (k >> j & 1) != 0 : j + 1 == k;
            if (is_reversed) reversed.push_back({.kind = Kind::Reversed, .joint = j});
        }
        all.push_back(reversed);
    }
}

/// A joint whose value counts from the ground, or from the one behind it: +-q +- q_other.
void add_couplings(Index joint, Index other, std::vector<ReadingChanges>& all) {
    for (const double own : {1.0, -1.0}) {
        for (const double added : {-1.0, 1.0}) {
            const ReadingChange coupled{.kind = Kind::Coupled,
                                        .joint = joint,
                                        .other = other,
                                        .factor = own,
                                        .other_factor = added};
            all.push_back({coupled});
            all.push_back({coupled, {.kind = Kind::Reversed, .joint = other}});
        }
    }
}

void add_joint_changes(const Campaign& campaign, std::vector<ReadingChanges>& all) {
    const Index count = campaign.robot.joint_count();
    const auto turns = [&](Index j) { return campaign.robot.joint(j).motion == Motion::Rotation; };
    for (Index j = 0; j < count; ++j) {
        for (Index k = 0; k < count; ++k) {
            if (j < k && turns(j) == turns(k)) {
                all.push_back({{.kind = Kind::Exchanged, .joint = j, .other = k}});
            }
            if (std::abs(j - k) == 1 && turns(j) && turns(k)) add_couplings(j, k, all);
        }
    }
    for (Index j = -1; j < count; ++j) {
        const double factor = j < 0 || turns(j) ? deg_per_rad : 1e3;
        all.push_back({{.kind = Kind::JointFactor, .joint = j, .factor = factor}});
        all.push_back({{.kind = Kind::JointFactor, .joint = j, .factor = 1 / factor}});
        if (j < 0 || !turns(j)) continue;
        for (const double zero : {quarter_turn, -quarter_turn, 2 * quarter_turn}) {
            all.push_back({{.kind = Kind::Zero, .joint = j, .factor = zero}});
        }
    }
}

void add_observation_changes(const Sensor& sensor, OrientationNotation notation,
                             std::vector<ReadingChanges>& all) {
    // Nothing is read, or by several instruments, whose columns would be tried one by one.
    if (sensor.has_contacts() || sensor.is_combined()) return;
    const bool are_points = sensor.lengths_per_target() == 3;
    if (are_points) all.push_back({{.kind = Kind::LeftHanded}});
    if (sensor.has_lengths()) {
        for (const LengthUnitMistake& mistake : length_unit_mistakes()) {
            all.push_back({{.kind = Kind::LengthFactor, .factor = mistake.factor}});
        }
    }
    for (Index target = 0;
         are_points && sensor.target_count() > 1 && target < sensor.target_count(); ++target) {
        for (const double factor : {1e3, 1e-3}) {
            all.push_back({{.kind = Kind::LengthFactor, .joint = target, .factor = factor}});
        }
    }
    for (Index image = 1; sensor.has_pixels() && image < 8; ++image) {
        all.push_back({{.kind = Kind::Image, .other = image}});
    }
    if (!sensor.has_orientation()) return;
    all.push_back({{.kind = Kind::Inverted}});
    constexpr Index orders = 6;
    constexpr Index signs = 8;
    for (Index k = 1; k < orders * signs; ++k) {
        all.push_back({{.kind = Kind::Axes, .joint = k / signs, .other = k % signs}});
    }
    for (const OrientationSense& sense : orientation_senses(notation)) {
        all.push_back({{.kind = Kind::Orientation, .sense = &sense}});
    }
}

}  // namespace

std::vector<ReadingChanges> all_readings(const Campaign& campaign, OrientationNotation notation,
                                         double length_factor) {
    std::vector<ReadingChanges> all;
    add_reversals(campaign.robot.joint_count(), all);
    add_joint_changes(campaign, all);
    add_observation_changes(*campaign.sensor, notation, all);
    if (length_factor == 1) return all;
    const std::size_t count = all.size();
    for (std::size_t k = 0; k < count; ++k) {
        if (all[k].empty() || has_kind(all[k], Kind::LengthFactor)) continue;
        if (has_kind(all[k], Kind::Zero)) continue;  // base and targets take up most of them
        ReadingChanges both = all[k];
        both.push_back({.kind = Kind::LengthFactor, .factor = length_factor});
        all.push_back(both);
    }
    return all;
}

}  // namespace posewise::detail
