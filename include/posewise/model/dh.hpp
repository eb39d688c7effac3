#pragma once

#include <array>
#include <vector>

#include "posewise/model/chain.hpp"

namespace posewise {

/// One row of a Denavit-Hartenberg table: lengths in m, angles in rad. The nominal value of the
/// driven quantity is the joint's offset.
struct DhRow {
    double a = 0;
    double alpha = 0;
    double d = 0;
    double theta = 0;
    Motion motion = Motion::Rotation;  ///< a rotation drives theta, a translation d
    std::vector<JointTerm> joints;     ///< empty: a fixed row (pedestal or tool)
    /// Rotation about y, standard convention only. Where the next axis is nearly parallel it
    /// replaces d, which would be very large [Hayati 1983, "Robot arm geometric link parameter
    /// estimation"].
    double beta = 0;
};

/// The row as elements; those that do nothing are omitted. Standard convention: a and alpha belong
/// to the link after the joint; RotZ(theta) TransZ(d) TransX(a) RotX(alpha) [Denavit & Hartenberg
/// 1955] RotY(beta) [Hayati 1983].
std::vector<Element> dh_elements(const DhRow& row);

/// Modified convention: a and alpha belong to the link before the joint;
/// RotX(alpha) TransX(a) RotZ(theta) TransZ(d) [Craig 1986, eq. 3.6]. It has no beta.
std::vector<Element> mdh_elements(const DhRow& row);

/// A whole chain as rows of the standard convention, exact for all joint values. From base to
/// flange: a fixed row to the axis of the first joint (omitted if that is the base's z axis), one
/// row per driven element, a fixed row (theta and d only) to the flange (omitted if it does
/// nothing). Each row follows the common normal to the next axis; for parallel axes (within
/// 1e-12 rad) the one through its own origin. If the next axis is nearly parallel (within 0.1 rad),
/// the row uses theta, a, alpha and beta: it leads to where that axis meets the plane through its
/// own origin perpendicular to its own axis. The x axis may point either way: the row nearer to the
/// chain's own elements is taken, where these are such rows. `parameters` are the chain's error
/// parameters (rad or m); error terms, which no row can express, count as zero.
///
/// Without `has_beta` rows between two joints follow the common normal whatever the angle: it may
/// be kilometres away, and the rows' d as long.
std::vector<DhRow> dh_rows(const Chain& chain, const VectorXd& parameters, bool has_beta = true);

/// A chain of joints that turn as rows of the modified convention, mdh_elements(), for programs
/// that know neither fixed rows nor beta: what is before the first axis and behind the last joint
/// are frames of their own.
struct ModifiedDh {
    Isometry3d base =
        Isometry3d::Identity();  ///< in front of the first row, whose a and alpha are 0
    std::vector<DhRow> rows;     ///< one a joint, which turns it about +z
    Isometry3d tool = Isometry3d::Identity();  ///< from behind the last row to the flange
};

/// Made of dh_rows() without beta. Throws InputError unless each joint turns one axis of its own,
/// in the order of the chain and neither geared nor coupled.
ModifiedDh modified_dh(const Chain& chain, const VectorXd& parameters);

/// Joint frames of a six-joint robot, each in the previous one, at zero joint values:
/// base_from_flange(q) = F1 RotZ(q1) F2 RotZ(q2) ... F6 RotZ(q6), as in descriptions of Universal
/// Robots.
using UrFrames = std::array<Isometry3d, 6>;

/// How far a rounded description may put the flange off the axis of the last joint.
struct UrRounding {
    double position = 1e-6;     ///< m
    double orientation = 3e-5;  ///< rad
};
inline constexpr UrRounding ur_rounding{};

/// The chain from base_link_inertia on, where the frames of a UR begin, if it begins with half a
/// turn about z, as descriptions with ROS's base_link do; else the chain itself.
Chain without_half_turn(const Chain& chain);

/// The chain, without_half_turn(), as UR frames, exact for all joint values. Each origin is the
/// point of its axis nearest to the next axis. If these are nearly parallel (within 0.1 rad), it is
/// the point nearest to the previous axis; if that is nearly parallel, too, it is where the axis
/// meets the plane through the previous origin perpendicular to the previous axis. The last frame
/// is the flange. This puts the frames of a UR where its makers put them. `parameters` are the
/// chain's error parameters (rad or m); error terms count as zero. Throws InputError unless there
/// are six revolute joints, each about one axis of its own in the order of the chain and neither
/// geared nor coupled, the flange's z axis is the last joint's, and the first frame is turned about
/// the base's z axis by less than a quarter turn. If the flange is off that axis only by rounding,
/// as in descriptions that say 1.5708, it is moved onto it.
UrFrames ur_frames(const Chain& chain, const VectorXd& parameters);

/// The chain with these frames and the six joints given.
Chain ur_chain(const UrFrames& frames, const std::vector<Joint>& joints);

}  // namespace posewise
