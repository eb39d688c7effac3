#pragma once

#include "posewise/core/blocks.hpp"

namespace posewise::detail {

/// Some candidates with their B_i^T B_i, each packed into one row, so that weighted sums and
/// sensitivities are matrix-vector products.
class WorkingSet {
  public:
    explicit WorkingSet(const Blocks& candidates) : candidates_(&candidates) {}

    /// Some members of another set, in their order there.
    WorkingSet(const WorkingSet& all, const std::vector<Index>& places);

    void add(const std::vector<Index>& candidates);
    const std::vector<Index>& members() const { return members_; }
    Index size() const { return static_cast<Index>(members_.size()); }

    /// sum_i w_i B_i^T B_i over the members.
    MatrixXd weighted_information(const VectorXd& weights) const;
    /// trace(B_i Z B_i^T) of the members.
    VectorXd sensitivities(const MatrixXd& Z) const;

  private:
    const Blocks* candidates_;
    std::vector<Index> members_;
    RowMatrixXd packed_;  // members x parameters (parameters + 1) / 2
};

}  // namespace posewise::detail
