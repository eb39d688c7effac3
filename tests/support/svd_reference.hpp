#pragma once

#include <Eigen/SVD>
#include <cmath>
#include <limits>

#include "posewise/criteria/criterion.hpp"

/// Criteria of stacked rows by the singular values of the rows themselves in extended precision:
/// written independently of the library, and right where double precision is not.
namespace posewise::test {

using LongMatrix = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
using LongVector = Eigen::Matrix<long double, Eigen::Dynamic, 1>;

struct RowReference {
    double value = -std::numeric_limits<double>::infinity();
    /// The largest over the least singular value; infinity where there are fewer rows than columns.
    double condition = std::numeric_limits<double>::infinity();
};

/// Mean and largest variance over test poses, V those of x = V S^-1 z.
struct ReferenceVariances {
    long double mean = 0;
    long double largest = 0;
};
inline ReferenceVariances reference_variances(const Blocks& test_poses, const LongMatrix& root) {
    ReferenceVariances variances;
    for (Index i = 0; i < test_poses.count(); ++i) {
        const LongMatrix block = test_poses[i].cast<long double>();
        const long double one = (block * root).squaredNorm();
        variances.mean += one / static_cast<long double>(test_poses.count());
        variances.largest = std::max(variances.largest, one);
    }
    return variances;
}

inline RowReference reference_value(Criterion criterion, const RowMatrixXd& stacked,
                                    Index pose_count, const Blocks& test_poses) {
    const Index L = stacked.cols();
    if (stacked.rows() < L) return {};
    const LongMatrix rows = stacked.cast<long double>();
    const Eigen::JacobiSVD<LongMatrix> svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
    const LongVector s = svd.singularValues();
    if (!(s[L - 1] > 1e-17L * s[0])) return {};
    const long double logs = s.array().log().sum();
    const LongMatrix root = svd.matrixV() * s.cwiseInverse().asDiagonal();
    const auto value = [&]() -> long double {
        switch (criterion) {
            case Criterion::O1:
                return std::exp(logs / static_cast<long double>(L)) /
                       std::sqrt(static_cast<long double>(pose_count));
            case Criterion::O2:
                return s[L - 1] / s[0];
            case Criterion::O3:
                return s[L - 1];
            case Criterion::O4:
                return s[L - 1] * s[L - 1] / s[0];
            case Criterion::O5:
                return 1 / s.cwiseInverse().sum();
            case Criterion::A:
                return 1 / s.cwiseInverse().squaredNorm();
            case Criterion::D:
                return 2 * logs;
            case Criterion::E:
                return s[L - 1] * s[L - 1];
            case Criterion::G:
                return 1 / reference_variances(test_poses, root).largest;
            default:
                return 1 / reference_variances(test_poses, root).mean;
        }
    };
    return {static_cast<double>(value()), static_cast<double>(s[0] / s[L - 1])};
}

/// How far a value may be from the reference: some rounding times the condition number.
inline double reference_tolerance(const RowReference& reference) {
    const double relative = 1e-13 + 1e-14 * reference.condition;
    return relative * std::max(1.0, std::abs(reference.value));
}

}  // namespace posewise::test
