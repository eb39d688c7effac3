#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// Kinds of robots that are built alike and so have errors of similar sizes.
enum class RobotClass {
    Unknown,        ///< any robot
    Small,          ///< stiff arms for assembly: reach below 1 m
    Industrial,     ///< heavier arms on the floor
    Collaborative,  ///< light arms with elastic gears
    Service,        ///< coarse arms: mobile manipulators, humanoids, low-cost arms
};

/// "unknown", "small", "industrial", "collaborative" or "service", as in files under `class`.
std::string_view robot_class_name(RobotClass kind);
/// Throws InputError for any other name.
RobotClass parse_robot_class(const std::string& name);

/// What is expected of robots of a class of which none was measured.
struct Population {
    ParameterSpread spread;              ///< sizes of the errors of ErrorModel::Full, as priors
    double model_error = 0;              ///< of that model, m a coordinate
    double model_error_orientation = 0;  ///< rad
    KnownWithin within{};
};

/// `robot` gives the size that lengths are in proportion to.
Population population_of(RobotClass kind, const Chain& robot);

}  // namespace posewise
