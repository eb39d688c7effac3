#pragma once

#include <cstdint>
#include <optional>

#include "posewise/measurement/constraints.hpp"
#include "posewise/selection/choice.hpp"

namespace posewise {

/// What a plan has besides the refined poses: a prior, poses already measured, or both.
struct HeldPoses {
    RowMatrixXd rows;            ///< like SelectOptions::held_rows; empty: none
    RowMatrixXd configurations;  ///< poses x joints; for the least joint distance
};

struct PlanOptions {
    Criterion criterion = Criterion::V;
    Index pose_count = 0;  ///< K, must be stated; held poses are not counted
    /// Test poses for G and V; the caller keeps them alive. Null: the first 500 poses of the pool.
    const Blocks* test_poses = nullptr;
    /// Parameters that are estimated, too, but of no interest (see nuisance_of_robot()); not with G
    /// and V.
    std::vector<Index> nuisance;
    HeldPoses held;             ///< a prior, poses measured, or both
    Index held_pose_count = 0;  ///< poses measured; they count in the m of O1

    /// Plans to refine; the first is the best of the pool. 0: 5; 16 in a cell that restricts
    /// places and where poses hardly suffice. With a larger number, more kicks of the best plan are
    /// tried before giving up.
    Index starts = 0;
    Index bound_iterations = 30;  ///< limit for the searched bound; 0: no bound beyond the pool
    std::uint64_t seed = 1;       ///< start i draws from stream (seed, i)
    StopSignal stop{};            ///< ends the search with the best so far
    /// Counts starts, then kicks; its efficiency is against the bound over the pool.
    ProgressCallback progress{};
};

/// A plan over continuous configurations.
struct PlannedPoses {
    RowMatrixXd configurations;  ///< K x joints, rad or m
    Criterion criterion = Criterion::V;
    double value = -std::numeric_limits<double>::infinity();
    MatrixXd information;  ///< from held and planned poses together
    Choice pool_choice;    ///< the best choice from the pool, with its bound over the pool
    /// No plan is better, if the search for this bound met the global maxima. Infinity: not
    /// searched (O2, O4), or stopped before.
    double searched_bound = std::numeric_limits<double>::infinity();
    /// Like Choice::efficiency, against the searched bound; 0 without one.
    double efficiency = 0;
    std::vector<Ending> endings;  ///< for each start; NotRun: it identified too little
    Index starts = 0;             ///< how many ended; a stop cuts others short
    Index starts_at_best = 0;     ///< how many of them ended at the best value, to 1e-6 of it
    bool is_interrupted = false;  ///< stopped early by flag or time: the best so far
    std::uint64_t seed = 0;
};

/// Plans K continuous poses in a cell, at nominal parameters. Starts come from selection on the
/// pool (the first on all of it, the others on random parts); each is refined continuously on one
/// thread. The best choice among all poses they end at is refined, too, as long as that is better.
/// The best plan is kicked (one to three poses redrawn from the pool and moved to where they tell
/// most, the best of some tries; then all refined again, unless first steps show that it leads
/// nowhere) until kicks gain nothing, and finished. Independent of the number of threads. Throws
/// InputError as select_poses(), or if the pool has too few poses.
PlannedPoses plan_poses(const Campaign& campaign, const Constraints& constraints, const Pool& pool,
                        double repeats, const PlanOptions& options);

/// Columns of base and sensor unknowns: the nuisance if only the robot is of interest.
std::vector<Index> nuisance_of_robot(const Campaign& campaign);

/// One pose of a tour and how it is reached.
struct Visit {
    Index pose = 0;
    std::optional<VectorXd> via;  ///< configuration to pass first if the straight way is blocked
    bool is_blocked = false;      ///< no free way was found: the user must find one
};

struct Tour {
    std::vector<Visit> visits;
    double time = 0;                    ///< s, with vias; a blocked move counts as if it were free
    double planning_order_time = 0;     ///< straight moves in the order the poses were given
    double nearest_neighbour_time = 0;  ///< straight moves, always to the nearest pose
    /// With vias, of the shortest order that was found; another than `time` for a random order.
    double shortest_time = 0;
    Index blocked_count = 0;
    /// There was no time to find the shortest tour, nor ways around what blocks a move.
    bool is_cut_short = false;
};

}  // namespace posewise
