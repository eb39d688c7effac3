#include "sensitivity.hpp"

#include <algorithm>
#include <numeric>

namespace posewise {

VectorXd sensitivities(const Blocks& candidates, const MatrixXd& Z) {
    VectorXd result(candidates.count());
#pragma omp parallel for schedule(static) if (candidates.count() > 1000)
    for (Index i = 0; i < candidates.count(); ++i) {
        const auto block = candidates[i];
        result[i] = (block * Z).cwiseProduct(block).sum();
    }
    return result;
}

std::vector<Index> largest_indices(const VectorXd& values, Index count) {
    std::vector<Index> order(static_cast<std::size_t>(values.size()));
    std::iota(order.begin(), order.end(), Index{0});
    std::partial_sort(order.begin(), order.begin() + count, order.end(), [&](Index a, Index b) {
        return values[a] != values[b] ? values[a] > values[b] : a < b;
    });
    order.resize(static_cast<std::size_t>(count));
    return order;
}

}  // namespace posewise
