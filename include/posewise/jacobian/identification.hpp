#pragma once

#include <vector>

#include "posewise/core/blocks.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// The identification Jacobian of one pose, sensor rows x parameter_count(campaign), in m per m
/// and m per rad. `motion` is scratch space, kept by the caller so that a loop does not allocate.
void differentiate_pose(const Campaign& campaign, const Parameters& parameters,
                        const VectorXd& configuration, FlangeMotion& motion,
                        Eigen::Ref<RowMatrixXd> J_measured_parameters);

/// Blocks without whitening or scaling, one per row of `configurations` (m x joints): the stacked
/// identification Jacobian in SI units. `repeats` (m x targets, times_seen() makes them): a target
/// with 0 is not seen, and its rows are left out. Computed over OpenMP threads. Throws InputError
/// for a configuration of the wrong size or not finite, or repeats of another shape or below 0.
Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations, const RowMatrixXd& repeats);
/// The same with all targets seen.
Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations);

/// Derivative of all targets' positions in the world, whatever of them is measured, in SI units:
/// blocks of 3 rows a target. Throws InputError as make_plain_blocks() does.
Blocks make_position_blocks(const Campaign& campaign, const Parameters& parameters,
                            const RowMatrixXd& configurations);

/// make_plain_blocks() whitened by the noise of means (sensor, joints, model) over so many
/// `repeats` of each target (m x targets) and scaled by parameter_scale(): without units, ready
/// for criteria and selection.
Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, const RowMatrixXd& repeats);
/// The same with all targets seen equally often.
Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, double repeats = 1);

}  // namespace posewise
