#pragma once

#include <optional>
#include <span>

#include "criteria/objective.hpp"
#include "gains.hpp"
#include "limits.hpp"
#include "posewise/core/progress.hpp"
#include "rayleigh_ritz.hpp"
#include "root_traces.hpp"

namespace posewise::detail {

/// Whether the gains of exchanges are cheap to know exactly: by D, O1, A and V.
bool has_exact_gains(const Objective& objective);

/// Finds the best candidate to take a removed pose's place. One for each search: it keeps what
/// depends on the current plan. What is cheap to know about an exchange depends on the criterion:
/// the gains of block updates are exact for D, O1, A and V; for G, those of the test pose that is
/// worst at present are a ceiling; for O5 and parameters of interest the objective's tangent in
/// M^-1, an estimate; for E, O3, O2 and O4 Rayleigh and Ritz rule out most exchanges.
class Neighbourhood {
  public:
    /// Where gains are estimates, at most `most_evaluated` exchanges are evaluated at a time.
    Neighbourhood(const Objective& objective, const Blocks& candidates, const Shortlist& shortlist,
                  Index most_evaluated, const StopSignal& stop);

    /// The plan's information matrix is now M (positive definite).
    void move_to(const MatrixXd& M);
    /// M with the `removed` pose's information replaced by the `added` one's.
    MatrixXd exchanged(Index removed, Index added) const;
    /// As move_to() after the last pose asked about gave way to the `added` one, which makes it M.
    void exchange(Index added, const MatrixXd& M);

    struct Replacement {
        Index position = -1;
        bool is_certain = false;  ///< that it exceeds `value` by more than rounding
    };
    /// Position in the shortlist of the allowed candidate that makes the objective of (M -
    /// B^T B of `removed` + its own) largest; -1 if none is found that exceeds `value`, the
    /// objective of M (which exact gains do not look at).
    Replacement best_replacement(Index removed, double value, const Occupancy& occupancy);

    /// Positions in the shortlist, ascending, of at most `count` candidates: those that come
    /// nearest to making the objective larger in the place of one of these poses, M's. Only where
    /// gains are exact.
    std::vector<Index> nearest(const std::vector<Index>& poses, Index count);

  private:
    enum class Ranking { Exact, Witnesses, Estimate };
    struct Ranked {
        Index position;
        double gain;
        bool operator<(const Ranked& other) const {
            return gain != other.gain ? gain < other.gain : position > other.position;
        }
    };

    MatrixXd make_C_root(const MatrixXd& M) const;
    /// Exchanges that concavity does not rule out, in the order of the shortlist.
    std::vector<Index> promising(Index removed, const Occupancy& occupancy) const;
    /// As a heap, the largest gain first.
    std::vector<Ranked> rank(const std::vector<Index>& positions);
    /// The objective with each of these positions in the removed candidate's place, in order. Of O5
    /// nine digits, and only of what exceeds `value`; the others do not.
    std::vector<double> evaluate_exchanges(const MatrixXd& remaining, double value,
                                           std::span<const Index> positions);
    std::vector<double> evaluate_in_lanes(const MatrixXd& remaining, double value,
                                          std::span<const Index> positions);
    Replacement best_by_gains(Index removed, double value, const Occupancy& occupancy);
    Index best_by_witnesses(Index removed, double value, const Occupancy& occupancy);
    Index best_by_eigenvalues(Index removed, double value, const Occupancy& occupancy);
    bool is_allowed(Index position, Index removed, const Occupancy& occupancy) const;
    /// G of M; 0 where it is not above `value`.
    double worst_prediction(const MatrixXd& M, double value);
    /// Whether the worst of the worst test poses at present is predicted well enough.
    bool passes_witnesses(const MatrixXd& M, double value);

    const Objective& objective_;
    const Blocks& candidates_;
    const Shortlist& shortlist_;
    Index most_evaluated_;
    const StopSignal& stop_;
    Ranking ranking_;
    MatrixXd M_;
    Gains gains_;
    MatrixXd C_root_;                     // where it does not depend on M
    std::vector<RowMatrixXd> witnesses_;  // for G
    InverseRoot root_;                    // for O5, of values from `root_from_` on
    double root_from_ = 0;
    double largest_block_ = 0;          // trace(B^T B)
    std::optional<RayleighRitz> ritz_;  // for E, O3, O2 and O4
};

}  // namespace posewise::detail
