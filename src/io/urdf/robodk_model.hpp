#pragma once

#include <string>
#include <vector>

#include "posewise/model/chain.hpp"
#include "posewise/model/dh.hpp"

/// Robots as parameters of RoboDK.
namespace posewise::detail {

/// A Python script with the robot's modified Denavit-Hartenberg rows [alpha, a, theta, d] in rad
/// and mm and its frames before and behind them. Run beside RoboDK it sends them as the accurate
/// kinematics of a robot there, as setRobotParams() does [RoboDK API for C#, command
/// S_AbsAccParam].
std::string robodk_text(const std::string& title, const ModifiedDh& table);

/// The chain of such a file, whose joints are these. Throws InputError for another.
Chain read_robodk(const std::string& path, const std::vector<Joint>& joints);

}  // namespace posewise::detail
