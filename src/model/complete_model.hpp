#pragma once

#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// The chain with every geometric error a rigid link can have: after each axis that joints drive
/// its own offset, and translations along and rotations about the two other axes. Own constant
/// errors of the chain are dropped, its error terms stay; the new ones are named after the driving
/// joint: `dq2`, `Tx2`, `Rz2`, with axes of the frame right after the joint. An axis that only
/// moves along with joints of other axes, as a mimic, has errors of its own, too, named after the
/// first of these joints: `dq2_2`, `Tx_q2_2`. It has 5 parameters an axis and is redundant on
/// purpose: find_identifiable() says which of them (with base and targets) can be told apart.
Chain complete_model(const Chain& chain);

/// complete_model() with the errors that depend on the configuration, too: those of joints and
/// slides that bend, with_torque_shapes(), of encoders, gears and drives of slides,
/// with_harmonics() of the orders 1 and 2, and with_gains() of slides and of axes that only follow.
/// (Gears have whole ratios: beside sines over a part of a turn a gain is hardly told apart, and
/// poses are chosen worse with it.) Far more than poses can tell apart without a prior; a robot
/// that has few of them loses little by the others, one whose errors are left out loses much.
Chain full_model(const Chain& chain, const Vector3d& gravity = -Vector3d::UnitZ());

}  // namespace posewise::detail
