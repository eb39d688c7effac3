#include "rayleigh_ritz.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "../core/decompositions.hpp"
#include "../criteria/information_function.hpp"

namespace posewise::detail {

RayleighRitz::RayleighRitz(const Objective& objective, const Blocks& candidates,
                           const std::vector<Index>& members)
    : objective_(objective),
      candidates_(candidates),
      members_(members),
      compressions_(members.size()) {}

bool RayleighRitz::has_condition() const {
    return objective_.criterion == Criterion::O2 || objective_.criterion == Criterion::O4;
}

RayleighRitz::Compression RayleighRitz::compress(Index candidate) const {
    const auto B = candidates_[candidate];
    const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, Eigen::Dynamic, most_vectors>
        BU = B * U_;
    return {BU.transpose() * BU, has_condition() ? (B * v_).squaredNorm() : 0};
}

void RayleighRitz::move_to(const MatrixXd& M) {
    const auto eigen = eigen_decomposition(M);
    const Index q = std::min(most_vectors, M.rows());
    U_ = eigen.eigenvectors().leftCols(q);
    v_ = eigen.eigenvectors().rightCols<1>();
    whole_ = {eigen.eigenvalues().head(q).asDiagonal(), eigen.eigenvalues()[M.rows() - 1]};
    for (std::size_t k = 0; k < members_.size(); ++k) compressions_[k] = compress(members_[k]);
}

void RayleighRitz::remove(Index candidate) {
    const Compression removed = compress(candidate);
    remaining_ = {whole_.weak - removed.weak, whole_.strong - removed.strong};
}

bool RayleighRitz::may_exceed(Index position, double value) const {
    if (!(value > 0)) return true;
    const Compression& added = compressions_[static_cast<std::size_t>(position)];
    const double largest = remaining_.strong + added.strong;
    const double least = objective_.criterion == Criterion::O2 ? value * value * largest
                         : objective_.criterion == Criterion::O4
                             ? value * std::sqrt(largest)
                             : information_of_value(objective_, value, U_.rows());
    Compressed shifted = remaining_.weak + added.weak;
    shifted.diagonal().array() -= least;
    if (!(shifted(0, 0) > 0)) return false;
    return Eigen::LLT<Eigen::Ref<Compressed>>(shifted).info() == Eigen::Success;
}

}  // namespace posewise::detail
