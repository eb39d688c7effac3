#include "lanes.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include "../core/simd.hpp"

namespace posewise::detail {
namespace {

/// The lower triangle's entry (a, b), b <= a.
constexpr int packed(int a, int b) { return a * (a + 1) / 2 + b; }
constexpr int packed_size(int rows) { return rows * (rows + 1) / 2; }

template <typename V>
POSEWISE_INLINE const V& at(const Lane* lane, int part) {
    return *(reinterpret_cast<const V*>(lane) + part);
}
template <typename V>
POSEWISE_INLINE V& at(Lane* lane, int part) {
    return *(reinterpret_cast<V*>(lane) + part);
}

/// X = B P for one group: R x R vectors. P is row-major, zero beyond its first `depth` rows. Rows
/// of B (`parameters` long) are taken in tiles whose accumulators fit the registers.
template <int R, typename V>
POSEWISE_INLINE void multiply(const Lane* B, int part, const double* P, Index parameters,
                              Index depth, V (&X)[R][R]) {
    constexpr int tile = simd::width<V> < 8 ? 1 : R % 3 == 0 && R < 12 ? 3 : R % 2 == 0 ? 2 : 1;
    for (int a = 0; a < R; a += tile) {
        V sum[tile][R] = {};
        for (Index l = 0; l < depth; ++l) {
            const double* p = P + l * R;
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

template <int R, typename V>
POSEWISE_INLINE void load(const LaneGrams& G, Index group, int part, V (&S)[packed_size(R)]) {
    const Lane* gram = G.data() + group * packed_size(R);
    for (int k = 0; k < packed_size(R); ++k) S[k] = at<V>(gram + k, part);
}
template <int R, typename V>
POSEWISE_INLINE void store(const V (&S)[packed_size(R)], Index group, int part, LaneGrams& G) {
    Lane* gram = G.data() + group * packed_size(R);
    for (int k = 0; k < packed_size(R); ++k) at<V>(gram + k, part) = S[k];
}

/// G += sign X X^T and, where there is an H, H += sign (X Y^T + Y X^T). P and Q are zero beyond
/// their first `depth` rows.
template <int R>
struct UpdateGrams {
    const LaneBlocks& blocks;
    const double* P;
    const double* Q;
    Index depth;
    double sign;
    LaneGrams& G;
    LaneGrams* H;

    template <typename V>
    POSEWISE_INLINE void run() const {
        for (Index g = 0; g < blocks.groups; ++g) {
            for (int part = 0; part < lane_width / simd::width<V>; ++part) run_part<V>(g, part);
        }
    }

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        const Lane* B = blocks.entries.data() + g * R * blocks.parameters;
        V X[R][R];
        V signed_X[R][R];
        V S[packed_size(R)];
        multiply<R, V>(B, part, P, blocks.parameters, depth, X);
        for (int a = 0; a < R; ++a) {
            for (int c = 0; c < R; ++c) signed_X[a][c] = sign * X[a][c];
        }
        load<R, V>(G, g, part, S);
        add_product<R, V>(signed_X, X, S);
        store<R, V>(S, g, part, G);
        if (H == nullptr) return;
        V Y[R][R];
        multiply<R, V>(B, part, Q, blocks.parameters, depth, Y);
        load<R, V>(*H, g, part, S);
        add_product<R, V>(signed_X, Y, S);
        add_product<R, V>(Y, signed_X, S);
        store<R, V>(S, g, part, *H);
    }
};

/// The product of the pivots of I + G + X X^T.
template <int R>
struct Determinants {
    const LaneBlocks& blocks;
    const LaneGrams& G;
    const double* P;
    std::span<const char> asked;
    std::span<Lane> result;

    template <typename V>
    POSEWISE_INLINE void run() const {
        for (Index g = 0; g < blocks.groups; ++g) {
            if (asked[static_cast<std::size_t>(g)] == 0) continue;
            for (int part = 0; part < lane_width / simd::width<V>; ++part) run_part<V>(g, part);
        }
    }

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        V X[R][R];
        V S[packed_size(R)];
        multiply<R, V>(blocks.entries.data() + g * R * blocks.parameters, part, P,
                       blocks.parameters, blocks.parameters, X);
        load<R, V>(G, g, part, S);
        add_product<R, V>(X, X, S);
        V determinant = {};
        determinant += 1.0;
#pragma GCC unroll 12
        for (int k = 0; k < R; ++k) {
            const V pivot = S[packed(k, k)] + 1.0;
            const V inverse = 1.0 / pivot;
            determinant *= pivot;
#pragma GCC unroll 12
            for (int a = k + 1; a < R; ++a) {
                const V factor = S[packed(a, k)] * inverse;
#pragma GCC unroll 12
                for (int b = k + 1; b <= a; ++b) S[packed(a, b)] -= factor * S[packed(b, k)];
            }
        }
        at<V>(&result[static_cast<std::size_t>(g)], part) = determinant;
    }
};

/// Eliminates I + G + X X^T and, by the same row and column operations, H + X Y^T + Y X^T, whose
/// diagonal over the pivots is then the trace.
template <int R>
struct Traces {
    const LaneBlocks& blocks;
    const LaneGrams& G;
    const LaneGrams& H;
    const double* P;
    const double* Q;
    std::span<const char> asked;
    std::span<Lane> result;

    template <typename V>
    POSEWISE_INLINE void run() const {
        for (Index g = 0; g < blocks.groups; ++g) {
            if (asked[static_cast<std::size_t>(g)] == 0) continue;
            for (int part = 0; part < lane_width / simd::width<V>; ++part) run_part<V>(g, part);
        }
    }

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        const Lane* B = blocks.entries.data() + g * R * blocks.parameters;
        V X[R][R];
        V Y[R][R];
        V S[packed_size(R)];
        V T[packed_size(R)];
        multiply<R, V>(B, part, P, blocks.parameters, blocks.parameters, X);
        multiply<R, V>(B, part, Q, blocks.parameters, blocks.parameters, Y);
        load<R, V>(G, g, part, S);
        load<R, V>(H, g, part, T);
        add_product<R, V>(X, X, S);
        add_product<R, V>(X, Y, T);
        add_product<R, V>(Y, X, T);
        V trace = {};
        for (int k = 0; k < R; ++k) {
            const V inverse = 1.0 / (S[packed(k, k)] + 1.0);
            const V diagonal = T[packed(k, k)];
            trace += diagonal * inverse;
            V factor[R];
            V reduced[R];
            for (int a = k + 1; a < R; ++a) {
                factor[a] = S[packed(a, k)] * inverse;
                reduced[a] = T[packed(a, k)] - 0.5 * factor[a] * diagonal;
                for (int b = k + 1; b <= a; ++b) {
                    S[packed(a, b)] -= factor[a] * S[packed(b, k)];
                    T[packed(a, b)] -= factor[a] * reduced[b] + factor[b] * reduced[a];
                }
            }
        }
        at<V>(&result[static_cast<std::size_t>(g)], part) = trace;
    }
};

/// I + G + X X^T = L D L^T once, then Y's rows eliminated by it for one test pose after the other,
/// until one falls too little by every candidate of a group.
template <int R>
struct LeastSpares {
    const LaneBlocks& blocks;
    const LaneGrams& G;
    const double* P;
    std::span<const Witness> witnesses;
    std::span<Lane> result;

    template <typename V>
    POSEWISE_INLINE void run() const {
        for (Index g = 0; g < blocks.groups; ++g) {
            for (int part = 0; part < lane_width / simd::width<V>; ++part) run_part<V>(g, part);
        }
    }

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        const Lane* B = blocks.entries.data() + g * R * blocks.parameters;
        V X[R][R];
        V S[packed_size(R)];
        V inverse[R];
        multiply<R, V>(B, part, P, blocks.parameters, blocks.parameters, X);
        load<R, V>(G, g, part, S);
        add_product<R, V>(X, X, S);
        factorise<V>(S, inverse);
        V least = {};
        least += std::numeric_limits<double>::infinity();
        for (const Witness& witness : witnesses) {
            V spare = {};
            spare -= witness.least_fall;
            for (Index first = 0; first < witness.R.cols(); first += R) {
                multiply<R, V>(B, part, witness.R.data() + first * blocks.parameters,
                               blocks.parameters, blocks.parameters, X);
                add_solved_squares<V>(S, inverse, X, spare);
            }
            least = spare < least ? spare : least;
            bool is_open = false;
            for (int k = 0; k < simd::width<V>; ++k) is_open |= least[k] > 0;
            if (!is_open) break;
        }
        at<V>(&result[static_cast<std::size_t>(g)], part) = least;
    }

    /// I + S = L D L^T: L below S's diagonal, D^-1 apart.
    template <typename V>
    POSEWISE_INLINE static void factorise(V (&S)[packed_size(R)], V (&inverse)[R]) {
        for (int k = 0; k < R; ++k) {
            inverse[k] = 1.0 / (S[packed(k, k)] + 1.0);
            for (int a = k + 1; a < R; ++a) {
                const V factor = S[packed(a, k)] * inverse[k];
                for (int b = k + 1; b <= a; ++b) S[packed(a, b)] -= factor * S[packed(b, k)];
            }
            for (int a = k + 1; a < R; ++a) S[packed(a, k)] *= inverse[k];
        }
    }

    /// total += trace(Y^T (I + S)^-1 Y); Y is overwritten.
    template <typename V>
    POSEWISE_INLINE static void add_solved_squares(const V (&S)[packed_size(R)],
                                                   const V (&inverse)[R], V (&Y)[R][R], V& total) {
        for (int k = 0; k < R; ++k) {
            V squares = {};
            for (int c = 0; c < R; ++c) squares += Y[k][c] * Y[k][c];
            total += squares * inverse[k];
            for (int a = k + 1; a < R; ++a) {
                for (int c = 0; c < R; ++c) Y[a][c] -= S[packed(a, k)] * Y[k][c];
            }
        }
    }
};

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
RowMatrixXd column_tile(const MatrixXd& F, Index first, Index width) {
    RowMatrixXd tile = RowMatrixXd::Zero(F.rows(), width);
    const Index count = std::min(width, F.cols() - first);
    tile.leftCols(count) = F.middleCols(first, count);
    return tile;
}

}  // namespace

Index lane_height(const Blocks& candidates) {
    Index highest = 1;
    for (Index i = 0; i < candidates.count(); ++i) {
        highest = std::max(highest, candidates[i].rows());
    }
    const auto* fit = std::lower_bound(lane_heights.begin(), lane_heights.end(), highest);
    return fit == lane_heights.end() ? 0 : *fit;
}

LaneBlocks make_lane_blocks(const Blocks& candidates, std::span<const Index> chosen) {
    const Index rows = lane_height(candidates);
    return rows == 0 ? LaneBlocks{} : make_lane_blocks(candidates, chosen, rows);
}

LaneBlocks make_lane_blocks(const Blocks& candidates, std::span<const Index> chosen, Index rows) {
    LaneBlocks blocks;
    blocks.rows = rows;
    blocks.parameters = candidates.parameter_count();
    const auto count = static_cast<Index>(chosen.size());
    blocks.groups = (count + lane_width - 1) / lane_width;
    const Index group_size = blocks.rows * blocks.parameters;
    blocks.entries.resize(static_cast<std::size_t>(blocks.groups * group_size));
    for (Index i = 0; i < count; ++i) {
        const auto block = candidates[chosen[static_cast<std::size_t>(i)]];
        Lane* group = blocks.entries.data() + i / lane_width * group_size;
        for (Index row = 0; row < block.rows(); ++row) {
            for (Index l = 0; l < blocks.parameters; ++l) {
                group[row * blocks.parameters + l].of[static_cast<std::size_t>(i % lane_width)] =
                    block(row, l);
            }
        }
    }
    return blocks;
}

LaneGrams make_grams(const LaneBlocks& blocks, const MatrixXd& F) {
    LaneGrams G(static_cast<std::size_t>(blocks.groups * blocks.rows * (blocks.rows + 1) / 2));
    with_height(blocks.rows, [&](auto R) {
        for (Index first = 0; first < F.cols(); first += R) {
            const RowMatrixXd P = column_tile(F, first, R);
            Index depth = P.rows();
            while (depth > 0 && P.row(depth - 1).isZero(0)) --depth;
            simd::run(UpdateGrams<R>{blocks, P.data(), nullptr, depth, 1, G, nullptr});
        }
    });
    return G;
}

void update_grams(const LaneBlocks& blocks, const MatrixXd& P, const MatrixXd& Q, double sign,
                  LaneGrams& G, LaneGrams& H) {
    const RowMatrixXd tile = column_tile(P, 0, blocks.rows);
    const RowMatrixXd other = column_tile(Q, 0, blocks.rows);
    with_height(blocks.rows, [&](auto R) {
        simd::run(UpdateGrams<R>{blocks, tile.data(), other.data(), P.rows(), sign, G,
                                 H.empty() ? nullptr : &H});
    });
}

VectorXd gram_traces(const LaneBlocks& blocks, const LaneGrams& G) {
    const Index size = blocks.rows * (blocks.rows + 1) / 2;
    VectorXd traces = VectorXd::Zero(blocks.groups * lane_width);
    for (Index i = 0; i < traces.size(); ++i) {
        for (Index row = 0; row < blocks.rows; ++row) {
            const Index diagonal = row * (row + 3) / 2;
            traces[i] += G[static_cast<std::size_t>(i / lane_width * size + diagonal)]
                             .of[static_cast<std::size_t>(i % lane_width)];
        }
    }
    return traces;
}

void lane_determinants(const LaneBlocks& blocks, const LaneGrams& G, const MatrixXd& P,
                       std::span<const char> asked, std::span<Lane> result) {
    const RowMatrixXd tile = column_tile(P, 0, blocks.rows);
    with_height(blocks.rows, [&](auto R) {
        simd::run(Determinants<R>{blocks, G, tile.data(), asked, result});
    });
}

void lane_traces(const LaneBlocks& blocks, const LaneGrams& G, const LaneGrams& H,
                 const MatrixXd& P, const MatrixXd& Q, std::span<const char> asked,
                 std::span<Lane> result) {
    const RowMatrixXd tile = column_tile(P, 0, blocks.rows);
    const RowMatrixXd other = column_tile(Q, 0, blocks.rows);
    with_height(blocks.rows, [&](auto R) {
        simd::run(Traces<R>{blocks, G, H, tile.data(), other.data(), asked, result});
    });
}

Witness make_witness(const LaneBlocks& blocks, const MatrixXd& R, double least_fall) {
    const Index tiles = (R.cols() + blocks.rows - 1) / blocks.rows;
    Witness witness{RowMatrixXd(R.rows(), tiles * blocks.rows), least_fall};
    for (Index t = 0; t < tiles; ++t) {
        Eigen::Map<RowMatrixXd>(witness.R.data() + t * R.rows() * blocks.rows, R.rows(),
                                blocks.rows) = column_tile(R, t * blocks.rows, blocks.rows);
    }
    return witness;
}

void lane_spares(const LaneBlocks& blocks, const LaneGrams& G, const MatrixXd& P,
                 std::span<const Witness> witnesses, std::span<Lane> result) {
    const RowMatrixXd tile = column_tile(P, 0, blocks.rows);
    with_height(blocks.rows, [&](auto R) {
        simd::run(LeastSpares<R>{blocks, G, tile.data(), witnesses, result});
    });
}

}  // namespace posewise::detail
