#include "joint_signs.hpp"

#include <algorithm>
#include <limits>
#include <string>

#include "../core/parallel.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

/// So many patterns, the best of the quick registration, are registered properly.
constexpr std::size_t polished_count = 64;

/// Means of evenly spaced configurations, or of all where a target is seen only in the others.
Measurements thin_out(const Campaign& campaign, const Measurements& measurements, Index most) {
    const Measurements means = mean_measurements(*campaign.sensor, measurements);
    const Index count = means.configuration_count();
    if (count <= most) return means;
    const Measurements some = take(means, evenly_spaced(count, most));
    const auto shown = [](const Measurements& all) { return all.is_seen.colwise().any().count(); };
    return shown(some) < shown(means) ? means : some;
}

using Register = Registration (&)(const Campaign&, const Measurements&);

/// Infinity where the tool, turned so, does not turn in enough ways.
double registered_rms(const Campaign& campaign, const Measurements& measurements,
                      Register registers) {
    const Registration registered = registers(campaign, measurements);
    if (!registered.is_determined()) return std::numeric_limits<double>::infinity();
    return make_metrics(residuals(campaign, registered.parameters, measurements),
                        campaign.sensor->lengths_per_target())
        .rms();
}

/// Fits the first `count` patterns anew and sorts them.
void fit(std::vector<SignPattern>& patterns, std::size_t count, const Campaign& campaign,
         const Measurements& measurements, Register registers) {
    for_each_index(static_cast<Index>(count), [&](Index k) {
        SignPattern& pattern = patterns[static_cast<std::size_t>(k)];
        Measurements turned = measurements;
        for (Index j = 0; j < campaign.robot.joint_count(); ++j) {
            const bool is_reversed = pattern.is_reversed[static_cast<std::size_t>(j)];
            if (is_reversed) turned.configurations.col(j) *= -1;
        }
        pattern.distance_rms = registered_rms(campaign, turned, registers);
    });
    const auto end = patterns.begin() + static_cast<std::ptrdiff_t>(count);
    std::stable_sort(patterns.begin(), end,
                     [](const auto& a, const auto& b) { return a.distance_rms < b.distance_rms; });
}

/// Every choice of joints, none first.
std::vector<SignPattern> all_patterns(Index joints) {
    std::vector<SignPattern> patterns;
    for (Index bits = 0; bits < Index{1} << joints; ++bits) {
        SignPattern pattern;
        for (Index j = 0; j < joints; ++j) pattern.is_reversed.push_back((bits >> j & 1) != 0);
        patterns.push_back(pattern);
    }
    return patterns;
}

Index reversed_count(const SignPattern& pattern) {
    return std::ranges::count(pattern.is_reversed, true);
}

}  // namespace

JointSigns fit_joint_signs(const Campaign& campaign, const Measurements& measurements,
                           Index most_configurations) {
    const Index joints = campaign.robot.joint_count();
    if (joints > most_signed_joints) {
        throw InputError("the robot has " + std::to_string(joints) +
                         " joints; joint directions can be tried for at most " +
                         std::to_string(most_signed_joints));
    }
    const Measurements thinned = thin_out(campaign, measurements, most_configurations);
    // What is wrong with the measurements themselves is said once, of the robot as stated.
    JointSigns signs{{}, register_roughly(campaign, thinned).undetermined};
    if (!signs.undetermined.empty()) return signs;
    std::vector<SignPattern>& patterns = signs.patterns;
    patterns = all_patterns(joints);
    fit(patterns, patterns.size(), campaign, thinned, register_roughly);
    const std::size_t polished = std::min(polished_count, patterns.size());
    const auto stated = std::ranges::find(patterns, 0, reversed_count);
    const auto last = patterns.begin() + static_cast<std::ptrdiff_t>(polished) - 1;
    if (stated > last) std::iter_swap(stated, last);
    fit(patterns, polished, campaign, thinned, register_base_and_targets);
    std::stable_sort(
        patterns.begin(), patterns.begin() + alike_count(patterns),
        [](const auto& a, const auto& b) { return reversed_count(a) < reversed_count(b); });
    return signs;
}

Index alike_count(const std::vector<SignPattern>& patterns) {
    // A symmetric robot's patterns differ by rounding only.
    const double limit = 1.001 * patterns.front().distance_rms;
    const auto differs = [&](const auto& other) { return other.distance_rms > limit; };
    return std::ranges::find_if(patterns, differs) - patterns.begin();
}

const SignPattern& as_stated(const std::vector<SignPattern>& patterns) {
    return *std::ranges::find(patterns, 0, reversed_count);
}

bool has_clear_reversal(const std::vector<SignPattern>& patterns) {
    constexpr double far = 0.5;
    constexpr double clearly = 1 / 1.5;
    const double best = patterns.front().distance_rms;
    if (!(best < far * as_stated(patterns).distance_rms)) return false;
    const Index alike = alike_count(patterns);
    return alike == std::ssize(patterns) ||
           best < clearly * patterns[static_cast<std::size_t>(alike)].distance_rms;
}

std::vector<std::string> reversed_joints(const Chain& robot, const SignPattern& pattern) {
    std::vector<std::string> names;
    for (std::size_t j = 0; j < pattern.is_reversed.size(); ++j) {
        if (pattern.is_reversed[j]) names.push_back(robot.joints()[j].name);
    }
    return names;
}

}  // namespace posewise::detail
