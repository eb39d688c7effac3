#pragma once

#include <vector>

#include "criteria/objective.hpp"
#include "gains.hpp"

namespace posewise::detail {

/// Rules out exchanges for criteria of extreme eigenvalues (E, O3, O2, O4). With U the eigenvectors
/// of M's least eigenvalues and v that of its largest, every M* has
///     lambda_min(M*) <= lambda_min(U^T M* U),   lambda_max(M*) >= v^T M* v;
/// for M* one exchange from M both are cheap, eight candidates at a time, and the first is nearly
/// an equality. What they leave is factorised: M* - t I is definite if lambda_min(M*) exceeds t.
class RayleighRitz {
  public:
    RayleighRitz(const Objective& objective, const Blocks& candidates, const Shortlist& shortlist);

    void move_to(const MatrixXd& M);
    void remove(Index candidate);
    /// From now on about values larger than this one.
    void ask(double value);
    /// Whether the member at this position may make the objective larger in the removed
    /// candidate's place.
    bool may_exceed(Index position) const;
    /// Those of at most eight positions of which that still holds by the pivots of M with the
    /// exchange; `remaining` is M without the removed candidate.
    std::vector<Index> exceeding(const MatrixXd& remaining, const std::vector<Index>& positions);

  private:
    static constexpr Index vectors = 8;
    static constexpr Index weak_size = vectors * (vectors + 1) / 2;
    static constexpr Index size = weak_size + 1;
    /// Of one matrix: the lower triangle of U^T M U by rows, and v^T M v.
    using Compression = Eigen::Matrix<double, size, 1>;

    Compression compress(const Eigen::Ref<const RowMatrixXd>& block) const;
    void compress_members();
    /// What lambda_min must exceed where lambda_max is no less than this.
    double least_eigenvalue(double largest) const;

    const Objective& objective_;
    const Blocks& candidates_;
    const Shortlist& shortlist_;
    RowMatrixXd U_;  // parameters x 9: the weak eigenvectors, or zero, and v
    Compression whole_;
    Compression remaining_;           // of M without the removed candidate
    std::vector<Lane> compressions_;  // of the members
    double value_ = 0;
    std::vector<Lane> least_;   // eigenvalue needed with each member
    std::vector<Lane> pivots_;  // the least of each member's compression less what is needed
    std::vector<Lane> work_;    // eight triangles
};

}  // namespace posewise::detail
