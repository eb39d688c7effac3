#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/calibrator/estimate.hpp"

/// A look at what a calibration leaves over: patterns that errors of a robot and noise do not have,
/// but slips of a measurement do.
namespace posewise {

/// What configurations are missed by when each is predicted by the others (RMS of distances, m; of
/// angles, rad, where no length is measured): as it is, and with a cure, which was fitted.
struct HeldOutChange {
    double before = 0;
    double after = 0;
};

/// Configurations that the others contradict.
struct OutlyingConfigurations {
    std::vector<std::string> ids;  ///< the worst first
    double squares_left = 1;       ///< part of the sum of squares that a fit without them leaves
    HeldOutChange held_out;        ///< without them
    /// Two of them that fit with each other's joint values.
    std::optional<std::pair<std::string, std::string>> exchanged;
};

/// A part of the set-up that is not where it was for all configurations.
struct SetUpChange {
    /// "base" (or the instrument), "target2", "tool", "socket s3", "readings of target2"
    std::string part;
    bool is_gradual = false;  ///< drifts from the first to the last, else one step
    std::string last_before;  ///< ids of the configurations that it happens between
    std::string first_after;
    /// The second part less the first, or over all configurations: of base, sockets and readings in
    /// the instrument's axes (of the base its origin), else in the flange's; m.
    Vector3d translation = Vector3d::Zero();
    Vector3d rotation = Vector3d::Zero();  ///< rad; 0 where that is within chance
    /// The fewer configurations, before or after: "21-40" as leave_out() takes it. Empty: leaving
    /// them out is no cure, and `held_out` is with the change as one more unknown.
    std::string excluded;
    HeldOutChange held_out;
};

/// A factor that all measured lengths have, of the instrument's scale or the robot's temperature.
/// What tells it from errors of the robot are the expected sizes of these alone.
struct LengthFactor {
    double excess = 0;     ///< factor - 1; above 0: the measured lengths are longer
    double deviation = 0;  ///< standard deviation of that
    /// Where it is beyond chance, the robot's errors in their expected sizes (RMS): as it is, and
    /// with readings scaled back.
    struct Errors {
        double before = 0;
        double after = 0;
    };
    std::optional<Errors> errors{};
};

/// Residuals that follow one joint.
struct JointPattern {
    enum class Kind {
        Scale,     ///< an error in proportion to its value
        Backlash,  ///< an error with the sign of its last motion, in the order measured
    };
    std::string joint;
    Kind kind = Kind::Scale;
    double size = 0;  ///< Scale: a number; Backlash: from one side to the other, rad or m
    bool is_angle = true;
    HeldOutChange held_out;  ///< with it as one more unknown
};

/// All joint angles are multiples of a step that explains what is left over.
struct RoundedJoints {
    double step = 0;         ///< rad
    double effect = 0;       ///< that rounding alone has on distances (RMS, m; rad without lengths)
    HeldOutChange held_out;  ///< with the rounding stated as the joints' repeatability
};

/// All lengths read are multiples of a step that explains what is left over.
struct RoundedReadings {
    double step = 0;    ///< m
    double effect = 0;  ///< that rounding alone has on distances (RMS, m)
    double left = 0;    ///< that the fit leaves (RMS, m)
};

/// Rows of the file that belong to others.
struct ShiftedRows {
    std::string first;  ///< configuration from which on
    Index shift = 0;    ///< its joint values are of the row so many before (below 0: after)
    double before = 0;  ///< median that the nominal robot misses, m or rad
    double after = 0;   ///< the same with rows set right
};

/// What is seen; each by itself is seen by chance in less than one of a thousand campaigns, the
/// factor of lengths in three.
struct ResidualLook {
    std::optional<OutlyingConfigurations> outlying;
    std::vector<SetUpChange> changes;
    std::optional<LengthFactor> lengths;  ///< wherever lengths tell of one
    std::vector<JointPattern> joints;
    std::optional<RoundedJoints> rounded;
    std::optional<RoundedReadings> rounded_readings;
    std::optional<ShiftedRows> shifted;

    bool is_empty() const;
};

/// Looks at what `estimate`, identified from these measurements of the campaign, leaves over.
/// Without measurements that determine it, or with fewer than eight configurations, nothing. Cures
/// are fitted where something is found, else nothing is.
ResidualLook look_at_residuals(const Campaign& campaign, const Measurements& measurements,
                               const Estimate& estimate);

/// Configurations that a robust fit calls outliers, a fifth of all and ten at most, if without them
/// a tenth of what all leave (RMS) is left at most. For measurements that the nominal robot misses
/// grossly: beside errors so large the look above sees no single one.
std::optional<OutlyingConfigurations> find_gross_configurations(const Campaign& campaign,
                                                                const Measurements& measurements,
                                                                const Estimate& estimate);

/// Rows whose joint values are those of the row before or after, from some row on, if the nominal
/// robot then misses half of the readings by less than a fifth. For measurements that it misses
/// grossly.
std::optional<ShiftedRows> find_shifted_rows(const Campaign& campaign,
                                             const Measurements& measurements);

}  // namespace posewise
