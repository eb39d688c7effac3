#include "common_rows.hpp"

#include <algorithm>

#include "core/decompositions.hpp"
#include "core/parallel.hpp"

namespace posewise::detail {
namespace {

constexpr Index sample_size = 30;           // blocks, to see whether there is anything
constexpr double unit_rounding = 1e-12;     // of unit vectors
constexpr double least_independent = 1e-6;  // of a row, beside those before it
constexpr Index most_copied = 100'000'000;  // numbers

/// Of the row space of one block: B^T = Q R.
class RowSpace {
  public:
    explicit RowSpace(const Eigen::Ref<const RowMatrixXd>& block)
        : factors_(block.transpose()), rows_(block.rows()), columns_(block.cols()) {}

    bool is_independent() const {
        const auto R = factors_.R().diagonal().cwiseAbs();
        return rows_ > 0 && rows_ <= columns_ && R.minCoeff() > least_independent * R.maxCoeff();
    }

    /// What of V is outside.
    MatrixXd outside(const MatrixXd& V) const {
        MatrixXd turned = factors_.Q_transposed_times(V);
        turned.topRows(rows_).setZero();
        return factors_.Q_times(turned);
    }

    /// W with B^T W = V, for a V inside.
    MatrixXd solve(const MatrixXd& V) const {
        const MatrixXd turned = factors_.Q_transposed_times(V);
        return factors_.R().triangularView<Eigen::Upper>().solve(turned.topRows(rows_));
    }

  private:
    Reflections factors_;
    Index rows_;
    Index columns_;
};

/// An orthonormal basis, in columns, of what the row spaces of some of the blocks share.
MatrixXd shared_directions(const Blocks& blocks) {
    MatrixXd V = Reflections(blocks[0].transpose())
                     .Q_times(MatrixXd::Identity(blocks.parameter_count(), blocks[0].rows()));
    const Index stride = std::max<Index>(1, blocks.count() / sample_size);
    for (Index i = 0; i < blocks.count() && V.cols() > 0; i += stride) {
        const RowSpace space(blocks[i]);
        if (!space.is_independent()) return V.leftCols(0);
        const SingularDirections outside = singular_directions(space.outside(V));
        const Index count = (outside.values.array() < unit_rounding).count();
        if (count < V.cols()) V *= MatrixXd(outside.V.rightCols(count));
    }
    return V;
}

}  // namespace

CommonRows split_common_rows(const Blocks& blocks) {
    if (blocks.count() < 2 || blocks.matrix.size() > most_copied || blocks[0].rows() < 2) return {};
    const MatrixXd V = shared_directions(blocks);
    const Index shared = V.cols();
    if (shared == 0) return {};
    CommonRows split;
    for (Index i = 0; i < blocks.count(); ++i) {
        if (blocks[i].rows() <= shared) return {};
        split.others.first_row.push_back(split.others.first_row.back() + blocks[i].rows() - shared);
    }
    split.others.matrix.resize(split.others.first_row.back(), blocks.parameter_count());
    std::vector<MatrixXd> squares(static_cast<std::size_t>(blocks.count()));  // W^T W
    for_each_index(blocks.count(), [&](Index i) {
        const RowSpace space(blocks[i]);
        if (!space.is_independent() || space.outside(V).norm() > sample_size * unit_rounding)
            return;
        const auto at = static_cast<std::size_t>(i);
        const MatrixXd W = space.solve(V);
        squares[at] = W.transpose() * W;
        const RowMatrixXd turned = Reflections(W).Q_transposed_times(blocks[i]);
        const Index first = split.others.first_row[at];
        const Index left = split.others.first_row[at + 1] - first;
        split.others.matrix.middleRows(first, left) = turned.bottomRows(left);
    });
    for (const MatrixXd& square : squares) {
        if (square.size() == 0 ||
            (square - squares[0]).norm() > unit_rounding * squares[0].norm()) {
            return {};
        }
    }
    split.rows = root_of(inverse_of(squares[0])).transpose() * V.transpose();
    return split;
}

}  // namespace posewise::detail
