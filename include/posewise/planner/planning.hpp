#pragma once

#include <cstdint>
#include <optional>

#include "posewise/core/blocks.hpp"
#include "posewise/measurement/campaign.hpp"
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
    /// Parameters that are estimated, too, but of no interest (see nuisance_of()); not with G
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

/// Parameters that count; the others are estimated along with them.
enum class Focus {
    All,
    Robot,  ///< the robot's errors
    Place   ///< lengths and angles among the sensor's unknowns: hand-eye, a tool, targets
};
/// Columns of what does not count, the base's among them. Intrinsic parameters and errors of a
/// board's corners are no place. Throws InputError if nothing is left that counts.
std::vector<Index> nuisance_of(Focus focus, const Campaign& campaign);

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

/// Expected error of the calibrated model's target positions due to the covariance M^-1 of the
/// parameters alone (no noise of a later measurement), m.
struct PredictedAccuracy {
    double rms = 0;           ///< position error over workspace and targets
    double percentile95 = 0;  ///< 95 % of the position errors are below
    double worst_rms = 0;     ///< RMS at the worst configuration and target
    /// Degrees of freedom of the scaled chi-squared with the mean and variance of the mean square
    /// over the workspace [Satterthwaite 1946].
    double degrees_of_freedom = 1;
    /// With a prior: parameter directions that are independent before and after measuring. For
    /// each, its share of the mean square (sum 1), and the prior's share of the information on it.
    /// Empty without a prior.
    VectorXd by_direction{};
    VectorXd prior_part{};
    /// The model error's share of the noise variance; the rest is the sensor's and joints'.
    double model_share = 1;
    double left_over = 0;  ///< RMS that the model error adds, which no number of poses reduces
    KnownWithin known_within{};

    /// Logarithmic derivative of the mean square by the square of the expected sizes; that by the
    /// square of the noise is 1 minus this.
    double prior_share() const { return by_direction.dot(prior_part); }
    /// Factor on the predicted mean square if the squares of the model error and of the parameters'
    /// sizes are these multiples of the expected ones. A calibration finds the former from its
    /// residuals and weights by it; sizes it takes as expected.
    double growth(double model_square, double size_square) const;
};

/// Predicted accuracy including what the model cannot express, which no number of poses reduces:
/// RMS over workspace and targets, m.
struct PredictedTotal {
    double rms = 0;  ///< with the model error as the campaign expects it
    /// Ends of the 90 % interval. Drawn are the parameters' errors, the model error and, with a
    /// prior, the size of all errors; these two log-normal (see below).
    double lower = 0;
    double upper = 0;  ///< 95 % are below
};

/// Uses 4096 cases that evenly fill what is unknown. Model error and sizes are drawn as
/// PredictedAccuracy::known_within states; the parameters' errors follow by its growth(). The
/// instrument's noise is as stated.
PredictedTotal predict_total(const PredictedAccuracy& accuracy);

/// The RMS of each case of predict_total(), with `repeatability` (m, RMS of a position) added.
VectorXd total_cases(const PredictedAccuracy& accuracy, double repeatability = 0);

/// Derivative of target positions at workspace configurations by the scaled parameters, in m:
/// blocks with 3 rows per target. As test poses they make V the inverse of the predicted mean
/// square position error, summed over targets, and G that of the worst. `target`: only that one
/// (from 0); -1: all. Throws InputError for a target the sensor does not have.
Blocks make_prediction_blocks(const Campaign& campaign, const Parameters& parameters,
                              const RowMatrixXd& workspace, Index target = -1);

/// How much the information of poses (scaled parameters) falls per logarithmic increase of a noise
/// variance.
struct InformationByNoise {
    MatrixXd model;  ///< by the model error
    MatrixXd noise;  ///< by the sensor's and joints' noise
};

/// For poses (m x joints) with `repeats` samples of each target (m x targets). By differences.
InformationByNoise information_by_noise(const Campaign& campaign, const Parameters& parameters,
                                        const RowMatrixXd& configurations,
                                        const RowMatrixXd& repeats);

/// Accuracy over prediction blocks for the information matrix M (scaled parameters). `prior` is the
/// part of M that was known before measuring (parameters square; empty or 0: nothing). The
/// percentile is of 200 draws per position, from stream (seed, position). Throws InputError if M is
/// not positive definite or there are no blocks.
PredictedAccuracy predict_accuracy(const Blocks& prediction, const MatrixXd& M,
                                   const MatrixXd& prior = {}, std::uint64_t seed = 1);

/// Which figure of the position errors over the workspace's configurations and targets shall be
/// small.
enum class ErrorQuantity {
    Rms,           ///< their RMS
    Percentile95,  ///< what 95 % of them are below
    Max,           ///< the largest
};

/// Where accuracy matters, and what position errors result from there; 3 rows per target in m, one
/// block per configuration.
struct PositionErrors {
    Blocks by_parameters;  ///< make_prediction_blocks()
    /// By the joints, times their repeatability: varies from visit to visit. Empty: none is stated.
    Blocks by_joints;
    Blocks by_model;       ///< by the model error's motions of the flange, times their sizes
    double own_error = 0;  ///< model error that each coordinate of a target has by itself
};

/// Throws InputError as make_prediction_blocks().
PositionErrors make_position_errors(const Campaign& campaign, const RowMatrixXd& workspace,
                                    Index target = -1);

/// predict_accuracy() with the campaign's prior and known_within, and what the model error adds.
/// `by_noise` of the poses determines PredictedAccuracy::model_share, also for other poses that are
/// held.
PredictedAccuracy predict_accuracy(const PositionErrors& errors, const MatrixXd& M,
                                   const Campaign& campaign, const InformationByNoise& by_noise);

/// A position error whose size is not known yet, m.
struct ErrorRange {
    /// RMS: with model error and sizes as the campaign expects them; other quantities: the median.
    double expected = 0;
    double lower = 0;    ///< 5 % are below
    double upper = 0;    ///< 95 % are below
    double assured = 0;  ///< the share `assurance` is below
};

/// Range of the position error that results from the parameters, known within M^-1 (scaled; empty:
/// exactly) from poses with `by_noise`, from the model error, and from the joints' repeatability at
/// one visit. Draws are as in predict_total(), with scaled chi-squared for the RMS due to
/// parameters. Other quantities are those of 2048 robots: errors of their parameters, and of each
/// position by model and visit, are drawn from streams of `seed`. Throws InputError if M is not
/// positive definite, or for an assurance that is not above 0 and below 1.
ErrorRange predict_range(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                         const InformationByNoise& by_noise, ErrorQuantity quantity,
                         double assurance, std::uint64_t seed = 1);

/// What the expected RMS consists of, m; squares add up.
struct ErrorBudget {
    double noise = 0;          ///< parameters: by the sensor's noise (and the joints', measuring)
    double model = 0;          ///< parameters: by the model error at the poses measured
    double prior = 0;          ///< parameters: what poses leave of their prior
    double parameters = 0;     ///< these three together
    double left_over = 0;      ///< what the model cannot express, at the positions themselves
    double repeatability = 0;  ///< joints, at one visit
    double total = 0;
};

/// M is that of the whole plan (empty: parameters known exactly), `by_noise` that of poses to
/// measure.
ErrorBudget make_budget(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                        const InformationByNoise& by_noise);

/// A missing pose.
struct DropOut {
    Index pose = 0;
    double rms = 0;  ///< m, by the parameters, without it; infinity: some are not identified
};

/// Each of the poses missing alone; `poses` are their blocks, part of M.
std::vector<DropOut> drop_each(const Blocks& prediction, const Blocks& poses, const MatrixXd& M);

/// Drops `count` poses one after another, always the one that then hurts most (greedy). Fewer if
/// parameters become unidentified or no pose is left. They are subtracted from M, except a last one
/// with infinite rms.
std::vector<DropOut> drop_worst(const Blocks& prediction, const Blocks& poses, Index count,
                                MatrixXd& M);

}  // namespace posewise
