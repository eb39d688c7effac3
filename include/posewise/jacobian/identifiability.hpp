#pragma once

#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"

namespace posewise {

/// `coefficient * name`, in SI units: m or rad of the named parameter per m or rad of the dropped.
struct ParameterTerm {
    Index parameter = 0;
    double coefficient = 0;
};

/// A parameter that measurements cannot tell apart from the kept ones: a unit error of it looks
/// exactly like `absorbed_by` (empty: it moves nothing at all).
struct DroppedParameter {
    Index parameter = 0;
    std::vector<ParameterTerm> absorbed_by;
};

/// Which columns of a Jacobian are independent.
struct Identifiability {
    std::vector<Index> kept;                ///< in the columns' order
    std::vector<DroppedParameter> dropped;  ///< in the order they were met
    /// Least residual of a kept column and largest of a dropped one (columns have norm 1): the gap
    /// the decision rests on.
    double least_kept_residual = 1;
    double largest_dropped_residual = 0;
};

/// A column is a combination of others if less than this part of it is outside their span.
inline constexpr double least_residual = 1e-8;

/// Walks the columns of J in `priority` order (a permutation of them) and keeps one if its
/// residual on the kept ones exceeds a part of its norm (twice orthogonalised Gram-Schmidt): 1e-2
/// in the first walk, then 1e-4 and so on down to `tolerance`, so that a column which is nearly a
/// combination of others (axes that are parallel but for the rounding of their angles) does not
/// displace one that is not. What is left of a column must be its share of the largest column
/// (empty: 1e-12), too; one that is less as a whole moves nothing. Throws InputError if it is
/// stopped.
Identifiability find_independent_columns(const MatrixXd& J, const std::vector<Index>& priority,
                                         double tolerance = least_residual,
                                         const StopSignal& stop = {},
                                         const VectorXd& least_shares = {});

/// What a campaign can identify at best: its Jacobian at nominal parameters over random
/// configurations within the limits (as many as twice the parameters). Priority: base, sensor,
/// joint offsets, translations, other rotations, error terms, each from base to flange. The test is
/// at nominal values because off nominal a lost rank is only nearly lost, and in expected errors: a
/// direction in which those of the geometry move the readings by less than 1e-4 of what the
/// strongest moves is lost, too, as where numbers of the robot are rounded. A probe that touches
/// planes touches one a pose, if it can reach them all. Targets and base that the campaign does not
/// state are put at generic places. Throws InputError if it is stopped.
Identifiability find_identifiable(const Campaign& campaign, const StopSignal& stop = {});

/// Whether the tolerance has no part in what was kept: a factor of 1000 at least between the least
/// residual of a kept column and the largest of a dropped one.
bool has_clear_gap(const Identifiability& found);

/// The parameters that what find_identifiable() kept tells apart worst, `count` at most: those with
/// the largest shares in the weakest direction of the kept columns (of norm 1), largest first.
std::vector<Index> weakest_kept(const Campaign& campaign, const Identifiability& found,
                                Index count = 4);

/// The same robot with only the kept error parameters.
Chain keep_parameters(const Chain& chain, const std::vector<std::string>& names);

/// The same robot without the errors that only move it as a whole, as that of the first joint's
/// zero does: where all is found in its base frame they mean nothing.
Chain without_errors_of_base(const Chain& chain);

/// The irreducible form: with complete errors, then only those that are identifiable. Throws
/// InputError if it is stopped.
Chain irreducible_model(const Campaign& campaign, const StopSignal& stop = {});

/// The same with the errors of the joints' zeros alone (and its error terms): of them those that
/// can be told from base and targets. Throws InputError if it is stopped.
Chain irreducible_offsets(const Campaign& campaign, const StopSignal& stop = {});

/// Smallest number of generic configurations that identifies all that is identifiable; where the
/// robot's errors have priors, base and sensor. Throws InputError if it is stopped.
Index least_pose_count(const Campaign& campaign, const StopSignal& stop = {});

/// A direction in parameter space, in units of each parameter's expected error (scaled), that the
/// poses at hand hardly see.
struct WeakDirection {
    double singular_value = 0;  ///< of the whitened, scaled stacked Jacobian
    /// Its largest components, by decreasing magnitude; the direction has norm 1 and its largest
    /// component is positive.
    std::vector<ParameterTerm> terms;
};

/// The `count` weakest directions of stacked blocks (rows x parameters), weakest first.
std::vector<WeakDirection> weakest_directions(const MatrixXd& stacked, Index count,
                                              Index terms_each = 4);

}  // namespace posewise
