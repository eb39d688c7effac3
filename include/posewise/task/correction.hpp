#pragma once

#include <string>
#include <vector>

#include "posewise/calibrator/correction.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// In which base frame the nominal robot's poses are meant.
enum class CorrectionBase {
    Estimate,  ///< the estimate's: the first joint's axis is where it was measured
    Campaign,  ///< the one the campaign states: programs refer to the instrument's frame
};

/// Configurations of a program, corrected.
struct CorrectedPoses {
    Chain robot;
    std::vector<std::string> ids;
    RowMatrixXd nominal;                  ///< m x joints, as programmed
    std::vector<Correction> corrections;  ///< m
    /// Configurations that are not brought home: joints are held, or it is singular there, and over
    /// half of the error is left.
    std::vector<Index> not_home{};
    /// Which of them would bring links of the campaign's cell into obstacles or each other, in
    /// words; empty: none.
    std::string collisions = {};

    /// Whether most are brought home; else these are no corrections to send to a robot.
    bool are_usable() const { return 2 * not_home.size() <= corrections.size(); }
};

/// Joint values that bring the robot with the errors found to where the nominal one would be at
/// these configurations (m x joints), see correct_configuration(). Throws InputError, with the id,
/// where a configuration is beyond the joint limits; for options out of range; or if the campaign
/// states no base though it is asked for.
CorrectedPoses correct_poses(const Campaign& campaign, const Parameters& found,
                             const RowMatrixXd& configurations, const std::vector<std::string>& ids,
                             CorrectionBase base = CorrectionBase::Estimate,
                             const CorrectionOptions& options = {});

}  // namespace posewise
