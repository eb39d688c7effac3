#include "root_traces.hpp"

#include <cmath>

#include "lane_kernels.hpp"

namespace posewise::detail {
namespace {

constexpr Index tile = 4;  // inverses at a time

/// One group of candidates. `work` has room for the triangle, two vectors and the squares beside
/// the tridiagonal's diagonal.
struct RootTrace {
    const LaneBlocks& blocks;
    Index group;
    Index size;
    const double* M;
    const InverseRoot& root;
    std::span<Lane> work;
    Lane& result;

    template <typename V>
    struct Vectors {
        V* triangle;
        V* v;
        V* p;
        V* squares;
    };

    template <typename V>
    POSEWISE_INLINE void run() const {
        V* const room = reinterpret_cast<V*>(work.data());
        V* const after = room + packed(size, 0);
        const Vectors<V> vectors{room, after, after + size, after + 2 * size};
        for (int part = 0; part < lane_width / simd::width<V>; ++part) {
            add_blocks<V>(part, vectors);
            for (Index i = size - 1; i > 0; --i) reflect<V>(i, vectors);
            V trace = {};
            for (std::size_t k = 0; k < root.shifts.size(); k += tile) {
                add_inverses<V>(k, vectors, trace);
            }
            *(reinterpret_cast<V*>(&result) + part) = trace;
        }
    }

    template <typename V>
    POSEWISE_INLINE void add_blocks(int part, const Vectors<V>& to) const {
        constexpr int parts = lane_width / simd::width<V>;
        for (Index k = 0; k < packed(size, 0); ++k) to.triangle[k] = V{} + M[k];
        const V* b = reinterpret_cast<const V*>(blocks.entries.data() +
                                                group * blocks.rows * blocks.parameters) +
                     part;
        for (Index r = 0; r < blocks.rows; ++r, b += size * parts) {
            for (Index i = 0; i < size; ++i) {
                V* const row = to.triangle + packed(i, 0);
                const V factor = b[i * parts];
                for (Index j = 0; j <= i; ++j) row[j] += factor * b[j * parts];
            }
        }
    }

    /// Makes all entries of row i zero but those beside the diagonal.
    template <typename V>
    POSEWISE_INLINE void reflect(Index i, const Vectors<V>& a) const {
        const V* const x = a.triangle + packed(i, 0);
        V squares = {};
        for (Index j = 0; j < i; ++j) squares += x[j] * x[j];
        a.squares[i] = squares;
        if (i == 1) return;
        V norm = squares;
        for (int k = 0; k < simd::width<V>; ++k) norm[k] = std::sqrt(norm[k]);
        const V last = x[i - 1];
        for (Index j = 0; j < i; ++j) {
            a.v[j] = x[j];
            a.p[j] = V{};
        }
        a.v[i - 1] += last < 0.0 ? -norm : norm;
        const V inverse = 1.0 / (squares + (last < 0.0 ? -last : last) * norm + 1e-300);
        V product = {};
        for (Index j = 0; j < i; ++j) {
            const V* const row = a.triangle + packed(j, 0);
            const V v = a.v[j];
            V sum = row[j] * v;
            for (Index k = 0; k < j; ++k) {
                sum += row[k] * a.v[k];
                a.p[k] += row[k] * v;
            }
            a.p[j] += sum;
        }
        for (Index j = 0; j < i; ++j) {
            a.p[j] *= inverse;
            product += a.p[j] * a.v[j];
        }
        product *= 0.5 * inverse;
        for (Index j = 0; j < i; ++j) a.p[j] -= product * a.v[j];
        for (Index j = 0; j < i; ++j) {
            V* const row = a.triangle + packed(j, 0);
            const V v = a.v[j];
            const V p = a.p[j];
            for (Index k = 0; k <= j; ++k) row[k] -= v * a.p[k] + p * a.v[k];
        }
    }

    /// trace((T + shift I)^-1) is the slope of the logarithm of the product of pivots by the shift.
    template <typename V>
    POSEWISE_INLINE void add_inverses(std::size_t first, const Vectors<V>& a, V& trace) const {
        V pivot[tile];
        V slope[tile];
        V sum[tile] = {};
        const double* const shift = root.shifts.data() + first;
        for (Index t = 0; t < tile; ++t) {
            pivot[t] = a.triangle[0] + shift[t];
            slope[t] = V{} + 1.0;
        }
        for (Index i = 1; i <= size; ++i) {
#pragma GCC unroll 4
            for (Index t = 0; t < tile; ++t) {
                const V inverse = 1.0 / pivot[t];
                const V relative = slope[t] * inverse;
                sum[t] += relative;
                if (i == size) continue;
                const V removed = a.squares[i] * inverse;
                pivot[t] = a.triangle[packed(i, 0) + i] + shift[t] - removed;
                slope[t] = relative * removed + 1.0;
            }
        }
        for (Index t = 0; t < tile; ++t) {
            trace += sum[t] * root.weights[first + static_cast<std::size_t>(t)];
        }
    }
};

}  // namespace

RootTraces::RootTraces(const MatrixXd& M, const InverseRoot& root) : size_(M.rows()), root_(root) {
    for (Index i = 0; i < size_; ++i) {
        for (Index j = 0; j <= i; ++j) M_.push_back(M(i, j));
    }
    while (root_.shifts.size() % tile != 0) {
        root_.shifts.push_back(1);
        root_.weights.push_back(0);
    }
}

std::vector<Lane> RootTraces::compute(const LaneBlocks& blocks) const {
    std::vector<Lane> work(static_cast<std::size_t>(packed(size_, 0) + 3 * size_));
    std::vector<Lane> traces(static_cast<std::size_t>(blocks.groups));
    for (Index g = 0; g < blocks.groups; ++g) {
        simd::run(RootTrace{blocks, g, size_, M_.data(), root_, work,
                            traces[static_cast<std::size_t>(g)]});
    }
    return traces;
}

}  // namespace posewise::detail
