#pragma once

#include <optional>

#include "posewise/jacobian/identifiability.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// What can be found of a robot's errors.
struct Inspection {
    Campaign campaign;
    Campaign complete;  ///< with every error that a rigid link can have
    /// Of the parameters that the campaign states; nothing if it states none, but has the
    /// irreducible form of its complete model.
    std::optional<Identifiability> stated;
    Identifiability of_complete;
    Index least_pose_count = 0;  ///< that identifies all of the campaign that is identifiable
};

/// `declared` is the robot as stated, from which the complete model is made; `is_stated`: its error
/// parameters are, too.
Inspection inspect(const Campaign& campaign, const Chain& declared, bool is_stated);

/// Why it is not clear what is identifiable: the parameters in the weakest direction kept. Empty if
/// there is a clear gap, or a prior, which holds what the poses hardly tell.
std::vector<std::string> find_doubtful_parameters(const Inspection& inspection);

}  // namespace posewise
