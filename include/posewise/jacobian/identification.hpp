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
/// identification Jacobian in SI units.
Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations);

/// Blocks whitened by the noise (sensor / repeats, plus model error) and scaled by
/// parameter_scale(): without units, ready for criteria and selection. Computed over OpenMP
/// threads. Throws InputError for a configuration of the wrong size or not finite.
Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, double repeats = 1);

}  // namespace posewise
