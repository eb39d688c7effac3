#pragma once

#include <string>
#include <vector>

#include "posewise/core/blocks.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// Identification Jacobian of one pose, sensor rows x parameter_count(campaign), in m per m and m
/// per rad. `motion` is scratch space that the caller keeps, so that a loop does not allocate.
void differentiate_pose(const Campaign& campaign, const Parameters& parameters,
                        const VectorXd& configuration, FlangeMotion& motion,
                        Eigen::Ref<RowMatrixXd> J_measured_parameters);

/// Stacked identification Jacobian in SI units, neither whitened nor scaled: one block per row of
/// `configurations` (m x joints). `repeats` (m x targets, from times_seen()): rows of a target with
/// 0 are left out, because it is not seen. Computed on OpenMP threads. Throws InputError for a
/// configuration of the wrong size or not finite, or for repeats of another shape or below 0.
Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations, const RowMatrixXd& repeats);
/// As above with all targets seen.
Blocks make_plain_blocks(const Campaign& campaign, const Parameters& parameters,
                         const RowMatrixXd& configurations);

/// Derivative of all targets' world positions, whatever is measured of them, in SI units: blocks
/// with 3 rows per target. Throws InputError as make_plain_blocks() does.
Blocks make_position_blocks(const Campaign& campaign, const Parameters& parameters,
                            const RowMatrixXd& configurations);

/// make_plain_blocks() scaled by parameter_scale() and whitened by the noise of means (sensor,
/// joints, model) over `repeats` samples of each target (m x targets): without units, ready for
/// criteria and selection. A pose has at most 6 rows and one for each of the sensor's unknowns;
/// more readings are combined into these, with the same information.
Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, const RowMatrixXd& repeats);
/// As above with all targets seen equally often.
Blocks make_blocks(const Campaign& campaign, const Parameters& parameters,
                   const RowMatrixXd& configurations, double repeats = 1);

/// `coefficient * name`, in SI units: m or rad of the named parameter per m or rad of the dropped
/// one.
struct ParameterTerm {
    Index parameter = 0;
    double coefficient = 0;
};

/// A parameter that measurements cannot tell apart from the kept ones: a unit error looks exactly
/// like `absorbed_by` (empty: it moves nothing at all).
struct DroppedParameter {
    Index parameter = 0;
    std::vector<ParameterTerm> absorbed_by;
};

/// Which columns of a Jacobian are independent.
struct Identifiability {
    std::vector<Index> kept;                ///< in column order
    std::vector<DroppedParameter> dropped;  ///< in the order they were examined
    /// The gap that the decision rests on: least residual of a kept column, largest of a dropped
    /// one (columns have norm 1).
    double least_kept_residual = 1;
    double largest_dropped_residual = 0;
};

/// A column depends on others if less than this share of it is outside their span.
inline constexpr double least_residual = 1e-8;

/// Walks the columns of J in `priority` order (a permutation of them) and keeps those whose
/// residual on the kept ones exceeds a share of their norm (Gram-Schmidt, orthogonalised twice).
/// The share is 1e-2 in the first walk, then 1e-4 and so on down to `tolerance`. A column that
/// nearly depends on others (axes parallel but for rounded angles) then does not displace an
/// independent one. The residual must also exceed the column's `least_shares` (empty: 1e-12) of the
/// largest column; a column that is smaller as a whole counts as moving nothing. Throws InputError
/// if it is stopped.
Identifiability find_independent_columns(const MatrixXd& J, const std::vector<Index>& priority,
                                         double tolerance = least_residual,
                                         const StopSignal& stop = {},
                                         const VectorXd& least_shares = {});

/// What a campaign can identify at best, from its Jacobian at nominal parameters over random
/// configurations within the limits (twice as many as parameters). Priority: base, sensor, joint
/// offsets, translations, other rotations, error terms, each from base to flange. The test uses
/// nominal values, because elsewhere a lost rank is only nearly lost. It uses expected errors: a
/// direction in which geometric errors move the readings less than 1e-4 of the strongest is lost,
/// too, as with rounded numbers of the robot. A probe on planes touches one plane per pose, if it
/// can reach them all. Targets and base that the campaign does not state are put at generic places.
/// Throws InputError if it is stopped.
Identifiability find_identifiable(const Campaign& campaign, const StopSignal& stop = {});

/// Whether the tolerance did not matter for what was kept: the least residual of a kept column is
/// at least 1000 times the largest of a dropped one.
bool has_clear_gap(const Identifiability& found);

/// The kept parameters that are told apart worst, at most `count`: those with the largest shares in
/// the weakest direction of the kept columns (of norm 1), largest first. `found` is
/// find_identifiable().
std::vector<Index> weakest_kept(const Campaign& campaign, const Identifiability& found,
                                Index count = 4);

/// The robot with only the named error parameters.
Chain keep_parameters(const Chain& chain, const std::vector<std::string>& names);

/// The campaign with only these errors of its robot: names of parameters, and words of classes,
/// "class:offsets" (offsets, lengths, angles, gravity, harmonics, tilts, gains, terms). All others
/// are zero. Throws InputError for a name that is none of the robot's errors, or a class without
/// any.
Campaign with_free_errors(const Campaign& campaign, const std::vector<std::string>& errors);

/// The robot without errors that only move it as a whole, like the first joint's zero. They mean
/// nothing where everything is found in its base frame.
Chain without_errors_of_base(const Chain& chain);

/// The irreducible model: complete errors, reduced to the identifiable ones. Throws InputError if
/// it is stopped.
Chain irreducible_model(const Campaign& campaign, const StopSignal& stop = {});

/// The errors of the joints' zeros alone (and the robot's error terms), reduced to those that can
/// be told apart from base and targets. Throws InputError if it is stopped.
Chain irreducible_offsets(const Campaign& campaign, const StopSignal& stop = {});

/// Smallest number of generic configurations that identifies everything identifiable; only base and
/// sensor if the robot's errors have priors. Throws InputError if it is stopped.
Index least_pose_count(const Campaign& campaign, const StopSignal& stop = {});

/// A direction in parameter space, in units of each parameter's expected error (scaled), that the
/// poses at hand hardly see.
struct WeakDirection {
    double singular_value = 0;  ///< in the whitened, scaled stacked Jacobian
    /// Its largest components, by decreasing magnitude. The direction has norm 1 and its largest
    /// component is positive.
    std::vector<ParameterTerm> terms;
};

/// The `count` weakest directions of stacked blocks (rows x parameters), weakest first.
std::vector<WeakDirection> weakest_directions(const MatrixXd& stacked, Index count,
                                              Index terms_each = 4);

/// What a campaign file may declare as known, in the words of its keys `known`.
struct KnownAxes {
    std::vector<std::string> base;     ///< x .. rz
    std::vector<std::string> targets;  ///< x, y, z, for all targets
};

/// Unknowns of base and sensor that no number of poses determines, such as the heights of base and
/// targets for a robot with all axes parallel.
struct Unknowable {
    std::vector<std::string> parameters;  ///< by name; empty: nothing
    /// Each entry alone suffices: known axes of the base, of the targets or, where neither does, of
    /// both.
    std::vector<KnownAxes> cures;
};

/// Takes the robot as known. Finds nothing if an earlier calibration is the campaign's prior.
/// Throws InputError if it is stopped.
Unknowable find_unknowable(const Campaign& campaign, const StopSignal& stop = {});

/// What to declare: "known: [z], keys base.known or sensor.targets.known".
std::string describe_cures(const Unknowable& unknowable, const Campaign& campaign);

/// Throws InputError, with what to declare, if something is unknowable.
void check_knowable(const Campaign& campaign, const StopSignal& stop = {});

}  // namespace posewise
