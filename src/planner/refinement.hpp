#pragma once

#include <limits>

#include "criteria/objective.hpp"
#include "design_space.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::detail {

struct RefineOptions {
    Index round_limit = 30;  ///< rounds of sweep and joint step, for each sharpness
    /// Degrees of smoothing of criteria with kinks, rising; see Objective::sharpness.
    std::vector<double> sharpness{4, 16, 64, 256};
    Index kink_rounds = 2;        ///< sweeps without derivatives, for criteria with kinks
    double tolerance = 1e-10;     ///< relative gain of a round to stop at
    int evaluation_limit = 2000;  ///< of one run of an optimiser
    /// A value that is to be beaten: given up is what first steps do not bring near it. Infinity:
    /// nothing is. For smooth criteria.
    double worth = -std::numeric_limits<double>::infinity();
    /// Only these poses are moved, one at a time, in one sweep. Empty: all.
    std::vector<Index> moved{};
    StopSignal stop{};
};

struct Refinement {
    RowMatrixXd configurations;  ///< poses x joints, rad or m; feasible
    double value = -std::numeric_limits<double>::infinity();
    double start_value = -std::numeric_limits<double>::infinity();
    Ending ending = Ending::NotRun;
};

/// Moves the poses of a plan continuously to increase the objective: one pose at a time in a sweep,
/// then all together, by a gradient method; in rounds until nothing is gained. A step into the
/// infeasible is taken as far as it is feasible, and finished along the constraint without
/// derivatives. E, G, O2, O3 and O4 have kinks: smoothed by growing sharpness first, then finished
/// without derivatives on the criterion itself. Never worse than the start; one thread.
/// Throws InputError if the start is infeasible, does not fit the space or does not identify the
/// parameters.
Refinement refine_poses(const DesignSpace& space, const Objective& objective, const HeldPoses& held,
                        const RowMatrixXd& start, const RefineOptions& options = {});

}  // namespace posewise::detail
