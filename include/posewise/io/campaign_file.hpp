#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise::io {

/// Which variables of a MATLAB file hold what.
struct MatMapping {
    std::string joints = "q";         ///< samples x joints
    std::vector<std::string> points;  ///< one variable a target, samples x 3
    double joint_unit = 1;            ///< in rad or m
    double point_unit = 1;            ///< in m
};

/// A campaign file: the campaign and the defaults of the command line.
struct CampaignFile {
    std::string path;
    Campaign campaign;
    Criterion criterion = Criterion::D;
    std::uint64_t seed = 1;
    MatMapping mat;
};

/// Reads a campaign from YAML. Throws InputError with path:line:column for anything missing,
/// misspelt or out of range.
CampaignFile read_campaign(const std::string& path);

}  // namespace posewise::io
