#include "lanes.hpp"

#include <algorithm>

#include "lane_kernels.hpp"

namespace posewise::detail {
namespace {

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
    POSEWISE_INLINE void run_part(Index g, int part) const {
        if (asked[static_cast<std::size_t>(g)] == 0) return;
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
    POSEWISE_INLINE void run_part(Index g, int part) const {
        if (asked[static_cast<std::size_t>(g)] == 0) return;
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
            run_on_lanes(blocks.groups,
                         UpdateGrams<R>{blocks, P.data(), nullptr, depth, 1, G, nullptr});
        }
    });
    return G;
}

void update_grams(const LaneBlocks& blocks, const MatrixXd& P, const MatrixXd& Q, double sign,
                  LaneGrams& G, LaneGrams& H) {
    const RowMatrixXd tile = column_tile(P, 0, blocks.rows);
    const RowMatrixXd other = column_tile(Q, 0, blocks.rows);
    with_height(blocks.rows, [&](auto R) {
        run_on_lanes(blocks.groups, UpdateGrams<R>{blocks, tile.data(), other.data(), P.rows(),
                                                   sign, G, H.empty() ? nullptr : &H});
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
        run_on_lanes(blocks.groups, Determinants<R>{blocks, G, tile.data(), asked, result});
    });
}

void lane_traces(const LaneBlocks& blocks, const LaneGrams& G, const LaneGrams& H,
                 const MatrixXd& P, const MatrixXd& Q, std::span<const char> asked,
                 std::span<Lane> result) {
    const RowMatrixXd tile = column_tile(P, 0, blocks.rows);
    const RowMatrixXd other = column_tile(Q, 0, blocks.rows);
    with_height(blocks.rows, [&](auto R) {
        run_on_lanes(blocks.groups,
                     Traces<R>{blocks, G, H, tile.data(), other.data(), asked, result});
    });
}

}  // namespace posewise::detail
