#include "rayleigh_ritz.hpp"

#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "criteria/information_function.hpp"
#include "lane_kernels.hpp"

namespace posewise::detail {
namespace {

constexpr double ritz_margin =
    1e-9;  // relative, far above rounding, so that nothing better is ruled out

/// For each candidate the lower triangle of (B U)^T B U, and |B v|^2; U and v are the columns of a
/// row-major matrix.
template <int columns>
struct Compress {
    static constexpr int triangle = columns * (columns - 1) / 2;
    const LaneBlocks& blocks;
    const double* U;
    std::span<Lane> result;

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        const Lane* row = blocks.entries.data() + g * blocks.rows * blocks.parameters;
        V sums[triangle + 1] = {};
        for (Index r = 0; r < blocks.rows; ++r, row += blocks.parameters) {
            V x[columns] = {};
            for (Index l = 0; l < blocks.parameters; ++l) {
                const V entry = at<V>(row + l, part);
#pragma GCC unroll 16
                for (int c = 0; c < columns; ++c) x[c] += entry * U[l * columns + c];
            }
#pragma GCC unroll 16
            for (int a = 0; a + 1 < columns; ++a) {
#pragma GCC unroll 16
                for (int b = 0; b <= a; ++b) sums[packed(a, b)] += x[a] * x[b];
            }
            sums[triangle] += x[columns - 1] * x[columns - 1];
        }
        Lane* const out = result.data() + g * (triangle + 1);
        for (int k = 0; k <= triangle; ++k) at<V>(out + k, part) = sums[k];
    }
};

/// The least pivot of `remaining` + each compression - least I; not the least, but not positive, if
/// one of those before it is not.
template <int vectors>
struct LeastPivots {
    static constexpr int triangle = vectors * (vectors + 1) / 2;
    const double* remaining;
    std::span<const Lane> compressions;
    std::span<const Lane> least;
    std::span<Lane> result;

    template <typename V>
    POSEWISE_INLINE void run_part(Index g, int part) const {
        const Lane* const compression = compressions.data() + g * (triangle + 1);
        const V shift = at<V>(least.data() + g, part);
        V S[triangle];
#pragma GCC unroll 36
        for (int k = 0; k < triangle; ++k) S[k] = at<V>(compression + k, part) + remaining[k];
#pragma GCC unroll 8
        for (int k = 0; k < vectors; ++k) S[packed(k, k)] -= shift;
        V smallest = S[0];
#pragma GCC unroll 8
        for (int k = 0; k < vectors; ++k) {
            const V pivot = S[packed(k, k)];
            smallest = pivot < smallest ? pivot : smallest;
            const V inverse = 1.0 / pivot;
#pragma GCC unroll 8
            for (int a = k + 1; a < vectors; ++a) {
                const V factor = S[packed(a, k)] * inverse;
#pragma GCC unroll 8
                for (int b = k + 1; b <= a; ++b) S[packed(a, b)] -= factor * S[packed(b, k)];
            }
        }
        at<V>(result.data() + g, part) = smallest;
    }
};

/// The least pivot of M + B^T B - least I of each candidate; not the least, but not positive, where
/// one before it is not.
struct ExchangedPivots {
    const LaneBlocks& blocks;
    const MatrixXd& M;  // its upper half
    const Lane& least;
    std::span<Lane> work;  // room for a triangle and a column
    Lane& result;

    template <typename V>
    POSEWISE_INLINE void run_part(Index group, int part) const {
        V* const m = reinterpret_cast<V*>(work.data());
        const Index size = blocks.parameters;
        V* const column = m + packed(size, 0);
        const V shift = at<V>(&least, part);
        for (Index i = 0; i < size; ++i) {
            for (Index j = 0; j <= i; ++j) m[packed(i, j)] = V{} + M(j, i);
            m[packed(i, i)] -= shift;
        }
        constexpr Index parts = lane_width / simd::width<V>;
        const V* b = &at<V>(blocks.entries.data() + group * blocks.rows * size, part);
        for (Index r = 0; r < blocks.rows; ++r, b += size * parts) {
            for (Index i = 0; i < size; ++i) add(b, parts, i, m + packed(i, 0));
        }
        V smallest = m[0];
        for (Index k = 0; k < size; ++k) {
            const V pivot = m[packed(k, k)];
            smallest = pivot < smallest ? pivot : smallest;
            const V inverse = 1.0 / pivot;
            for (Index i = k + 1; i < size; ++i) {
                V* const row = m + packed(i, 0);
                column[i] = row[k];
                const V factor = row[k] * inverse;
                for (Index j = k + 1; j <= i; ++j) row[j] -= factor * column[j];
            }
        }
        at<V>(&result, part) = smallest;
    }

    /// Row i of the lower triangle of b b^T.
    template <typename V>
    POSEWISE_INLINE static void add(const V* b, Index stride, Index i, V* row) {
        const V factor = b[i * stride];
        for (Index j = 0; j <= i; ++j) row[j] += factor * b[j * stride];
    }
};

}  // namespace

RayleighRitz::RayleighRitz(const Objective& objective, const Blocks& candidates,
                           const Shortlist& shortlist)
    : objective_(objective), candidates_(candidates), shortlist_(shortlist) {
    const std::size_t groups = (shortlist.members.size() + lane_width - 1) / lane_width;
    compressions_.resize(groups * size);
    least_.resize(groups);
    pivots_.resize(groups);
}

RayleighRitz::Compression RayleighRitz::compress(const Eigen::Ref<const RowMatrixXd>& block) const {
    const RowMatrixXd BU = block * U_;
    const Eigen::Matrix<double, vectors, vectors> weak =
        BU.leftCols<vectors>().transpose() * BU.leftCols<vectors>();
    Compression result;
    for (int a = 0; a < vectors; ++a) {
        for (int b = 0; b <= a; ++b) result[packed(a, b)] = weak(a, b);
    }
    result[weak_size] = BU.col(vectors).squaredNorm();
    return result;
}

void RayleighRitz::compress_members() {
    if (shortlist_.lanes.rows > 0) {
        return run_on_lanes(shortlist_.lanes.groups,
                            Compress<vectors + 1>{shortlist_.lanes, U_.data(), compressions_});
    }
    for (std::size_t k = 0; k < shortlist_.members.size(); ++k) {
        const Compression one = compress(candidates_[shortlist_.members[k]]);
        for (std::size_t e = 0; e < size; ++e) {
            compressions_[k / lane_width * size + e].of[k % lane_width] =
                one[static_cast<Index>(e)];
        }
    }
}

void RayleighRitz::move_to(const MatrixXd& M) {
    const auto eigen = eigen_decomposition(M);
    const Index count = std::min(vectors, M.rows());
    U_ = RowMatrixXd::Zero(M.rows(), vectors + 1);
    U_.leftCols(count) = eigen.eigenvectors().leftCols(count);
    U_.col(vectors) = eigen.eigenvectors().rightCols<1>();
    whole_.setZero();
    for (int k = 0; k < vectors; ++k) {  // where there are fewer eigenvalues no pivot is small
        whole_[packed(k, k)] =
            k < count ? eigen.eigenvalues()[k] : std::numeric_limits<double>::infinity();
    }
    whole_[weak_size] = eigen.eigenvalues()[M.rows() - 1];
    compress_members();
}

void RayleighRitz::remove(Index candidate) {
    remaining_ = whole_ - compress(candidates_[candidate]);
}

double RayleighRitz::least_eigenvalue(double largest) const {
    const double least = objective_.criterion == Criterion::O2 ? value_ * value_ * largest
                         : objective_.criterion == Criterion::O4
                             ? value_ * std::sqrt(largest)
                             : information_of_value(objective_, value_, U_.rows());
    return (1 - ritz_margin) * least;
}

void RayleighRitz::ask(double value) {
    value_ = value;
    if (!(value > 0)) return;
    for (std::size_t g = 0; g < least_.size(); ++g) {
        for (std::size_t k = 0; k < lane_width; ++k) {
            least_[g].of[k] =
                least_eigenvalue(remaining_[weak_size] + compressions_[g * size + weak_size].of[k]);
        }
    }
    run_on_lanes(std::ssize(least_),
                 LeastPivots<vectors>{remaining_.data(), compressions_, least_, pivots_});
}

bool RayleighRitz::may_exceed(Index position) const {
    const auto at = static_cast<std::size_t>(position);
    return !(value_ > 0) || pivots_[at / lane_width].of[at % lane_width] > 0;
}

std::vector<Index> RayleighRitz::exceeding(const MatrixXd& remaining,
                                           const std::vector<Index>& positions) {
    if (!(value_ > 0) || positions.empty()) return positions;
    std::vector<Index> candidates;
    Index rows = 0;
    Lane least;
    for (std::size_t k = 0; k < positions.size(); ++k) {
        const auto at = static_cast<std::size_t>(positions[k]);
        candidates.push_back(shortlist_.members[at]);
        rows = std::max(rows, candidates_[candidates.back()].rows());
        least.of[k] = least_[at / lane_width].of[at % lane_width];
    }
    Lane pivots;
    work_.resize(static_cast<std::size_t>(packed(remaining.rows() + 1, 0)));
    run_on_lanes(1, ExchangedPivots{make_lane_blocks(candidates_, candidates, rows), remaining,
                                    least, work_, pivots});
    std::vector<Index> result;
    for (std::size_t k = 0; k < positions.size(); ++k) {
        if (pivots.of[k] > 0) result.push_back(positions[k]);
    }
    return result;
}

}  // namespace posewise::detail
