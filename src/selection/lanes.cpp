#include "lanes.hpp"

#include <algorithm>
#include <limits>

#include "lane_kernels.hpp"

namespace posewise::detail {
namespace {

/// One change of what made grams. P and Q are zero beyond their first `depth` rows.
struct GramChange {
    RowMatrixXd P;
    RowMatrixXd Q;
    Index depth;
    double sign;
};

/// G += sign X X^T and, where there is an H, H += sign (X Y^T + Y X^T), of one change after the
/// other while a group's blocks are in the cache.
template <int R>
struct UpdateGrams {
    const LaneBlocks& blocks;
    const std::vector<GramChange>& changes;
    LaneGrams& G;
    LaneGrams* H;

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        const Lane* B = blocks.entries.data() + g * R * blocks.parameters;
        for (const GramChange& change : changes) {
            V X[R][R];
            V signed_X[R][R];
            V S[packed_size(R)];
            multiply<R, V>(B, part, change.P.data(), blocks.parameters, change.depth, X);
            for (int a = 0; a < R; ++a) {
                for (int c = 0; c < R; ++c) signed_X[a][c] = change.sign * X[a][c];
            }
            load<R, V>(G, g, part, S);
            add_product<R, V>(signed_X, X, S);
            store<R, V>(S, g, part, G);
            if (H == nullptr) continue;
            V Y[R][R];
            multiply<R, V>(B, part, change.Q.data(), blocks.parameters, change.depth, Y);
            load<R, V>(*H, g, part, S);
            add_product<R, V>(signed_X, Y, S);
            add_product<R, V>(Y, signed_X, S);
            store<R, V>(S, g, part, *H);
        }
    }
};

/// Whether lanes in single precision are right to three digits: while elimination makes no pivot of
/// the `whole` diagonal so many times smaller. Of doubles nothing is asked.
template <typename L, typename V>
class Kept {
  public:
    POSEWISE_INLINE void add(const V& pivot, const V& whole) {
        if constexpr (is_rough) {
            const V left = pivot * most_lost - whole;
            least_ = left < least_ ? left : least_;
        }
    }
    /// Makes the result not a number where they are not.
    POSEWISE_INLINE void check(V& result) const {
        if constexpr (is_rough) {
            V nothing = {};
            nothing += std::numeric_limits<float>::quiet_NaN();
            result = least_ > 0 ? result : nothing;
        }
    }

  private:
    static constexpr bool is_rough = std::is_same_v<L, RoughLane>;
    static constexpr float most_lost = 2000;
    V least_ = V{} + NumberIn<L>{1};
};

/// The product of the pivots of I + G + X X^T.
template <int R, typename L>
struct Determinants {
    const BlocksIn<L>& blocks;
    const std::vector<L>& G;
    const NumberIn<L>* P;
    std::span<const char> asked;
    std::span<L> result;

    template <typename Doubles>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        using V = VectorIn<L, Doubles>;
        constexpr NumberIn<L> one = 1;
        if (asked[static_cast<std::size_t>(g)] == 0) return;
        V X[R][R];
        V S[packed_size(R)];
        multiply<R, V>(blocks.entries.data() + g * R * blocks.parameters, part, P,
                       blocks.parameters, blocks.parameters, X);
        load<R, V>(G, g, part, S);
        add_product<R, V>(X, X, S);
        V determinant = {};
        determinant += one;
        V whole[R];  // the diagonal
        Kept<L, V> kept;
        for (int k = 0; k < R; ++k) whole[k] = S[packed(k, k)] + one;
#pragma GCC unroll 12
        for (int k = 0; k < R; ++k) {
            const V pivot = S[packed(k, k)] + one;
            const V inverse = one / pivot;
            determinant *= pivot;
            kept.add(pivot, whole[k]);
#pragma GCC unroll 12
            for (int a = k + 1; a < R; ++a) {
                const V factor = S[packed(a, k)] * inverse;
#pragma GCC unroll 12
                for (int b = k + 1; b <= a; ++b) S[packed(a, b)] -= factor * S[packed(b, k)];
            }
        }
        kept.check(determinant);
        at<V>(&result[static_cast<std::size_t>(g)], part) = determinant;
    }
};

/// Eliminates I + G + X X^T and, by the same row and column operations, H + X Y^T + Y X^T, whose
/// diagonal over the pivots is then the trace.
template <int R, typename L>
struct Traces {
    const BlocksIn<L>& blocks;
    const std::vector<L>& G;
    const std::vector<L>& H;
    const NumberIn<L>* P;
    const NumberIn<L>* Q;
    std::span<const char> asked;
    std::span<L> result;

    template <typename Doubles>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        using V = VectorIn<L, Doubles>;
        constexpr NumberIn<L> one = 1;
        if (asked[static_cast<std::size_t>(g)] == 0) return;
        const L* B = blocks.entries.data() + g * R * blocks.parameters;
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
        V whole[R];  // the diagonal
        Kept<L, V> kept;
        for (int k = 0; k < R; ++k) whole[k] = S[packed(k, k)] + one;
        for (int k = 0; k < R; ++k) {
            const V pivot = S[packed(k, k)] + one;
            const V inverse = one / pivot;
            const V diagonal = T[packed(k, k)];
            kept.add(pivot, whole[k]);
            trace += diagonal * inverse;
            V factor[R];
            V reduced[R];
            for (int a = k + 1; a < R; ++a) {
                factor[a] = S[packed(a, k)] * inverse;
                reduced[a] = T[packed(a, k)] - one / 2 * factor[a] * diagonal;
                for (int b = k + 1; b <= a; ++b) {
                    S[packed(a, b)] -= factor[a] * S[packed(b, k)];
                    T[packed(a, b)] -= factor[a] * reduced[b] + factor[b] * reduced[a];
                }
            }
        }
        kept.check(trace);
        at<V>(&result[static_cast<std::size_t>(g)], part) = trace;
    }
};

template <typename L>
using TileIn = Eigen::Matrix<NumberIn<L>, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

std::vector<RoughLane> make_rough(const std::vector<Lane>& lanes, Index size) {
    const auto count = static_cast<std::size_t>(size);
    std::vector<RoughLane> rough((lanes.size() / count + 1) / 2 * count);
    for (std::size_t k = 0; k < lanes.size(); ++k) {
        const std::size_t group = k / count;
        float* of = rough[group / 2 * count + k % count].of.data() + group % 2 * lane_width;
        for (const double number : lanes[k].of) *of++ = static_cast<float>(number);
    }
    return rough;
}

RoughBlocks make_rough(const LaneBlocks& blocks) {
    if (blocks.rows == 0) return {};
    return {blocks.rows, blocks.parameters, (blocks.groups + 1) / 2,
            make_rough(blocks.entries, blocks.rows * blocks.parameters)};
}

LaneGrams make_grams(const LaneBlocks& blocks, const MatrixXd& F) {
    LaneGrams G(static_cast<std::size_t>(blocks.groups * blocks.rows * (blocks.rows + 1) / 2));
    std::vector<GramChange> changes;
    for (Index first = 0; first < F.cols(); first += blocks.rows) {
        const RowMatrixXd P = column_tile(F, first, blocks.rows);
        Index depth = P.rows();
        while (depth > 0 && P.row(depth - 1).isZero(0)) --depth;
        changes.push_back({P, {}, depth, 1});
    }
    with_height(blocks.rows, [&](auto R) {
        run_on_lanes(blocks.groups, UpdateGrams<R>{blocks, changes, G, nullptr});
    });
    return G;
}

void update_grams(const LaneBlocks& blocks, std::span<const GramUpdate> updates, LaneGrams& G,
                  LaneGrams& H) {
    std::vector<GramChange> changes;
    for (const auto& [P, Q, sign] : updates) {
        changes.push_back(
            {column_tile(P, 0, blocks.rows), column_tile(Q, 0, blocks.rows), P.rows(), sign});
    }
    with_height(blocks.rows, [&](auto R) {
        run_on_lanes(blocks.groups, UpdateGrams<R>{blocks, changes, G, H.empty() ? nullptr : &H});
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

template <typename L>
void lane_determinants(const BlocksIn<L>& blocks, const std::vector<L>& G, const MatrixXd& P,
                       std::span<const char> asked, std::vector<L>& result) {
    const TileIn<L> tile = column_tile(P, 0, blocks.rows).template cast<NumberIn<L>>();
    with_height(blocks.rows, [&](auto R) {
        run_on_lanes(blocks.groups, Determinants<R, L>{blocks, G, tile.data(), asked, result});
    });
}
template void lane_determinants(const LaneBlocks&, const LaneGrams&, const MatrixXd&,
                                std::span<const char>, std::vector<Lane>&);
template void lane_determinants(const RoughBlocks&, const RoughGrams&, const MatrixXd&,
                                std::span<const char>, std::vector<RoughLane>&);

template <typename L>
void lane_traces(const BlocksIn<L>& blocks, const std::vector<L>& G, const std::vector<L>& H,
                 const MatrixXd& P, const MatrixXd& Q, std::span<const char> asked,
                 std::vector<L>& result) {
    const TileIn<L> tile = column_tile(P, 0, blocks.rows).template cast<NumberIn<L>>();
    const TileIn<L> other = column_tile(Q, 0, blocks.rows).template cast<NumberIn<L>>();
    with_height(blocks.rows, [&](auto R) {
        run_on_lanes(blocks.groups,
                     Traces<R, L>{blocks, G, H, tile.data(), other.data(), asked, result});
    });
}
template void lane_traces(const LaneBlocks&, const LaneGrams&, const LaneGrams&, const MatrixXd&,
                          const MatrixXd&, std::span<const char>, std::vector<Lane>&);
template void lane_traces(const RoughBlocks&, const RoughGrams&, const RoughGrams&, const MatrixXd&,
                          const MatrixXd&, std::span<const char>, std::vector<RoughLane>&);

}  // namespace posewise::detail
