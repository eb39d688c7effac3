#pragma once

#include <array>
#include <optional>

#include "posewise/criteria/criterion.hpp"
#include "posewise/jacobian/identifiability.hpp"
#include "posewise/jacobian/unknowable.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

/// A target on the axis about which the last joint turns: that joint does not move it, and no
/// measurement of it tells the joint's zero.
struct OnAxis {
    Index target = 0;
    std::string joint;
};
/// Of stated targets, within 1e-4 of how far the robot reaches; where there are others beside the
/// axis, too, none.
std::vector<OnAxis> find_on_axis(const Campaign& campaign);

/// What can be found of a robot's errors.
struct Inspection {
    Campaign campaign;
    Campaign complete;  ///< with every error that a rigid link can have
    /// Of the parameters that the campaign states; nothing if it states none, but has the
    /// irreducible form of its complete model.
    std::optional<Identifiability> stated;
    Identifiability of_complete;
    Index least_pose_count = 0;  ///< that a calibration can do with
    Unknowable unknowable;       ///< of base and sensor
    std::vector<OnAxis> on_axis;
    Index rounded_angle_count = 0;  ///< angles of the robot's file that are taken for exact ones
};

/// `declared` is the robot as stated, from which the complete model is made; `is_stated`: its error
/// parameters are, too.
Inspection inspect(const Campaign& campaign, const Chain& declared, bool is_stated);

/// Why it is not clear what is identifiable: the parameters in the weakest direction kept. Empty if
/// there is a clear gap, or a prior, which holds what the poses hardly tell.
std::vector<std::string> find_doubtful_parameters(const Inspection& inspection);

/// How much configurations tell about the parameters, by every index.
struct Indices {
    std::array<double, all_criteria.size()> values{};  ///< in the order of all_criteria
    double condition = 0;  ///< largest singular value by the smallest; infinity if that is zero
};

/// What measured configurations tell before any calibration.
struct Rating {
    Index configurations = 0;
    Index parameters = 0;
    double repeats = 1;                  ///< samples per configuration, on average
    Indices scaled;                      ///< whitened, per expected error, with what a prior tells
    Indices plain;                       ///< in mm and mrad, without a prior
    std::vector<WeakDirection> weakest;  ///< of the scaled, weakest first
};

/// Rates the measured configurations with base and targets registered from the measurements; G and
/// V predict the configurations themselves. Names the `directions` weakest. Throws InputError if
/// base or targets cannot be registered.
Rating rate(const Campaign& campaign, const Measurements& measurements, Index directions = 3);

}  // namespace posewise
