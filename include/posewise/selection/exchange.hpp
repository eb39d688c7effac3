#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "posewise/core/progress.hpp"
#include "posewise/selection/choice.hpp"

namespace posewise {

/// What to choose (the problem, up to and including `least_distance`) and how hard to try.
struct SelectOptions {
    Criterion criterion = Criterion::D;
    Index pose_count = 0;  ///< K, must be stated
    /// Test poses of G and V; the caller keeps them alive. Null: the candidates themselves.
    const Blocks* test_poses = nullptr;
    /// Columns estimated along but of no interest (D becomes Ds). Not with G, V, O2 and O4.
    std::vector<Index> nuisance;
    /// What there is before measuring, as rows beside those of the candidates: blocks of poses
    /// already measured, and a root R of a prior's information R^T R (the identity, where the
    /// expected size of each parameter's error is its prior). Empty: none.
    RowMatrixXd held_rows;
    Index held_pose_count = 0;    ///< poses already measured; m of O1 is K more
    Index repeat_limit = 1;       ///< how often one candidate may be chosen
    std::vector<Index> excluded;  ///< candidates not to choose
    std::vector<Index> groups;    ///< label of each candidate's region or payload; empty: none
    Index group_limit = 0;        ///< most poses out of one group; 0: any number
    RowMatrixXd positions;        ///< candidates x joints; empty unless least_distance is used
    double least_distance = 0;    ///< Euclidean, between any two different poses chosen
    std::vector<std::string> column_names;  ///< for messages; empty: columns are numbered from 1

    /// Independent searches. 0: until ten of them agree on the best value, at most 100 (20 by E, G
    /// and O2 to O5), fewer (6 at least, or 4) where blocks of many rows and parameters make each
    /// take seconds.
    Index starts = 0;
    /// Perturbations of each start's plan without success until it ends; up to ten times as many
    /// where the poses have hardly more rows than there are parameters to tell beyond what is held.
    Index kicks = 6;
    /// Candidates searched; all are looked at in the last sweeps. 0: from 800 for large blocks to
    /// 5000 for small ones.
    Index shortlist = 0;
    /// Seconds of a CPU, about, to spend on proving by branch and bound that no choice is better;
    /// counted in operations, so that results do not depend on the machine. 0: none. Empty: 0.7,
    /// but a tenth where that shows that they would not do; again for what better starts find.
    std::optional<double> proof{};
    double gap = 1e-5;       ///< relative gap of the information function to end the relaxation at
    std::uint64_t seed = 1;  ///< start i draws from stream (seed, i)
    StopSignal stop{};       ///< ends the search with the best so far
    ProgressCallback progress{};  ///< of the starts; agreeing ones end them before the total
};

/// The best K of the candidates, and a proven bound. The continuous relaxation gives the bound, a
/// shortlist and the starts; block exchange with kicks (iterated local search) improves each start,
/// over OpenMP threads whose number does not matter; what they end at is crossed (memetic search);
/// last sweeps over all candidates end where no exchange improves (for O5 and parameters of
/// interest: none of those estimated to be good, but all in the last sweeps). Where branch and
/// bound rules out or tries all others in time, the plan is optimal. Value, rank and what is
/// compared at the end are those of the stacked rows (evaluate_rows()); the bound is above the
/// truth by its rounding at least. Ends NotIdentifiable if all candidates together do not identify
/// the parameters (naming the columns of the unseen directions), if K of them have fewer rows than
/// there are parameters to tell, or if no start found K poses that do. Throws InputError if K is
/// not in [1, candidates x repeats], if the limits leave fewer than K, or for options that
/// contradict the candidates.
Choice select_poses(const Blocks& candidates, const SelectOptions& options);

}  // namespace posewise
