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

/// out[r] = |F^T b_r|^2 for `count` rows b_r, with `is_root`; else b_r^T F^T b_r. F is lower
/// triangular, 16 of its columns after the other.
struct QuadraticForms {
    const double* rows;
    Index count;
    Index parameters;
    const std::vector<PaddedColumns>& F;
    bool is_root;
    double* out;

    template <typename V>
    POSEWISE_INLINE void run() const {
        constexpr Index panel = 64;  // rows that stay in the cache, while all columns pass
        for (Index begin = 0; begin < count; begin += panel) {
            const Index end = std::min(begin + panel, count);
            for (Index row = begin; row < end; ++row) out[row] = 0;
            for (Index c = 0; 16 * c < parameters; ++c) {
                Index row = begin;
                for (; row + 4 <= end; row += 4) add_tile<4, V>(row, c);
                for (; row < end; ++row) add_tile<1, V>(row, c);
            }
        }
    }

    template <int tile, typename V>
    POSEWISE_INLINE void add_tile(Index first, Index c) const {
        constexpr int W = simd::width<V>;
        constexpr int parts = 8 / W;
        const double* b = rows + first * parameters;
        const PaddedColumns* columns = F.data() + c * parameters;
        for (int part = 0; part < parts; ++part) {
            V sums[tile][2] = {};
            for (Index l = 16 * c; l < parameters; ++l) {
                const V* f = reinterpret_cast<const V*>(columns[l].of.data()) + part;
#pragma GCC unroll 4
                for (int r = 0; r < tile; ++r) {
                    sums[r][0] += f[0] * b[r * parameters + l];
                    sums[r][1] += f[parts] * b[r * parameters + l];
                }
            }
            for (int r = 0; r < tile; ++r) {
                V others[2] = {sums[r][0], sums[r][1]};
                if (!is_root) load(b + r * parameters, 16 * c + part * W, others);
                const V products = sums[r][0] * others[0] + sums[r][1] * others[1];
                for (int k = 0; k < W; ++k) out[first + r] += products[k];
            }
        }
    }

    /// The entries of a row that belong to a pair of vectors; zero beyond its end.
    template <typename V>
    POSEWISE_INLINE void load(const double* b, Index first, V (&pair)[2]) const {
        for (int k = 0; k < simd::width<V>; ++k) {
            pair[0][k] = first + k < parameters ? b[first + k] : 0;
            pair[1][k] = first + k + 8 < parameters ? b[first + k + 8] : 0;
        }
    }
};

std::vector<PaddedColumns> pad_columns(const MatrixXd& lower) {
    const Index L = lower.rows();
    std::vector<PaddedColumns> padded(static_cast<std::size_t>((L + 15) / 16 * L));
    for (Index c = 0; c < L; ++c) {
        for (Index l = c; l < L; ++l) {
            padded[static_cast<std::size_t>(c / 16 * L + l)].of[static_cast<std::size_t>(c % 16)] =
                lower(l, c);
        }
    }
    return padded;
}

/// Of all rows, see QuadraticForms.
VectorXd quadratic_forms(const RowMatrixXd& rows, const MatrixXd& lower, bool is_root) {
    constexpr Index chunk = 1024;
    const std::vector<PaddedColumns> F = pad_columns(lower);
    VectorXd forms(rows.rows());
    const auto fill = [&](Index first, Index last) {
        simd::run(QuadraticForms{rows.data() + first * rows.cols(), last - first, rows.cols(), F,
                                 is_root, forms.data() + first});
    };
    if (rows.rows() > 8 * chunk) {
        for_each_range(rows.rows(), chunk, fill);
    } else {
        fill(0, rows.rows());
    }
    return forms;
}

/// Of all candidates, see QuadraticForms.
VectorXd sum_forms(const Blocks& candidates, const MatrixXd& lower, bool is_root) {
    const VectorXd forms = quadratic_forms(candidates.matrix, lower, is_root);
    VectorXd result(candidates.count());
    for (Index i = 0; i < candidates.count(); ++i) {
        const Index first = candidates.first_row[static_cast<std::size_t>(i)];
        result[i] = forms.segment(first, candidates[i].rows()).sum();
    }
    return result;
}

}  // namespace

VectorXd sensitivities(const Blocks& candidates, const MatrixXd& Z) {
    const Eigen::LLT<MatrixXd> cholesky(Z);
    if (cholesky.info() == Eigen::Success) {
        return root_sensitivities(candidates, cholesky.matrixL());
    }
    MatrixXd lower = 2 * Z;
    lower.diagonal() = Z.diagonal();
    return sum_forms(candidates, lower, false);
}

VectorXd root_sensitivities(const Blocks& candidates, const MatrixXd& F) {
    return sum_forms(candidates, F, true);
}

}  // namespace posewise::detail
