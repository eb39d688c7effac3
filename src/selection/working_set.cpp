#include "working_set.hpp"

#include "../core/parallel.hpp"

namespace posewise::detail {

void WorkingSet::add(const std::vector<Index>& candidates) {
    const Index L = candidates_->parameter_count();
    const Index first = size();
    members_.insert(members_.end(), candidates.begin(), candidates.end());
    packed_.conservativeResize(size(), L * (L + 1) / 2);
    const auto pack = [&](Index m) {
        const auto block = (*candidates_)[members_[static_cast<std::size_t>(m)]];
        const MatrixXd H = block.transpose() * block;
        Index k = 0;
        for (Index i = 0; i < L; ++i) {
            packed_.row(m).segment(k, L - i) = H.col(i).tail(L - i).transpose();
            k += L - i;
        }
    };
    for_each_range(size() - first, 64, [&](Index begin, Index end) {
        for (Index m = begin; m < end; ++m) pack(first + m);
    });
}

MatrixXd WorkingSet::weighted_information(const VectorXd& weights) const {
    const Index L = candidates_->parameter_count();
    const VectorXd sum = packed_.transpose() * weights;
    MatrixXd M(L, L);
    Index k = 0;
    for (Index i = 0; i < L; ++i) {
        M.col(i).tail(L - i) = sum.segment(k, L - i);
        k += L - i;
    }
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

VectorXd WorkingSet::sensitivities(const MatrixXd& Z) const {
    const Index L = candidates_->parameter_count();
    VectorXd packed(L * (L + 1) / 2);
    Index k = 0;
    for (Index i = 0; i < L; ++i) {
        packed.segment(k, L - i) = 2 * Z.col(i).tail(L - i);
        packed[k] = Z(i, i);
        k += L - i;
    }
    return packed_ * packed;
}

}  // namespace posewise::detail
