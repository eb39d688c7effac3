#pragma once

#include <cstdint>
#include <optional>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise::detail {

/// Configurations of the robot at work, `count` at most: a low-discrepancy sample within its limits
/// and its cell (what the instrument sees does not matter) with every target in the box (in the
/// base frame), if there is one. Throws InputError if there is none.
RowMatrixXd workspace_configurations(const Campaign& campaign, const std::optional<Box>& target_box,
                                     Index count, std::uint64_t seed);

/// The same of a robot whose base and targets were found; random ones where torques are measured,
/// which no cell knows.
RowMatrixXd workspace_configurations(const Campaign& campaign, const Parameters& found, Index count,
                                     std::uint64_t seed);

/// What one reading there is expected to be off by and, if that is in pixels, the board's place.
struct WorkspaceError {
    ExpectedError readings;
    std::optional<ExpectedError> place;  ///< m
    std::optional<RobotError> robot;
};
/// Nothing where no configurations can be drawn, or readings are made at contacts only.
std::optional<WorkspaceError> expected_workspace_error(const Campaign& campaign,
                                                       const Estimate& estimate);

}  // namespace posewise::detail
