#pragma once

#include "io/format/json_reader.hpp"
#include "posewise/model/chain.hpp"

namespace posewise::detail {

/// What a robot is: `elements`, each with motion, nominal amount, what drives it and the name of
/// its error; `terms`, the errors that depend on the configuration, each with its function. Joint
/// limits are not in it; but the shapes of torques follow from them.
Json robot_statement(const Chain& robot);

/// Throws InputError, which names the first element or term that differs and both its statements,
/// if `stated` is of another robot. Amounts are alike within 1e-9.
void check_is_of_robot(const JsonValue& stated, const Chain& robot);

/// The same of the robot that another campaign, in the file at `path`, states.
void check_is_same_robot(const std::string& path, const Chain& other, const Chain& robot);

}  // namespace posewise::detail
