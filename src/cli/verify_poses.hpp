#pragma once

#include <string>

namespace posewise::cli {

/// Checks a plan of continuous poses, as `plan` writes it, against its campaign. `campaign` and
/// `augment` are where those files are now; empty: where the plan says. Throws InputError if
/// anything is not as stated.
void verify_pose_plan(const std::string& path, const std::string& campaign,
                      const std::string& augment);

}  // namespace posewise::cli
