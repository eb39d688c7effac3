#pragma once

#include "neighbourhood.hpp"

namespace posewise {

/// Exchanges for any objective: candidates in the order of what the gradient promises at most, each
/// evaluated until none left can be better. The promise holds for all criteria but O4, whose
/// exchanges are all tried.
class Screening final : public Neighbourhood {
  public:
    Screening(const Objective& objective, const Blocks& candidates, const Shortlist& shortlist);

    void move_to(const MatrixXd& M) override;
    Index best_replacement(Index removed, double value, const Occupancy& occupancy) override;

  private:
    /// Whether the objective of M may exceed `value`, by a test cheaper than evaluating it.
    bool may_exceed(const MatrixXd& M, double value) const;

    const Objective& objective_;
    const Blocks& candidates_;
    const Shortlist& shortlist_;
    bool screens_;
    MatrixXd M_;
    MatrixXd slope_;
    VectorXd sensitivity_;      // of the shortlist's members
    std::vector<Index> order_;  // positions in the shortlist, most sensitive first
};

}  // namespace posewise
