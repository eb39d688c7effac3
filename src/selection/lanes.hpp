#pragma once

#include <array>
#include <span>
#include <vector>

#include "posewise/core/blocks.hpp"

namespace posewise::detail {

/// One number of eight candidates side by side, so that one instruction works on all of them.
struct alignas(64) Lane {
    std::array<double, 8> of{};
};
constexpr Index lane_width = 8;

/// The same of sixteen in single precision: twice as quick, to sort out what is worth a Lane.
struct alignas(64) RoughLane {
    std::array<float, 16> of{};
};

/// Blocks of some candidates in lanes: entry (row, parameter) of eight candidates is one Lane.
/// Lower blocks are padded with zero rows, missing candidates with zero blocks.
template <typename L>
struct BlocksIn {
    Index rows = 0;  ///< of every block: one of lane_heights where a kernel needs it
    Index parameters = 0;
    Index groups = 0;  ///< of as many candidates as a lane has numbers
    std::vector<L> entries;
};
using LaneBlocks = BlocksIn<Lane>;
using RoughBlocks = BlocksIn<RoughLane>;

/// Block heights there are kernels for.
constexpr std::array<Index, 6> lane_heights{1, 2, 3, 6, 9, 12};

/// The kernel height for blocks of these candidates; 0 if they are too high for any.
Index lane_height(const Blocks& candidates);

/// As high as the highest of all candidates; nothing (rows 0) if that is too high for any kernel.
LaneBlocks make_lane_blocks(const Blocks& candidates, std::span<const Index> chosen);
/// With so many rows, at least those of each of the chosen.
LaneBlocks make_lane_blocks(const Blocks& candidates, std::span<const Index> chosen, Index rows);
RoughBlocks make_rough(const LaneBlocks& blocks);

/// Symmetric rows x rows matrices of each candidate, lower triangles in lanes.
using LaneGrams = std::vector<Lane>;
using RoughGrams = std::vector<RoughLane>;
/// `size` lanes a group.
std::vector<RoughLane> make_rough(const std::vector<Lane>& lanes, Index size);

/// B_i F F^T B_i^T of each candidate (F has `parameters` rows).
LaneGrams make_grams(const LaneBlocks& blocks, const MatrixXd& F);

/// `sign` P P^T and `sign` (P Q^T + Q P^T), added to what made G and H: parameters x at most rows;
/// Q is empty with H.
struct GramUpdate {
    const MatrixXd& P;
    const MatrixXd& Q;
    double sign;
};
/// G_i += sign X_i X_i^T with X_i = B_i P and, unless H is empty, H_i += sign (X_i Y_i^T + Y_i
/// X_i^T) with Y_i = B_i Q.
void update_grams(const LaneBlocks& blocks, std::span<const GramUpdate> updates, LaneGrams& G,
                  LaneGrams& H);

/// The trace of each candidate's matrix, padding included.
VectorXd gram_traces(const LaneBlocks& blocks, const LaneGrams& G);

/// det(I + G_i + X_i X_i^T) with X_i = B_i P: how much information each candidate adds, when M^-1 =
/// F F^T made G and M^-1 + P P^T is the inverse at hand. P is parameters x at most rows. Only
/// groups with `asked` set are computed; the others give zero.
template <typename L>
void lane_determinants(const BlocksIn<L>& blocks, const std::vector<L>& G, const MatrixXd& P,
                       std::span<const char> asked, std::vector<L>& result);

/// trace((I + G_i + X_i X_i^T)^-1 (H_i + X_i Y_i^T + Y_i X_i^T)) with Y_i = B_i Q: by how much each
/// candidate reduces trace(C M^-1), when M^-1 C M^-1 made H and P Q^T + Q P^T is its change.
template <typename L>
void lane_traces(const BlocksIn<L>& blocks, const std::vector<L>& G, const std::vector<L>& H,
                 const MatrixXd& P, const MatrixXd& Q, std::span<const char> asked,
                 std::vector<L>& result);

/// A test pose B0 and by how much its variance, trace(B0 W B0^T), is to fall.
struct Witness {
    RowMatrixXd R;  ///< W B0^T in tiles as wide as the blocks are high, one after the other
    double least_fall = 0;
};
Witness make_witness(const LaneBlocks& blocks, const MatrixXd& R, double least_fall);

/// What is to spare with each candidate: the least, over the witnesses, of trace((I + G_i + X_i
/// X_i^T)^-1 Y_i Y_i^T) - least_fall with Y_i = B_i R; not the least, but not positive, where a
/// witness before it rules out the candidate.
void lane_spares(const LaneBlocks& blocks, const LaneGrams& G, const MatrixXd& P,
                 std::span<const Witness> witnesses, std::span<Lane> result);

}  // namespace posewise::detail
