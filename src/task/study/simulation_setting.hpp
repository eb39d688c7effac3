#pragma once

#include <vector>

#include "posewise/measurement/constraints.hpp"
#include "posewise/task/study.hpp"
#include "trial_robot.hpp"

/// What all trials of a simulated study share.
namespace posewise::detail {

Subset take(const Pool& pool, const std::vector<Index>& chosen);

/// What all trials of a campaign share.
struct SimulationSetting {
    Campaign campaign;
    Campaign truth;
    Pool pool;
    RowMatrixXd test;
    /// Of the squares' mean over the test configurations: trace(H Cov) is that of the parameters.
    MatrixXd H;
    std::vector<std::vector<Subset>> planned;  ///< by pose count and criterion
    TrialSeries series;
};

/// Throws InputError for options out of range.
void check_simulation(const SimulatedStudyOptions& options);

/// The pool, the workspace and the planned poses of a campaign. Throws as simulate_study().
SimulationSetting make_setting(const SimulatedCampaign& given,
                               const SimulatedStudyOptions& options);

}  // namespace posewise::detail
