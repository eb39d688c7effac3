#pragma once

#include <cstdint>
#include <optional>

#include "posewise/measurement/pool.hpp"
#include "posewise/selection/exchange.hpp"

namespace posewise {

/// What a plan has besides the poses that are refined: a prior, poses already measured, or both.
struct HeldPoses {
    RowMatrixXd rows;            ///< as SelectOptions::held_rows; empty: none
    RowMatrixXd configurations;  ///< poses x joints; for the least joint distance
};

struct PlanOptions {
    Criterion criterion = Criterion::V;
    Index pose_count = 0;  ///< K, must be stated; held poses not counted
    /// Of G and V; the caller keeps them alive. Null: the first 500 poses of the pool.
    const Blocks* test_poses = nullptr;
    /// Parameters estimated along but of no interest (see nuisance_of_robot()); not with G and V.
    std::vector<Index> nuisance;
    HeldPoses held;             ///< a prior, poses measured, or both
    Index held_pose_count = 0;  ///< poses measured; m of O1 is K more

    /// Plans that are refined; the first is the best of the pool. 0: until five of them agree, at
    /// most 16. The more there may be, the more kicks of the best it takes to give up.
    Index starts = 0;
    Index bound_iterations = 30;  ///< of searched_bound at most; 0: no bound beyond the pool
    std::uint64_t seed = 1;       ///< start i draws from stream (seed, i)
    StopSignal stop{};            ///< ends the search with the best so far
    ProgressCallback progress{};  ///< of the starts, then of the kicks; its efficiency is against
                                  ///< the bound over the pool
};

/// A plan over continuous configurations.
struct PlannedPoses {
    RowMatrixXd configurations;  ///< K x joints, rad or m
    Criterion criterion = Criterion::V;
    double value = -std::numeric_limits<double>::infinity();
    MatrixXd information;  ///< of held and planned poses together
    Choice pool_choice;    ///< the best choice from the pool, its bound over the pool
    /// No plan is better, if the search for it met the global maxima. Infinity:
    /// not searched (O2, O4), or stopped before.
    double searched_bound = std::numeric_limits<double>::infinity();
    /// As Choice::efficiency, of the value against the searched bound; 0 without.
    double efficiency = 0;
    std::vector<Ending> endings;  ///< of each start; NotRun: it identified too little
    Index starts = 0;             ///< how many ended; a stop cuts others short
    Index starts_at_best = 0;     ///< how many of them ended at the best of them, to 1e-6 of it
    bool is_interrupted = false;  ///< stopped early by flag or time: the best so far
    std::uint64_t seed = 0;
};

/// K continuous poses in a cell, at nominal parameters: starts from selection on the pool (the
/// first on all of it, the others on random parts), each refined continuously on one thread; the
/// best choice of the poses that all of them ended at is refined, too, as long as that is better;
/// the best is kicked (one to three poses redrawn from the pool, then all refined again) until
/// kicks gain nothing, and finished. The result does not depend on the number of threads. Throws
/// InputError as select_poses(), or if the pool has too few poses.
PlannedPoses plan_poses(const Campaign& campaign, const Constraints& constraints, const Pool& pool,
                        double repeats, const PlanOptions& options);

/// Columns of base and sensor unknowns: the nuisance if only the robot is of interest.
std::vector<Index> nuisance_of_robot(const Campaign& campaign);

/// One pose of a tour and how it is reached.
struct Visit {
    Index pose = 0;
    std::optional<VectorXd> via;  ///< configuration to pass on the way, if the straight way is not
                                  ///< free
    bool is_blocked = false;      ///< no free way was found: the user must find one
};

struct Tour {
    std::vector<Visit> visits;
    double time = 0;                 ///< s, vias included; a blocked move counts as if it were free
    double planning_order_time = 0;  ///< of straight moves in the order the poses were given
    double nearest_neighbour_time = 0;  ///< of straight moves to the nearest pose each
    Index blocked_count = 0;
    /// There was no time to look for the shortest one, nor for ways round what blocks a move.
    bool is_cut_short = false;
};

}  // namespace posewise
