#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"

namespace posewise::detail {

/// Of more joints the choices are too many to try.
inline constexpr Index most_signed_joints = 12;

/// Some joints taken as reversed, and how well the nominal robot then fits.
struct SignPattern {
    std::vector<bool> is_reversed;  ///< joint by joint, against the campaign
    double distance_rms = 0;        ///< of the means, base and targets registered, m
};

/// How each choice of reversed joints fits.
struct JointSigns {
    /// The best fitting first, of those that fit alike the one that reverses the fewest joints.
    std::vector<SignPattern> patterns;
    /// Why the measurements cannot be registered at all, as Registration has it; then there are no
    /// patterns.
    std::string undetermined;
};

/// All 2^joints patterns of joint directions. Patterns of a symmetric robot
/// fit exactly alike. Each is registered from nothing, the best 64 and
/// what is stated with polish, with at most
/// `most_configurations` configurations evenly taken from the measurements (all if those do not
/// show every target). Throws InputError for more than 12 joints, or as register_base_and_targets()
/// does.
JointSigns fit_joint_signs(const Campaign& campaign, const Measurements& measurements,
                           Index most_configurations = 60);

/// So many of the first patterns fit alike.
Index alike_count(const std::vector<SignPattern>& patterns);

/// The one that reverses none.
const SignPattern& as_stated(const std::vector<SignPattern>& patterns);

/// Whether joints must be reversed: the best pattern, or any that fits alike, fits far better than
/// what is stated, and clearly better than all others.
bool has_clear_reversal(const std::vector<SignPattern>& patterns);

/// The joints that a pattern reverses.
std::vector<std::string> reversed_joints(const Chain& robot, const SignPattern& pattern);

}  // namespace posewise::detail
