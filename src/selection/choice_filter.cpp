#include "choice_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "criteria/prediction.hpp"
#include "lane_kernels.hpp"

namespace posewise::detail {
namespace {

constexpr double margin = 1e-6;  // relative, far above the rounding of regular matrices
constexpr double witness_sharpness = 16;

/// Entry k of the lanes is at k * parts<V> behind this.
template <typename V>
POSEWISE_INLINE V* in(std::vector<Lane>& lanes, int part) {
    return &at<V>(lanes.data(), part);
}
template <typename V>
constexpr int parts = lane_width / simd::width<V>;

/// Factorises M in place, the pivots on the diagonal; their least over all columns.
struct Factorise {
    Index size;
    std::vector<Lane>& M;
    Lane& least;

    template <typename V>
    POSEWISE_INLINE void run_part(Index, int part) const {
        V* const m = in<V>(M, part);
        V smallest = m[0];
        for (Index k = 0; k < size; ++k) {
            const V pivot = m[packed(k, k) * parts<V>];
            smallest = pivot < smallest ? pivot : smallest;
            const V inverse = 1.0 / pivot;
            for (Index i = k + 1; i < size; ++i) {
                V* const row = m + packed(i, 0) * parts<V>;
                const V factor = row[k * parts<V>] * inverse;
                for (Index j = k + 1; j <= i; ++j) {
                    row[j * parts<V>] -= factor * m[packed(j, k) * parts<V>];
                }
            }
            for (Index i = k + 1; i < size; ++i) m[packed(i, k) * parts<V>] *= inverse;
        }
        at<V>(&least, part) = smallest;
    }
};

/// A root T of what is summed up, M factorised.
struct Root {
    Index size;
    Index first;  // rows before it are zero
    std::vector<Lane>& M;
    std::vector<Lane>& root;
    Lane& sum;
};

/// root = L^-1 T in place; the sum of its squares over the pivots.
struct SolveRoot : Root {
    template <typename V>
    POSEWISE_INLINE void run_part(Index, int part) const {
        V* const m = in<V>(M, part);
        V* const y = in<V>(root, part);
        V total = {};
        for (Index k = first; k < size; ++k) {
            const V* const solved = y + packed(k, 0) * parts<V>;
            V squares = {};
            for (Index j = first; j <= k; ++j)
                squares += solved[j * parts<V>] * solved[j * parts<V>];
            total += squares / m[packed(k, k) * parts<V>];
            for (Index i = k + 1; i < size; ++i) {
                V* const row = y + packed(i, 0) * parts<V>;
                const V factor = m[packed(i, k) * parts<V>];
                for (Index j = first; j <= k; ++j)
                    row[j * parts<V>] -= factor * solved[j * parts<V>];
            }
        }
        at<V>(&sum, part) = total;
    }
};

/// The sum of squares of all entries of the inverse, from what SolveRoot left.
struct SquareInverse : Root {
    template <typename V>
    POSEWISE_INLINE void run_part(Index, int part) const {
        const V* const m = in<V>(M, part);
        const V* const y = in<V>(root, part);
        V total = {};
        for (Index a = first; a < size; ++a) {
            for (Index b = first; b <= a; ++b) {
                V product = {};
                for (Index j = first; j <= b; ++j) {
                    product += y[packed(a, j) * parts<V>] * y[packed(b, j) * parts<V>];
                }
                const double times = a == b ? 1 : 2;
                total += times * product * product /
                         (m[packed(a, a) * parts<V>] * m[packed(b, b) * parts<V>]);
            }
        }
        at<V>(&sum, part) = total;
    }
};

/// The sum of the products of the entries of R = D^-1/2 L^-1, from what SolveRoot left, and of Q.
/// The pivots of M are replaced by their inverse roots.
struct NuclearProduct : Root {
    const std::vector<double>& Q;  // packed

    template <typename V>
    POSEWISE_INLINE void run_part(Index, int part) const {
        const V* const m = in<V>(M, part);
        const V* const y = in<V>(root, part);
        V total = {};
        for (Index i = first; i < size; ++i) {
            V product = {};
            for (Index j = first; j <= i; ++j) {
                product += Q[static_cast<std::size_t>(packed(i, j))] * y[packed(i, j) * parts<V>];
            }
            total += product * m[packed(i, i) * parts<V>];
        }
        at<V>(&sum, part) = total;
    }
};

/// The orthogonal factor of R = D^-1/2 L^-1 of M, packed, of the columns from `first` on.
std::vector<double> polar_factor(const MatrixXd& M, Index first) {
    const Index size = M.rows();
    const Index interest = size - first;
    const MatrixXd inverse =
        Eigen::LLT<MatrixXd>(M).matrixL().solve(MatrixXd::Identity(size, size));
    const MatrixXd R = inverse.bottomRightCorner(interest, interest);
    const auto eigen = eigen_decomposition(R.transpose() * R);
    const MatrixXd& V = eigen.eigenvectors();
    const MatrixXd polar =
        R * (V * eigen.eigenvalues().cwiseSqrt().cwiseInverse().asDiagonal() * V.transpose());
    std::vector<double> result(static_cast<std::size_t>(packed(size, 0)), 0);
    for (Index i = 0; i < interest; ++i) {
        for (Index j = 0; j <= i; ++j) {
            result[static_cast<std::size_t>(packed(first + i, first + j))] = polar(i, j);
        }
    }
    return result;
}

/// The lower root of the mean information of the test poses, the more of each the worse it is
/// predicted from M.
MatrixXd worst_root(const Objective& objective, const MatrixXd& M) {
    Objective softened = objective;
    softened.sharpness = witness_sharpness;
    const VectorXd weights = worst_variance(softened, Eigen::LLT<MatrixXd>(M)).slope;
    return lower_root_of_gram(weighted_rows(*objective.test_poses, weights / weights.sum()));
}

}  // namespace

ChoiceFilter::ChoiceFilter(const Objective& objective, const MatrixXd& M)
    : objective_(objective),
      test_(Test::Trace),
      order_(objective.nuisance),
      nuisance_(static_cast<Index>(objective.nuisance.size())) {
    const Index L = M.rows();
    packed_size_ = packed(L, 0) + 1;
    for (Index i = 0; i < L; ++i) {
        if (!std::binary_search(objective.nuisance.begin(), objective.nuisance.end(), i)) {
            order_.push_back(i);
        }
    }
    strongest_ = eigen_decomposition(M).eigenvectors().rightCols(1);
    MatrixXd T = MatrixXd::Identity(L, L);
    T.topLeftCorner(nuisance_, nuisance_).setZero();
    switch (objective.criterion) {
        case Criterion::D:
        case Criterion::O1:
            test_ = Test::Determinant;
            return;
        case Criterion::A:
            break;
        case Criterion::V:
            T = objective.mean_test_root;
            break;
        case Criterion::G:
            T = worst_root(objective, M);
            break;
        case Criterion::O5:
            test_ = Test::Nuclear;
            polar_ = polar_factor(M(order_, order_), nuisance_);
            break;
        default:
            test_ = Test::Shift;
            return;
    }
    for (Index i = 0; i < L; ++i) {
        for (Index j = 0; j <= i; ++j) root_.push_back(T(i, j));
    }
}

VectorXd ChoiceFilter::pack(const MatrixXd& M) const {
    VectorXd result(packed_size_);
    for (Index i = 0; i < M.rows(); ++i) {
        for (Index j = 0; j <= i; ++j) {
            result[packed(i, j)] =
                M(order_[static_cast<std::size_t>(i)], order_[static_cast<std::size_t>(j)]);
        }
    }
    result[packed_size_ - 1] = strongest_.dot(M * strongest_);
    return result;
}

ChoiceFilter::Batch ChoiceFilter::make_batch() const {
    Batch batch;
    batch.M.resize(static_cast<std::size_t>(packed_size_));
    batch.root.resize(root_.size());
    return batch;
}

void ChoiceFilter::add(const double* a, const double* b, Batch& batch) const {
    const auto at = static_cast<std::size_t>(batch.count++);
    for (Index k = 0; k < packed_size_; ++k) {
        batch.M[static_cast<std::size_t>(k)].of[at] = a[k] + b[k];
    }
}

/// The factors are those of M up to L eps of its diagonal, in each entry.
void ChoiceFilter::raise(Batch& batch) const {
    const auto L = static_cast<Index>(order_.size());
    const double factor =
        1 + 2 * static_cast<double>(L * L) * std::numeric_limits<double>::epsilon();
    for (Index i = 0; i < L; ++i) {
        for (double& one : batch.M[static_cast<std::size_t>(packed(i, i))].of) one *= factor;
    }
}

/// For the least eigenvalue to be large enough beside the largest, which is no less than M along
/// any direction.
void ChoiceFilter::subtract_shift(double value, Batch& batch) const {
    const auto L = static_cast<Index>(order_.size());
    const Lane& strongest = batch.M.back();
    Lane shift;
    for (std::size_t lane = 0; lane < lane_width; ++lane) {
        const double along = strongest.of[lane];
        const double least = objective_.criterion == Criterion::E    ? value
                             : objective_.criterion == Criterion::O3 ? value * value
                             : objective_.criterion == Criterion::O2 ? value * value * along
                                                                     : value * std::sqrt(along);
        shift.of[lane] = least * (1 - margin) - 1e-14 * along;
    }
    for (Index i = nuisance_; i < L; ++i) {
        Lane& diagonal = batch.M[static_cast<std::size_t>(packed(i, i))];
        for (std::size_t lane = 0; lane < lane_width; ++lane) diagonal.of[lane] -= shift.of[lane];
    }
}

void ChoiceFilter::invert_pivots(Batch& batch) const {
    for (Index i = nuisance_; i < static_cast<Index>(order_.size()); ++i) {
        for (double& pivot : batch.M[static_cast<std::size_t>(packed(i, i))].of) {
            pivot = 1 / std::sqrt(pivot);
        }
    }
}

bool ChoiceFilter::may_reach(double value, double sum) const {
    if (test_ == Test::Shift) return true;
    if (test_ != Test::Determinant) return 1 / sum >= value * (1 - margin);
    const Index interest = static_cast<Index>(order_.size()) - nuisance_;
    const double reached = value_of_log_determinant(objective_, sum, interest);
    return reached >= value - margin * std::max(1.0, std::abs(value));
}

std::array<bool, lane_width> ChoiceFilter::may_reach(double value, Batch& batch) const {
    const auto L = static_cast<Index>(order_.size());
    raise(batch);
    if (test_ == Test::Shift) subtract_shift(value, batch);
    Lane least;
    Lane sum;
    Lane squares;
    Lane fourth;
    run_on_lanes(1, Factorise{L, batch.M, least});
    if (!root_.empty()) {
        for (std::size_t k = 0; k < root_.size(); ++k) batch.root[k].of.fill(root_[k]);
        const Index first = objective_.test_poses == nullptr ? nuisance_ : 0;
        const Root root{L, first, batch.M, batch.root, sum};
        run_on_lanes(1, SolveRoot{root});
        if (test_ == Test::Nuclear) {
            run_on_lanes(1, SquareInverse{{L, first, batch.M, batch.root, fourth}});
            squares = sum;
            invert_pivots(batch);
            run_on_lanes(1, NuclearProduct{root, polar_});
        }
    }
    std::array<bool, lane_width> result{};
    for (std::size_t lane = 0; lane < static_cast<std::size_t>(batch.count); ++lane) {
        if (!(least.of[lane] > 0)) continue;
        for (Index i = nuisance_; test_ == Test::Determinant && i < L; ++i) {
            sum.of[lane] += logarithm(batch.M[static_cast<std::size_t>(packed(i, i))].of[lane]);
        }
        if (test_ == Test::Nuclear) {
            // Of x = 1 / s by Hoelder: sum x >= (sum x^2)^(3/2) / (sum x^4)^(1/2).
            const double square = squares.of[lane];
            sum.of[lane] = std::max(sum.of[lane], square * std::sqrt(square / fourth.of[lane]));
        }
        result[lane] = may_reach(value, sum.of[lane]);
    }
    batch.count = 0;
    return result;
}

}  // namespace posewise::detail
