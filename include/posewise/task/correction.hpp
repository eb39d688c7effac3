#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/correction.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// The base frame in which the nominal robot's poses are meant.
enum class CorrectionBase {
    Estimate,  ///< the estimated one: the first joint's axis is where it was measured
    Campaign,  ///< the campaign's stated one: programs refer to the instrument's frame
};

/// Corrected configurations of a program.
struct CorrectedPoses {
    Chain robot;
    std::vector<std::string> ids;
    RowMatrixXd nominal;                  ///< m x joints, as programmed
    std::vector<Correction> corrections;  ///< m
    /// Configurations that are not brought home: joints are held, or the pose is singular, and over
    /// half of the error is left.
    std::vector<Index> not_home{};
    /// Which nominal configurations bring links of the campaign's cell into obstacles or each
    /// other, in words; empty: none.
    std::string collisions = {};

    /// Whether at least half are brought home; else these corrections must not be sent to a robot.
    bool are_usable() const { return 2 * not_home.size() <= corrections.size(); }
};

/// Joint values that bring the robot with the errors found to where the nominal one would be at
/// these configurations (m x joints), see correct_configuration(). Throws InputError, with the id,
/// if a configuration is beyond the joint limits; for options out of range; or if the campaign
/// states no base but `base` asks for it.
CorrectedPoses correct_poses(const Campaign& campaign, const Parameters& found,
                             const RowMatrixXd& configurations, const std::vector<std::string>& ids,
                             CorrectionBase base = CorrectionBase::Estimate,
                             const CorrectionOptions& options = {});

}  // namespace posewise
