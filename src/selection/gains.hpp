#pragma once

#include "lanes.hpp"

namespace posewise::detail {

/// Candidates to exchange with, prepared once and read by all starts.
struct Shortlist {
    std::vector<Index> members;
    LaneBlocks lanes;   ///< empty (rows 0) where the blocks are too high for a kernel
    RoughBlocks rough;  ///< the same
};
Shortlist make_shortlist(const Blocks& candidates, std::vector<Index> members);

/// What exchanges of one pose do to the determinant of M, or to trace(C M^-1), by block updates of
/// the inverse, eight candidates at a time. With W = (M - B^T B)^-1 after removing block B, W =
/// M^-1 + P P^T where P = M^-1 B^T U^-T and U U^T = I - B M^-1 B^T. Candidate i multiplies the
/// determinant by det(I + B_i W B_i^T) and lowers trace(C W) by trace((I + B_i W B_i^T)^-1 B_i W C
/// W B_i^T); what does not depend on B is cached.
class Gains {
  public:
    Gains(const Blocks& candidates, const Shortlist& shortlist);

    /// From now on about M (positive definite) and C = C_root C_root^T; an empty C_root asks for
    /// determinants.
    void move_to(const MatrixXd& M, const MatrixXd& C_root);
    /// The same about M, which differs by one exchange: `added` for the block that was removed
    /// last. Updates what is cached by low rank, a fraction of move_to()'s work for many
    /// parameters.
    void exchange(const Eigen::Ref<const RowMatrixXd>& added, const MatrixXd& M);

    /// By M's slope, trace(B_i slope B_i^T): that of log det M, or of -trace(C M^-1).
    double sensitivity(Index position) const { return sensitivity_[position]; }
    /// That of the removed block. Only after remove().
    double removed_sensitivity() const { return removed_sensitivity_; }

    /// Takes a block out. False where what is left is singular.
    bool remove(const Eigen::Ref<const RowMatrixXd>& block);
    /// By how much the block that was removed lowered trace(C W), or its factor of the determinant,
    /// but for rounding, so that nothing as good is below it. Only after remove().
    double least_gain() const { return least_gain_; }
    /// The same above rounding: more than this is better for sure.
    double certain_gain() const { return certain_gain_; }
    /// For the shortlisted positions asked for: the factor of the determinant, or by how much
    /// trace(C W) falls. Only after remove().
    VectorXd compute(const std::vector<Index>& positions);
    /// Of all shortlisted positions, in single precision where there are lanes; not a number where
    /// that does not do.
    VectorXd compute_roughly();

    struct Largest {
        Index position = -1;  ///< none: all are below least_gain()
        double gain = 0;
    };
    /// The largest of the gains that compute() finds for these positions, at least one; the first
    /// of equal ones. Single precision sorts out those that are more than a thousandth below, and
    /// is believed where the others differ from it by less than a quarter of that.
    Largest find_largest(const std::vector<Index>& positions);

    /// The shortlisted positions with which the variance, trace(B0 M^-1 B0^T), of each of these
    /// test poses may be below `most` in the removed block's place. Only after remove().
    std::vector<Index> keeping_below(double most, const std::vector<RowMatrixXd>& test_poses);

  private:
    bool is_determinant() const { return C_root_.size() == 0; }
    /// What follows from the grams: sensitivities, and the grams in single precision.
    void follow_grams();
    Largest largest_of(const std::vector<Index>& positions, const VectorXd& gains) const;
    MatrixXd apply_W(const MatrixXd& X) const;
    /// WK: [W, W C W], each with zero columns up to whole_columns(); W alone for determinants.
    double compute_plainly(Index position, const RowMatrixXd& WK) const;

    const Blocks& candidates_;
    const Shortlist& shortlist_;
    MatrixXd C_root_;
    RowMatrixXd inverse_;  // M^-1
    RowMatrixXd slope_;    // M^-1 C M^-1
    LaneGrams G_;          // B_i M^-1 B_i^T
    LaneGrams H_;          // B_i M^-1 C M^-1 B_i^T
    RoughGrams rough_G_;
    RoughGrams rough_H_;
    VectorXd sensitivity_;  // of the shortlist's members
    double removed_sensitivity_ = 0;
    double least_gain_ = 0;
    double certain_gain_ = 0;
    MatrixXd P_;
    MatrixXd Q_;  // W C W - M^-1 C M^-1 = P Q^T + Q P^T
    bool is_removal_accurate_ = false;
    int updates_ = 0;          // since all was computed anew
    std::vector<char> asked_;  // groups of candidates
    std::vector<Lane> gains_;
    std::vector<RoughLane> rough_gains_;
};

}  // namespace posewise::detail
