#include <limits>

#include "lane_kernels.hpp"

namespace posewise::detail {
namespace {

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

}  // namespace

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
        run_on_lanes(blocks.groups, LeastSpares<R>{blocks, G, tile.data(), witnesses, result});
    });
}

}  // namespace posewise::detail
