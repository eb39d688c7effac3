#pragma once

#include "neighbourhood.hpp"

namespace posewise {

/// Exchanges for any objective: candidates in the order of what the gradient promises at most, each
/// evaluated, unless a cheaper test rules it out, until none left can be better. The promise holds
/// for all criteria but O4, whose exchanges are all tested.
class Screening final : public Neighbourhood {
  public:
    Screening(const Objective& objective, const Blocks& candidates, const Shortlist& shortlist,
              const std::function<bool()>& must_stop);

    void move_to(const MatrixXd& M) override;
    Index best_replacement(Index removed, double value, const Occupancy& occupancy) override;

  private:
    /// What is cheap to know about the objective of other matrices from that of M.
    void prepare_tests(const MatrixXd& M);
    /// Whether the objective of M may exceed `value`.
    bool may_exceed(const MatrixXd& M, double value) const;
    bool may_exceed_condition(const MatrixXd& M, double value) const;

    const Objective& objective_;
    const Blocks& candidates_;
    const Shortlist& shortlist_;
    const std::function<bool()>& must_stop_;
    bool screens_;
    MatrixXd M_;
    MatrixXd slope_;
    VectorXd sensitivity_;      // of the shortlist's members
    std::vector<Index> order_;  // positions in the shortlist, most sensitive first
    Blocks witnesses_;          // for G: the worst test poses at M
    VectorXd weakest_;          // for O2 and O4: eigenvectors of M
    VectorXd strongest_;
};

}  // namespace posewise
