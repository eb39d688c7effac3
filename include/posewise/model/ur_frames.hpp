#pragma once

#include <array>

#include "posewise/model/chain.hpp"

namespace posewise {

/// Frames of the joints of a robot with six, each in the one before, joint values zero:
/// base_from_flange(q) = F1 RotZ(q1) F2 RotZ(q2) ... F6 RotZ(q6), as descriptions of Universal
/// Robots have them.
using UrFrames = std::array<Isometry3d, 6>;

/// By how much a rounded description's flange may be beside the last joint's axis.
struct UrRounding {
    double position = 1e-6;     ///< m
    double orientation = 3e-5;  ///< rad
};
inline constexpr UrRounding ur_rounding{};

/// The chain from base_link_inertia, where frames of a UR begin, if it begins with half a turn
/// about z, as descriptions with ROS's base_link do; else the chain itself.
Chain without_half_turn(const Chain& chain);

/// A chain, without_half_turn(), as these frames, exact for all joint values. Each is where its
/// axis is nearest to the next one; if these are nearly parallel (within 0.1 rad), nearest to the
/// one before, and between two such where the axis meets the plane through the frame before across
/// its axis; the last is the flange. A UR's thus stand where its makers put them. `parameters` are
/// the chain's error parameters (rad or m); those of error terms count as zero. Throws InputError
/// unless there are six joints that turn, each about one axis of its own in the order of the chain
/// and neither geared nor coupled, the flange's z axis is the last joint's, and the first frame is
/// turned about the base's z axis by less than a quarter. Where it is that but for rounding, as in
/// descriptions that say 1.5708, the flange is brought onto it.
UrFrames ur_frames(const Chain& chain, const VectorXd& parameters);

/// The chain of these frames, with the six joints of another one.
Chain ur_chain(const UrFrames& frames, const std::vector<Joint>& joints);

}  // namespace posewise
