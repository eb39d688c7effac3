#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/progress.hpp"
#include "posewise/criteria/criterion.hpp"

namespace posewise {

/// Proof of a choice's bound. verify() needs nothing else, so it works without an optimiser. Any
/// positive definite M proves some bound; the optimum of the continuous relaxation proves the best
/// one.
struct Certificate {
    MatrixXd M;
    double sharpness =
        std::numeric_limits<double>::infinity();  ///< sharpness of smoothing at M; infinity: none
};

/// A choice of poses out of candidates.
struct Choice {
    std::vector<Index> poses;  ///< candidate indices, ascending; one listed twice is measured twice
    Criterion criterion = Criterion::D;
    double value = -std::numeric_limits<double>::infinity();
    /// No K candidates have a larger value. Infinity: nothing is proven.
    double bound = std::numeric_limits<double>::infinity();
    /// Proven share of the best possible value, in [0, 1]. D: exp((value - bound) / parameters),
    /// others: value / bound.
    double efficiency = 0;
    Certificate certificate;
    std::uint64_t seed = 0;
    Index starts = 0;          ///< independent ones that ended; a stop cuts others short
    Index starts_at_best = 0;  ///< how many of them ended at this value
    /// Choices that no bound ruled out and that were tried; if the choice is optimal, all such. 0:
    /// branch and bound did not get that far.
    Index tried = 0;
    Ending ending = Ending::NotRun;
    /// If the ending is NotIdentifiable: the undetermined directions and what would determine them,
    /// as a sentence; then there are no poses.
    std::string undetermined;
};

/// Returns the choice; throws InputError with the reason if the candidates do not identify the
/// parameters.
Choice determined(Choice choice);

/// What to choose (the problem, up to and including `least_distance`) and how hard to search.
struct SelectOptions {
    Criterion criterion = Criterion::D;
    Index pose_count = 0;  ///< K, must be stated
    /// Test poses for G and V; the caller keeps them alive. Null: the candidates themselves.
    const Blocks* test_poses = nullptr;
    /// Columns that are estimated, too, but of no interest (D becomes Ds). Not with G, V, O2 and
    /// O4.
    std::vector<Index> nuisance;
    /// Information known before measuring, as rows in addition to the candidates': blocks of poses
    /// already measured, and a root R of a prior's information R^T R (the identity, if each
    /// parameter's expected error is its prior). Empty: none.
    RowMatrixXd held_rows;
    Index held_pose_count = 0;    ///< poses already measured; they count in the m of O1
    Index repeat_limit = 1;       ///< how often one candidate may be chosen
    std::vector<Index> excluded;  ///< candidates not to choose
    std::vector<Index> groups;    ///< label of each candidate's region or payload; empty: none
    Index group_limit = 0;        ///< most poses from one group; 0: any number
    RowMatrixXd positions;        ///< candidates x joints; empty unless least_distance is used
    double least_distance = 0;    ///< Euclidean, between any two different poses chosen
    std::vector<std::string> column_names;  ///< for messages; empty: columns are numbered from 1

    /// Independent searches. 0: until ten of them agree on the best value, at most 100 (20 for E, G
    /// and O2 to O5); fewer (at least 6, or 4) if each takes seconds because blocks have many rows
    /// and parameters.
    Index starts = 0;
    /// A start ends after this many perturbations of its plan without success; up to ten times as
    /// many if the poses have hardly more rows than parameters to determine beyond what is held.
    Index kicks = 6;
    /// Candidates searched; the last sweeps examine all. 0: from 800 for large blocks to 5000 for
    /// small ones.
    Index shortlist = 0;
    /// CPU seconds, roughly, to spend on proving by branch and bound that no choice is better. They
    /// are counted in operations, so that results do not depend on the machine. 0: none. Empty:
    /// 0.7, but a tenth if that shows that they would not suffice; once more for what better starts
    /// find.
    std::optional<double> proof{};
    double gap = 1e-5;  ///< the relaxation ends at this relative gap of the information function
    std::uint64_t seed = 1;       ///< start i draws from stream (seed, i)
    StopSignal stop{};            ///< ends the search with the best so far
    ProgressCallback progress{};  ///< counts starts; agreeing ones end them before the total
};

/// Chooses the best K candidates, with a proven bound. The continuous relaxation gives the bound, a
/// shortlist and the starts. Block exchange with kicks (iterated local search) improves each start,
/// on OpenMP threads whose number does not matter; the results are crossed (memetic search). Last
/// sweeps over all candidates end when no exchange improves. For O5 and with nuisance columns, only
/// exchanges that are estimated to be good are evaluated before these sweeps. The plan is optimal
/// if branch and bound rules out or tries all others in time. Value, rank and final comparison are
/// those of the stacked rows (evaluate_rows()); the bound is above the truth by at least its
/// rounding. Ends NotIdentifiable if all candidates together do not identify the parameters (naming
/// the columns of the unseen directions), if K of them have fewer rows than parameters to
/// determine, or if no start found K poses that do. Throws InputError if K is not in [1, candidates
/// x repeats], if the limits leave fewer than K, or for options that contradict the candidates.
Choice select_poses(const Blocks& candidates, const SelectOptions& options);

}  // namespace posewise
