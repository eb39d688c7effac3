#pragma once

#include "posewise/model/chain.hpp"

/// What Chain's constructor and what adds terms to a chain require. All throw InputError.
namespace posewise::detail {

/// Names that are unique, limits that are finite and in order.
void check_joints(const std::vector<Joint>& joints);

/// Numbers, joint indices and error terms that make sense (terms may depend on `input_count`
/// numbers: joints and measured torques), parameter names that are unique among all names.
void check_elements(const std::vector<Element>& elements, const std::vector<Joint>& joints,
                    Index input_count);

/// Whether each joint turns or slides: every one drives an element, and all that it drives alike.
std::vector<Motion> find_motions(const std::vector<Joint>& joints,
                                 const std::vector<Element>& elements);

/// A direction of gravity that is finite and not zero.
void check_direction(const Vector3d& direction);

/// Torques of joints that turn, each once. The joints' motions are set.
void check_torques(const std::vector<MeasuredTorque>& torques, const std::vector<Joint>& joints);

}  // namespace posewise::detail
