#pragma once

#include <vector>

#include "posewise/calibrator/joint_signs.hpp"
#include "posewise/io/campaign_file.hpp"

namespace posewise::cli {

/// Says whether joints are reversed, which, and what to write instead; `patterns` are those of
/// fit_joint_signs().
void print_joint_directions(const io::CampaignFile& file, const std::vector<SignPattern>& patterns);

}  // namespace posewise::cli
