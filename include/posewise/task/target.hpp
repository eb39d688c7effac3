#pragma once

#include <optional>
#include <vector>

#include "posewise/task/planning.hpp"

namespace posewise {

/// What a plan shall reach, or how long it may take, in place of its number of poses.
struct TargetOptions {
    std::optional<double> limit;  ///< of the position error over the workspace, m
    double assurance = 0.95;      ///< probability of that before measuring
    ErrorQuantity quantity = ErrorQuantity::Rms;
    std::optional<double> duration;  ///< s, see Planning::duration
    Index most_poses = 1000;         ///< new ones
    /// The limit is to be kept although so many poses, those that hurt most, drop out.
    Index robust_to = 0;
};

/// What a number of new poses is expected to reach, drop-outs considered.
struct CountPrediction {
    Index pose_count = 0;
    bool is_planned = false;  ///< as planned; else chosen from a part of the pool: an estimate
    /// Nothing: too few to identify the parameters. Never above that of fewer poses chosen.
    std::optional<ErrorRange> error;
    double duration = 0;  ///< s; of chosen poses straight moves and no collisions considered
};

/// Numbers of poses that are enough if the errors turn out as small, or as large, as one in twenty
/// is: how far the number that a target needs may be off. Chosen from a part of the pool, see
/// CountPrediction::is_planned.
struct CountRange {
    std::optional<Index> lower;  ///< with 5 % probability it is enough
    std::optional<Index> upper;  ///< with 95 %; nothing: more than `most`, or no number
    Index most = 0;              ///< that were looked at
};

/// How a search for the number of poses ended.
enum class TargetEnding {
    NotRun,
    Reached,       ///< the plan keeps the limit, one of fewer poses does not; or as many as fit
    BelowFloor,    ///< no number of poses keeps the limit
    TooManyPoses,  ///< TargetOptions::most_poses, or the pool, do not
    TooLong,       ///< what keeps the limit takes longer than there is time
};

/// A plan of as many poses as a target needs.
struct TargetPlanning {
    TargetOptions target;
    TargetEnding ending = TargetEnding::NotRun;
    std::optional<Planning> planning;  ///< if it is Reached
    std::optional<ErrorRange> error;   ///< of that plan
    /// There is no plan of one pose less that keeps the limit, or without a limit of one more that
    /// fits, as far as a search to its end found; false: stopped early, there may be one.
    bool is_settled = false;
    std::optional<CountRange> counts;       ///< for a limit; nothing: stopped early
    std::vector<CountPrediction> curve;     ///< by count, as far as it was looked at
    ErrorRange floor;                       ///< left where the parameters are known exactly
    double floor_of_known_model_error = 0;  ///< m: the same if the model error were as expected
    double left_over = 0;          ///< parts of the floor as expected, m: by the model error,
    double repeatability = 0;      ///< and by that of the joints
    bool has_error_terms = false;  ///< the model has errors that depend on the configuration
};

/// The least number of poses whose plan keeps the limit, and that plan: found by choices from a
/// part of the pool, then by quick plans, in the end by plans as make_plan() makes them. Without a
/// limit: as many poses as fit in the duration. options.pose_count is not looked at; a stop ends
/// the search with the last plan that keeps what was asked for, marked as stopped early. Throws
/// InputError for options that cannot be met by any number (a limit, assurance or duration out of
/// range, none of them, a plan to repair, a duration too short for the least number of poses), if
/// it is stopped before there is a plan, and as make_plan().
TargetPlanning plan_for_target(const Campaign& campaign, const PlanningOptions& options,
                               const TargetOptions& target);

}  // namespace posewise
