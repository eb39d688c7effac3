#include "working_set.hpp"

#include "core/parallel.hpp"

namespace posewise::detail {

WorkingSet::WorkingSet(const WorkingSet& all, const std::vector<Index>& places)
    : candidates_(all.candidates_), packed_(all.packed_(places, Eigen::all)) {
    for (const Index place : places) {
        members_.push_back(all.members_[static_cast<std::size_t>(place)]);
    }
}

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
    // Most weights are zero after a few steps.
    std::vector<Index> used;
    for (Index m = 0; m < weights.size(); ++m) {
        if (weights[m] != 0) used.push_back(m);
    }
    VectorXd sum = VectorXd::Zero(L * (L + 1) / 2);
    constexpr std::size_t rows = 4;  // at a time
    std::size_t at = 0;
    const auto row = [&](std::size_t k) {
        return weights[used[k]] * packed_.row(used[k]).transpose();
    };
    for (; at + rows <= used.size(); at += rows) {
        sum += row(at) + row(at + 1) + row(at + 2) + row(at + 3);
    }
    for (; at < used.size(); ++at) sum += row(at);
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
    VectorXd d(size());
    for_each_range(size(), 64, [&](Index begin, Index end) {
        d.segment(begin, end - begin).noalias() = packed_.middleRows(begin, end - begin) * packed;
    });
    return d;
}

}  // namespace posewise::detail
