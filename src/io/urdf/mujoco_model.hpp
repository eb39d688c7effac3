#pragma once

#include <string>
#include <vector>

#include "posewise/task/inspection.hpp"

/// Robots in the format of MuJoCo (MJCF),
/// https://mujoco.readthedocs.io/en/stable/XMLreference.html.
namespace posewise::detail {

/// The robot with its constant errors (error terms left out): a body for each element that joints
/// drive, whose frame has what is constant before it, so that qpos are the joints' own values (rad
/// or m). Where a joint drives further elements (couplings), or one by another factor, a joint
/// "q2.2" follows it by an equality. Last comes the body "flange" with a site at each target, or
/// the tool. Throws InputError if a joint drives no element by a factor of 1 or -1.
std::string mujoco_text(const std::string& title, const Geometry& geometry);

/// The chain of such a file, whose joints are these. Throws InputError with the place for another.
Chain read_mujoco(const std::string& path, const std::vector<Joint>& joints);

}  // namespace posewise::detail
