#include "sensitivities.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <vector>

#include "parallel.hpp"
#include "simd.hpp"

namespace posewise::detail {
namespace {

/// Columns of F are padded to whole pairs of the widest vectors. Whatever the width, squares are
/// summed in the order of the columns of the first of a pair.
struct alignas(64) PaddedColumns {
    std::array<double, 16> of{};
};

/// out[r] = |F^T b_r|^2 for `count` rows b_r. F is lower triangular: parameters x tiles.
struct SquaredNorms {
    const double* rows;
    Index count;
    Index parameters;
    const std::vector<PaddedColumns>& F;
    double* out;

    template <typename V>
    POSEWISE_INLINE void run() const {
        Index row = 0;
        for (; row + 4 <= count; row += 4) run_tile<4, V>(row);
        for (; row < count; ++row) run_tile<1, V>(row);
    }

    template <int tile, typename V>
    POSEWISE_INLINE void run_tile(Index first) const {
        constexpr int W = simd::width<V>;
        constexpr int parts = 8 / W;
        const Index tiles = (parameters + 15) / 16;
        const double* b = rows + first * parameters;
        double norms[tile] = {};
        for (Index c = 0; c < tiles; ++c) {
            for (int part = 0; part < parts; ++part) {
                V sums[tile][2] = {};
                for (Index l = 16 * c; l < parameters; ++l) {
                    const double* entries = F[static_cast<std::size_t>(l * tiles + c)].of.data();
                    const V* f = reinterpret_cast<const V*>(entries) + part;
#pragma GCC unroll 4
                    for (int r = 0; r < tile; ++r) {
                        sums[r][0] += f[0] * b[r * parameters + l];
                        sums[r][1] += f[parts] * b[r * parameters + l];
                    }
                }
                for (int r = 0; r < tile; ++r) {
                    const V squares = sums[r][0] * sums[r][0] + sums[r][1] * sums[r][1];
                    for (int k = 0; k < W; ++k) norms[r] += squares[k];
                }
            }
        }
        for (int r = 0; r < tile; ++r) out[first + r] = norms[r];
    }
};

std::vector<PaddedColumns> pad_columns(const MatrixXd& lower) {
    const Index L = lower.rows();
    const Index tiles = (L + 15) / 16;
    std::vector<PaddedColumns> padded(static_cast<std::size_t>(L * tiles));
    for (Index l = 0; l < L; ++l) {
        for (Index c = 0; c <= l; ++c) {
            padded[static_cast<std::size_t>(l * tiles + c / 16)]
                .of[static_cast<std::size_t>(c % 16)] = lower(l, c);
        }
    }
    return padded;
}

VectorXd row_norms(const RowMatrixXd& rows, const MatrixXd& lower) {
    constexpr Index chunk = 1024;
    const std::vector<PaddedColumns> F = pad_columns(lower);
    VectorXd norms(rows.rows());
    const auto fill = [&](Index first, Index last) {
        simd::run(SquaredNorms{rows.data() + first * rows.cols(), last - first, rows.cols(), F,
                               norms.data() + first});
    };
    if (rows.rows() > 8 * chunk) {
        for_each_range(rows.rows(), chunk, fill);
    } else {
        fill(0, rows.rows());
    }
    return norms;
}

}  // namespace

VectorXd sensitivities(const Blocks& candidates, const MatrixXd& Z) {
    VectorXd result(candidates.count());
    const Eigen::LLT<MatrixXd> cholesky(Z);
    if (cholesky.info() == Eigen::Success) {
        const VectorXd norms = row_norms(candidates.matrix, cholesky.matrixL());
        for (Index i = 0; i < candidates.count(); ++i) {
            result[i] = norms
                            .segment(candidates.first_row[static_cast<std::size_t>(i)],
                                     candidates[i].rows())
                            .sum();
        }
        return result;
    }
    for_each_range(candidates.count(), 1000, [&](Index first, Index last) {
        for (Index i = first; i < last; ++i) {
            const auto block = candidates[i];
            result[i] = (block * Z).cwiseProduct(block).sum();
        }
    });
    return result;
}

}  // namespace posewise::detail
