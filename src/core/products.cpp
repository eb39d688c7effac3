#include "products.hpp"

#include <algorithm>
#include <cmath>

#include "simd.hpp"

namespace posewise::detail {
namespace {

/// Tiles are so many rows and two vectors wide: their sums fit the registers.
constexpr Index tile_rows = 4;
constexpr Index most_columns = 16;

constexpr Index padded(Index size, Index part) { return (size + part - 1) / part * part; }

/// A vector wherever it is.
template <typename V>
struct [[gnu::packed, gnu::may_alias]] Unaligned {
    V vector;
};
template <typename V>
POSEWISE_INLINE Unaligned<V>& at(double* to) {
    return *reinterpret_cast<Unaligned<V>*>(to);
}
template <typename V>
POSEWISE_INLINE const Unaligned<V>& at(const double* from) {
    return *reinterpret_cast<const Unaligned<V>*>(from);
}

template <typename V>
POSEWISE_INLINE void load(const double* from, Index stride, V (&tile)[tile_rows][2]) {
#pragma GCC unroll 4
    for (Index r = 0; r < tile_rows; ++r) {
        tile[r][0] = at<V>(from + r * stride).vector;
        tile[r][1] = at<V>(from + r * stride + simd::width<V>).vector;
    }
}
template <typename V>
POSEWISE_INLINE void store(const V (&tile)[tile_rows][2], double* to, Index stride) {
#pragma GCC unroll 4
    for (Index r = 0; r < tile_rows; ++r) {
        at<V>(to + r * stride).vector = tile[r][0];
        at<V>(to + r * stride + simd::width<V>).vector = tile[r][1];
    }
}

/// sums[r] += factors[r] * x, x two vectors.
template <typename V>
POSEWISE_INLINE void add_multiples(const double* factors, const double* x,
                                   V (&sums)[tile_rows][2]) {
    const V left = at<V>(x).vector;
    const V right = at<V>(x + simd::width<V>).vector;
#pragma GCC unroll 4
    for (Index r = 0; r < tile_rows; ++r) {
        sums[r][0] += factors[r] * left;
        sums[r][1] += factors[r] * right;
    }
}

/// M += A^T B by so many rows of A and B, all row-major; where A is B only M's upper half.
struct AddProduct {
    const double* A;
    Index A_columns;
    const double* B;
    Index columns;
    Index rows;
    double* M;

    template <typename V>
    POSEWISE_INLINE void run() const {
        constexpr Index width = 2 * simd::width<V>;
        for (Index i = 0; i < columns; i += width) {
            const Index end = A == B ? i + width : A_columns;
            for (Index j = 0; j < end; j += tile_rows) add_tile<V>(i, j);
        }
    }

    template <typename V>
    POSEWISE_INLINE void add_tile(Index i, Index j) const {
        V sums[tile_rows][2];
        load(M + j * columns + i, columns, sums);
        for (Index k = 0; k < rows; ++k) {
            add_multiples<V>(A + k * A_columns + j, B + k * columns + i, sums);
        }
        store(sums, M + j * columns + i, columns);
    }
};

/// X with zero columns up to a multiple of `part`: itself if it has none too few.
struct Padded {
    Padded(const Eigen::Ref<const RowMatrixXd>& X, Index part) {
        columns = padded(X.cols(), part);
        data = X.data();
        if (columns == X.cols() && columns == X.outerStride()) return;
        copy.setZero(X.rows(), columns);
        copy.leftCols(X.cols()) = X;
        data = copy.data();
    }
    Padded(const Padded&) = delete;

    RowMatrixXd copy;
    const double* data;
    Index columns;
};

/// L in place of the lower half of M, column-major, four columns at a time; `is_positive` false
/// where there is none.
struct Factorise {
    double* M;
    Index size;
    bool& is_positive;

    template <typename V>
    POSEWISE_INLINE void run() const {
        constexpr Index rows = 2 * simd::width<V>;
        for (Index j = 0; j < size && is_positive; j += tile_rows) {
            for (Index i = j / rows * rows; i < size; i += rows) add_tile<V>(i, j);
            factorise_columns(j);
        }
    }

    template <typename V>
    POSEWISE_INLINE void add_tile(Index i, Index j) const {
        V sums[tile_rows][2];
        load(M + j * size + i, size, sums);
        for (Index k = 0; k < j; ++k) {
            const double* column = M + k * size;
            const double factors[tile_rows]{-column[j], -column[j + 1], -column[j + 2],
                                            -column[j + 3]};
            add_multiples<V>(factors, column + i, sums);
        }
        store(sums, M + j * size + i, size);
    }

    /// Columns j on, from which those before j are taken off.
    POSEWISE_INLINE void factorise_columns(Index begin) const {
        for (Index j = begin; j < begin + tile_rows; ++j) {
            double* const column = M + j * size;
            for (Index k = begin; k < j; ++k) {
                const double* const before = M + k * size;
                const double factor = before[j];
                for (Index i = j; i < size; ++i) column[i] -= factor * before[i];
            }
            if (!(column[j] > 0)) is_positive = false;
            const double root = std::sqrt(column[j]);
            for (Index i = j; i < size; ++i) column[i] /= root;
        }
    }
};

/// X = L^-1 X; minus L is column-major with the reciprocals of L's diagonal on its own, X
/// row-major, `columns` wide, and with `is_lower` zero above its diagonal.
struct SolveLower {
    const double* minus_L;
    Index size;
    double* X;
    Index columns;
    bool is_lower = false;

    template <typename V>
    POSEWISE_INLINE void run() const {
        for (Index c = 0; c < columns; c += 2 * simd::width<V>) {
            const Index first = is_lower ? c : 0;
            for (Index i = first; i < size; i += tile_rows) solve_tile<V>(first, i, c);
        }
    }

    template <typename V>
    POSEWISE_INLINE void solve_tile(Index first, Index i, Index c) const {
        V sums[tile_rows][2];
        load(X + i * columns + c, columns, sums);
        for (Index j = first; j < i; ++j) {
            add_multiples<V>(minus_L + j * size + i, X + j * columns + c, sums);
        }
#pragma GCC unroll 4
        for (Index r = 0; r < tile_rows; ++r) {
            const double* column = minus_L + (i + r) * size + i;
            sums[r][0] *= column[r];
            sums[r][1] *= column[r];
#pragma GCC unroll 4
            for (Index below = r + 1; below < tile_rows; ++below) {
                sums[below][0] += column[below] * sums[r][0];
                sums[below][1] += column[below] * sums[r][1];
            }
        }
        store(sums, X + i * columns + c, columns);
    }
};

/// What SolveLower takes for L.
MatrixXd as_divisor(const MatrixXd& L) {
    const Index size = padded(L.rows(), tile_rows);
    MatrixXd minus_L = MatrixXd::Identity(size, size);
    auto corner = minus_L.topLeftCorner(L.rows(), L.rows());
    corner = -L;
    corner.diagonal() = L.diagonal().cwiseInverse();
    return minus_L;
}

}  // namespace

MatrixXd gram(const Eigen::Ref<const RowMatrixXd>& A) {
    constexpr Index panel_rows = 128;  // so many stay in the cache, while all tiles pass
    const Index size = padded(A.cols(), most_columns);
    MatrixXd M = MatrixXd::Zero(size, size);
    RowMatrixXd panel(std::min(panel_rows, A.rows()), size);
    panel.rightCols(size - A.cols()).setZero();
    for (Index row = 0; row < A.rows(); row += panel_rows) {
        const Index rows = std::min(panel_rows, A.rows() - row);
        panel.topLeftCorner(rows, A.cols()) = A.middleRows(row, rows);
        simd::run(AddProduct{panel.data(), size, panel.data(), size, rows, M.data()});
    }
    return M.topLeftCorner(A.cols(), A.cols()).triangularView<Eigen::Lower>();
}

MatrixXd symmetric_gram(const Eigen::Ref<const RowMatrixXd>& A) {
    MatrixXd M = gram(A);
    M.triangularView<Eigen::StrictlyUpper>() = M.transpose();
    return M;
}

RowMatrixXd transposed_product(const Eigen::Ref<const RowMatrixXd>& A,
                               const Eigen::Ref<const RowMatrixXd>& B) {
    const Padded left(A, tile_rows);
    const Padded right(B, most_columns);
    RowMatrixXd M = RowMatrixXd::Zero(left.columns, right.columns);
    simd::run(AddProduct{left.data, left.columns, right.data, right.columns, A.rows(), M.data()});
    return M.topLeftCorner(A.cols(), B.cols());
}

Index whole_columns(Index columns) { return padded(columns, most_columns); }

MatrixXd cholesky(const MatrixXd& M) {
    const Index size = padded(M.rows(), most_columns);
    MatrixXd L = MatrixXd::Identity(size, size);
    L.topLeftCorner(M.rows(), M.rows()) = M;
    bool is_positive = true;
    simd::run(Factorise{L.data(), size, is_positive});
    if (!is_positive) return {};
    return L.topLeftCorner(M.rows(), M.rows()).triangularView<Eigen::Lower>();
}

RowMatrixXd solve_lower(const MatrixXd& L, const Eigen::Ref<const RowMatrixXd>& B) {
    const MatrixXd minus_L = as_divisor(L);
    RowMatrixXd X = RowMatrixXd::Zero(minus_L.rows(), padded(B.cols(), most_columns));
    X.topLeftCorner(B.rows(), B.cols()) = B;
    simd::run(SolveLower{minus_L.data(), minus_L.rows(), X.data(), X.cols()});
    return X.topLeftCorner(B.rows(), B.cols());
}

RowMatrixXd invert_lower(const MatrixXd& L) {
    const MatrixXd minus_L = as_divisor(L);
    RowMatrixXd X = RowMatrixXd::Identity(minus_L.rows(), padded(L.cols(), most_columns));
    simd::run(SolveLower{minus_L.data(), minus_L.rows(), X.data(), X.cols(), true});
    return X.topLeftCorner(L.rows(), L.cols());
}

}  // namespace posewise::detail
