#pragma once

#include <string>
#include <utility>
#include <vector>

#include "posewise/core/blocks.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

/// What choosing, planning and studies share about what they are given.
namespace posewise::detail {

/// What `compute` returns; its InputErrors begin with the name of what they are about, if it has
/// one.
template <class Compute>
auto compute_from(const std::string& name, Compute&& compute) {
    if (name.empty()) return std::forward<Compute>(compute)();
    try {
        return std::forward<Compute>(compute)();
    } catch (const InputError& error) {
        throw input_error_at({name}, error.what());
    }
}

/// "0", "1", ...: names of candidates that have none of their own.
std::vector<std::string> number_ids(Index count);

/// What each measured pose tells: means over its samples, of the targets that they show.
Blocks measured_blocks(const Campaign& campaign, const Parameters& parameters,
                       const Measurements& measured);

/// Angles of the joints that turn (rad), a row a configuration: what distances between poses are
/// taken of.
RowMatrixXd turning_joints(const Chain& robot, const RowMatrixXd& configurations);

/// Whether poses can be judged by campaign.nominal: base and targets are stated, or made up where
/// little depends on them. That is the base where every target's place is measured with the same
/// noise everywhere.
bool can_assume_places(const Campaign& campaign);
/// Of a sensor with has_contacts(): poses must reach what is to be touched.
InputError unstated_contacts(const Campaign& campaign);

/// Base and targets from what was measured. Throws InputError, which begins with the name of where
/// that is from, for another robot's measurements, and if they do not determine them.
Parameters register_measured(const Campaign& campaign, const Measurements& measured,
                             const std::string& name);

/// Throws InputError, which begins with `name`, if another robot's measurements are given.
void check_measured(const Campaign& campaign, const Measurements& measured,
                    const std::string& name);

/// Throws InputError for a robot whose torques are measured with each configuration: of poses that
/// are drawn nobody knows them.
void check_torques_known(const Campaign& campaign);

/// Throws InputError if so many candidates need more memory than this machine has; `option` is
/// what says how many.
void check_memory(const Campaign& campaign, Index count, const std::string& field);

/// Throws InputError where so many poses beside those measured already are fewer than a calibration
/// needs (least_calibration_count()).
void check_enough_poses(const Campaign& campaign, Index count, Index measured,
                        const StopSignal& stop);

}  // namespace posewise::detail
