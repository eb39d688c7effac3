#pragma once

#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// The chain with every geometric error a rigid link can have: after each joint element its own
/// offset, and translations along and rotations about the two other axes. Own constant errors of
/// the chain are dropped, its error terms stay; the new ones are named after the driving joint:
/// `dq2`, `Tx2`, `Rz2`, with axes of the frame right after the joint. It has 5 parameters a joint
/// element and is redundant on purpose: find_identifiable() says which of them (with base and
/// targets) can be told apart.
Chain complete_model(const Chain& chain);

}  // namespace posewise::detail
