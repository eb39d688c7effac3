#pragma once

#include <optional>
#include <string>
#include <vector>

#include "campaign_sections.hpp"

/// What the ways to state a robot share: elements, DH table, URDF.
namespace posewise::detail {

/// Either way: no robot's joint turns farther.
inline constexpr double most_turns = 3;

// Far above any robot: what is more is no robot, and would only take memory and time.
inline constexpr std::size_t most_joints = 100;
inline constexpr std::size_t most_elements = 1000;

/// Throws InputError if a joint cannot have that name: it is part of columns and of elements.
void check_joint_name(const std::string& name, const FileLocation& location);

/// The joint with the limits that `map` states; nothing if it states none. Throws InputError if
/// they are in a unit that does not suit the motion.
std::optional<Joint> find_limited_joint(const YamlMap& map, const std::string& name, Motion motion);
/// The same, but the limits must be stated; with the pitch, if there is one.
Joint read_limited_joint(const YamlMap& map, const std::string& name, Motion motion);

/// rad or m; 0 if it is not stated.
double read_repeatability(const YamlMap& map, Motion motion);
/// Of the drive of a slide, m; 0 if it is not stated. Throws InputError for a joint that turns.
double read_pitch(const YamlMap& map, Motion motion);

/// `elements` and `joints`.
RobotSection read_elements(const YamlMap& robot);
/// `dh`.
RobotSection read_dh(const YamlValue& dh);
/// `urdf`, `base_link`, `tip_link` and perhaps `joints`.
RobotSection read_urdf_robot(const YamlMap& robot);

/// Adds the terms that `gravity`, `harmonics`, `axis_tilt` and `compliance` state to
/// `section.declared`.
void add_stated_terms(const YamlMap& robot, RobotSection& section);

}  // namespace posewise::detail
