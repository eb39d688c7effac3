#pragma once

#include "criteria/objective.hpp"
#include "lanes.hpp"

namespace posewise::detail {

/// Tells which of many choices cannot be as good as one that is known, by a factorisation M = L D
/// L^T of their information matrices, eight at a time. D and O1 are the pivots' product; A, V and G
/// are traces of the inverse (G that of a mean over its test poses, which is no less than G); E,
/// O3, O2 and O4 exceed a value only if M less a multiple of the identity has positive pivots; O5
/// is the inverse of the nuclear norm of R = D^-1/2 L^-1, which is no less than trace(Q^T R) for
/// any orthogonal Q (that of the good choice's R), nor than its moments say. M is raised by what
/// rounding may take from it first: no criterion is less for it, however near M is to singular.
class ChoiceFilter {
  public:
    /// M: information of a good choice, where test poses and the largest eigenvalue are looked for.
    ChoiceFilter(const Objective& objective, const MatrixXd& M);

    /// Numbers of a packed matrix: its lower triangle by rows, nuisance columns first, then a sum
    /// along the direction of the largest eigenvalue.
    Index packed_size() const { return packed_size_; }
    VectorXd pack(const MatrixXd& M) const;

    /// Eight packed matrices, and memory to work in.
    struct Batch {
        std::vector<Lane> M;
        std::vector<Lane> root;
        Index count = 0;
    };
    Batch make_batch() const;
    /// Adds the sum of two packed matrices.
    void add(const double* a, const double* b, Batch& batch) const;
    /// For each matrix of the batch, whether it may have at least `value`; overwrites them.
    std::array<bool, lane_width> may_reach(double value, Batch& batch) const;

  private:
    enum class Test { Determinant, Trace, Nuclear, Shift };

    void raise(Batch& batch) const;
    void subtract_shift(double value, Batch& batch) const;
    void invert_pivots(Batch& batch) const;
    bool may_reach(double value, double sum) const;

    const Objective& objective_;
    Test test_;
    std::vector<Index> order_;  // of the columns, nuisance first
    Index nuisance_;
    Index packed_size_;
    VectorXd strongest_;         // direction
    std::vector<double> polar_;  // packed, of the good choice, for O5
    std::vector<double> root_;   // packed lower triangle T, the trace is that of T^T M^-1 T
};

}  // namespace posewise::detail
