#pragma once

#include "core/inverse_root.hpp"
#include "lanes.hpp"

namespace posewise::detail {

/// trace((M + B_i^T B_i)^(-1/2)), which is 1 / O5, of eight candidates at a time: tridiagonalised
/// by reflections [Householder 1958], then by traces of inverses.
class RootTraces {
  public:
    RootTraces(const MatrixXd& M, const InverseRoot& root);

    /// Of the candidates of each group of these blocks.
    std::vector<Lane> compute(const LaneBlocks& blocks) const;

  private:
    Index size_;
    std::vector<double> M_;  // the lower triangle by rows
    InverseRoot root_;       // padded to whole tiles
};

}  // namespace posewise::detail
