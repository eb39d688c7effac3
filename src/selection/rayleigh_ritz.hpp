#pragma once

#include <vector>

#include "../criteria/objective.hpp"

namespace posewise::detail {

/// Rules out exchanges for criteria of extreme eigenvalues (E, O3, O2, O4). With U the eigenvectors
/// of M's least eigenvalues and v that of its largest, every M* has
///     lambda_min(M*) <= lambda_min(U^T M* U),   lambda_max(M*) >= v^T M* v;
/// for M* one exchange from M both are cheap, and the first is nearly an equality.
class RayleighRitz {
  public:
    RayleighRitz(const Objective& objective, const Blocks& candidates,
                 const std::vector<Index>& members);

    void move_to(const MatrixXd& M);
    void remove(Index candidate);
    /// Whether the member at this position may make the objective larger than `value` in the
    /// removed candidate's place.
    bool may_exceed(Index position, double value) const;

  private:
    static constexpr Index most_vectors = 8;
    using Compressed =
        Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, most_vectors, most_vectors>;
    struct Compression {
        Compressed weak;    // U^T B^T B U
        double strong = 0;  // |B v|^2
    };

    Compression compress(Index candidate) const;
    bool has_condition() const;

    const Objective& objective_;
    const Blocks& candidates_;
    const std::vector<Index>& members_;
    MatrixXd U_;
    VectorXd v_;
    std::vector<Compression> compressions_;
    Compression whole_;      // of M
    Compression remaining_;  // of M without the removed candidate
};

}  // namespace posewise::detail
