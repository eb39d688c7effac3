#pragma once

#include <Eigen/Cholesky>

#include "neighbourhood.hpp"

namespace posewise {

/// Exchanges by block updates of the inverse, eight candidates at a time, for D, O1, A and V. With
/// W = (M - B^T B)^-1 after removing block B, W = M^-1 + P P^T where P = W B^T U^-T and U U^T = I +
/// B W B^T. Candidate i multiplies the determinant by det(I + B_i W B_i^T) and lowers trace(C W) by
/// trace((I + B_i W B_i^T)^-1 B_i W C W B_i^T); what does not depend on B is cached.
class BlockUpdates final : public Neighbourhood {
  public:
    BlockUpdates(const Objective& objective, const Blocks& candidates, const Shortlist& shortlist);

    void move_to(const MatrixXd& M) override;
    Index best_replacement(Index removed, double value, const Occupancy& occupancy) override;

  private:
    bool is_determinant() const { return C_.size() == 0; }
    void compute_gains(const MatrixXd& P);

    const Blocks& candidates_;
    const Shortlist& shortlist_;
    MatrixXd C_;       // A and V are 1 / trace(C M^-1); empty for D and O1
    MatrixXd C_root_;  // C = C_root C_root^T
    MatrixXd M_;
    Eigen::LLT<MatrixXd> cholesky_;  // of M
    MatrixXd slope_;                 // M^-1, or M^-1 C M^-1: the gradient but for a factor
    LaneGrams G_;                    // B_i M^-1 B_i^T
    LaneGrams H_;                    // B_i M^-1 C M^-1 B_i^T
    VectorXd sensitivity_;           // trace(B_i slope B_i^T)
    std::vector<char> asked_;        // groups of candidates worth a look
    std::vector<Lane> gains_;
};

}  // namespace posewise
