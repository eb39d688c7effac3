#pragma once

#include <algorithm>
#include <cassert>
#include <type_traits>

#include "core/simd.hpp"
#include "lanes.hpp"

namespace posewise::detail {

// What the kernels of lanes share.

/// Runs `kernel.run_part<V>(group, part)` for every group of lanes and every vector of one.
template <typename Kernel>
struct EachPart {
    Index groups;
    const Kernel& kernel;

    template <typename V>
    POSEWISE_INLINE void run() const {
        for (Index g = 0; g < groups; ++g) {
            for (int part = 0; part < lane_width / simd::width<V>; ++part) {
                kernel.template run_part<V>(g, part);
            }
        }
    }
};
template <typename Kernel>
void run_on_lanes(Index groups, const Kernel& kernel) {
    simd::run(EachPart<Kernel>{groups, kernel});
}

/// The lower triangle's entry (a, b), b <= a.
constexpr Index packed(Index a, Index b) { return a * (a + 1) / 2 + b; }
constexpr int packed_size(int rows) { return rows * (rows + 1) / 2; }

/// What lanes L are computed in where doubles are in V: both have as many bytes.
template <typename L, typename V>
using VectorIn = std::conditional_t<std::is_same_v<L, Lane>, V, typename simd::FloatsOf<V>::type>;
template <typename L>
using NumberIn = typename decltype(L::of)::value_type;

template <typename V, typename L>
POSEWISE_INLINE const V& at(const L* lane, int part) {
    return *(reinterpret_cast<const V*>(lane) + part);
}
template <typename V, typename L>
POSEWISE_INLINE V& at(L* lane, int part) {
    return *(reinterpret_cast<V*>(lane) + part);
}

/// X = B P for one group: R x R vectors. P is row-major, zero beyond its first `depth` rows. Rows
/// of B (`parameters` long) are taken in tiles whose accumulators fit the registers.
template <int R, typename V, typename L>
POSEWISE_INLINE void multiply(const L* B, int part, const NumberIn<L>* P, Index parameters,
                              Index depth, V (&X)[R][R]) {
    constexpr int tile = simd::width<V> < 8 ? 1 : R % 3 == 0 && R < 12 ? 3 : R % 2 == 0 ? 2 : 1;
    for (int a = 0; a < R; a += tile) {
        V sum[tile][R] = {};
        for (Index l = 0; l < depth; ++l) {
            const NumberIn<L>* p = P + l * R;
#pragma GCC unroll 4
            for (int t = 0; t < tile; ++t) {
                const V b = at<V>(B + (a + t) * parameters + l, part);
#pragma GCC unroll 12
                for (int c = 0; c < R; ++c) sum[t][c] += b * p[c];
            }
        }
        for (int t = 0; t < tile; ++t) {
            for (int c = 0; c < R; ++c) X[a + t][c] = sum[t][c];
        }
    }
}

/// S += X Y^T (lower triangle).
template <int R, typename V>
POSEWISE_INLINE void add_product(const V (&X)[R][R], const V (&Y)[R][R], V (&S)[packed_size(R)]) {
    for (int a = 0; a < R; ++a) {
        for (int b = 0; b <= a; ++b) {
            V sum = S[packed(a, b)];
#pragma GCC unroll 12
            for (int c = 0; c < R; ++c) sum += X[a][c] * Y[b][c];
            S[packed(a, b)] = sum;
        }
    }
}

template <int R, typename V, typename L>
POSEWISE_INLINE void load(const std::vector<L>& G, Index group, int part, V (&S)[packed_size(R)]) {
    const L* gram = G.data() + group * packed_size(R);
    for (int k = 0; k < packed_size(R); ++k) S[k] = at<V>(gram + k, part);
}
template <int R, typename V>
POSEWISE_INLINE void store(const V (&S)[packed_size(R)], Index group, int part, LaneGrams& G) {
    Lane* gram = G.data() + group * packed_size(R);
    for (int k = 0; k < packed_size(R); ++k) at<V>(gram + k, part) = S[k];
}

/// Calls `visit` with the height as a constant.
template <typename Visit>
void with_height(Index rows, const Visit& visit) {
    switch (rows) {
        case 1:
            return visit(std::integral_constant<int, 1>{});
        case 2:
            return visit(std::integral_constant<int, 2>{});
        case 3:
            return visit(std::integral_constant<int, 3>{});
        case 6:
            return visit(std::integral_constant<int, 6>{});
        case 9:
            return visit(std::integral_constant<int, 9>{});
        default:
            assert(rows == 12);
            return visit(std::integral_constant<int, 12>{});
    }
}

/// Columns first .. first + width - 1 of F as a row-major matrix, padded with zero columns.
inline RowMatrixXd column_tile(const MatrixXd& F, Index first, Index width) {
    RowMatrixXd tile = RowMatrixXd::Zero(F.rows(), width);
    const Index count = std::min(width, F.cols() - first);
    tile.leftCols(count) = F.middleCols(first, count);
    return tile;
}

}  // namespace posewise::detail
