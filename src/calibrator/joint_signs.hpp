#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/estimate.hpp"

namespace posewise::detail {

/// Some joints taken as reversed, and how well the nominal robot then fits.
struct SignPattern {
    std::vector<bool> is_reversed;  ///< joint by joint, against the campaign
    double distance_rms = 0;        ///< of the means, base and targets registered, m
};

/// How each choice of reversed joints fits.
struct JointSigns {
    std::vector<SignPattern> patterns;  ///< the best fitting first
    /// Why the measurements cannot be registered at all, as Registration has it; then there are no
    /// patterns.
    std::string undetermined;
};

/// All 2^joints patterns of joint directions. Patterns of a symmetric robot
/// fit exactly alike. Each is registered from nothing, the best 64 with polish, with at most
/// `most_configurations` configurations evenly taken from the measurements (all if those do not
/// show every target). Throws InputError for more than 12 joints, or as register_base_and_targets()
/// does.
JointSigns fit_joint_signs(const Campaign& campaign, const Measurements& measurements,
                           Index most_configurations = 60);

}  // namespace posewise::detail
