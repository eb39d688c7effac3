#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "posewise/criteria/criterion.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise::io {

/// One pose of a plan over continuous configurations.
struct ContinuousPose {
    std::string id;
    VectorXd joints;                   ///< rad or m
    std::vector<Index> visible;        ///< targets it shows, from 0
    std::optional<VectorXd> via = {};  ///< configuration to pass on the way there, rad or m
    bool is_blocked = false;           ///< no free way there was found
    bool is_kept = false;              ///< of the plan that was repaired
};

/// What was asked for.
struct PosePlanRequest {
    std::string campaign;  ///< path
    Criterion criterion = Criterion::V;
    bool has_prior = false;
    bool is_focused_on_robot = false;
    std::string augment;               ///< path of poses measured already; empty: none
    std::string repaired;              ///< path of the plan that was repaired; empty: none
    std::vector<std::string> dropped;  ///< ids of its poses that could not be reached
    std::string workspace;             ///< path; empty: drawn
    Index workspace_count = 0;         ///< how many shall be drawn
    /// Least x, y, z, then largest, where targets are in drawn ones; empty: the cell's boxes.
    std::vector<double> workspace_box_mm;
    Index workspace_target = 0;  ///< that counts, from 1; 0: all
    Index pool_count = 0;        ///< candidates drawn
    Index starts = 0;
    double repeats = 1;
    double time_limit = 0;  ///< s; 0: none
    std::uint64_t seed = 1;
};

/// What a file of continuous poses holds: the poses in visiting order, how good they are.
struct PosePlanFile {
    PosePlanRequest request;
    std::vector<ContinuousPose> poses;
    double value = 0;
    Index feasible_count = 0;  ///< of the pool
    double pool_value = 0;     ///< of the best choice found in the pool
    double pool_bound = std::numeric_limits<double>::infinity();  ///< proven, over the pool
    double pool_efficiency = 0;
    double searched_bound = std::numeric_limits<double>::infinity();  ///< by a search, no proof
    double searched_efficiency = 0;
    Index starts_at_best = 0;
    bool is_interrupted = false;   ///< stopped by the user or by time: the best so far
    double predicted_rms = 0;      ///< of the position error over the workspace, m
    double predicted_p95 = 0;      ///< m
    VectorXd standard_deviations;  ///< of all parameters, m or rad
    double visiting_time = 0;      ///< s
};

/// Writes the plan as JSON: joint values in rad (m) exactly and in degrees (mm) for people.
/// Relative paths are stored as seen from the plan's folder.
void write_pose_plan(const std::string& path, const PosePlanFile& file, const Campaign& campaign);

/// Whether a file says of itself that it is such a plan. Throws InputError if it cannot be read.
bool is_pose_plan(const std::string& path);

/// What was asked for. Relative paths lead from the plan's folder or else from the current one.
/// Throws InputError with the place for whatever is missing, of another type or out of range.
PosePlanRequest read_pose_plan_request(const std::string& path);

/// What verification needs: request, poses (without ways), value and predicted accuracy. Throws
/// InputError as read_pose_plan_request(), and for a plan of another robot or campaign.
PosePlanFile read_pose_plan(const std::string& path, const Campaign& campaign);

/// The configurations as CSV: config, then each joint in degrees or mm, digits enough to read the
/// numbers back exactly, then visible_targets ("1 3"). read_configurations() reads it.
void write_configurations_csv(const std::string& path, const Campaign& campaign,
                              const std::vector<ContinuousPose>& poses);

}  // namespace posewise::io
