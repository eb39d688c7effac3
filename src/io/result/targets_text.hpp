#pragma once

#include <string>

#include "posewise/task/plan.hpp"

namespace posewise::detail {

/// Throws InputError about the file at `path` unless a sensor measures points and the campaign
/// states where they are, or if there are several such sensors and the file is a list (.txt).
void check_has_targets(const std::string& path, const Campaign& campaign);

/// The text of io::write_targets().
std::string targets_text(const std::string& path, const Campaign& campaign, const Plan& plan);

}  // namespace posewise::detail
