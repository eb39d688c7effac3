#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "posewise/core/blocks.hpp"

namespace posewise {

/// A scalar rating of an information matrix; larger is better. s1 >= ... >= sL are the singular
/// values of the stacked blocks of m poses, and M = J^T J is their information matrix.
enum class Criterion {
    O1,  ///< (s1 ... sL)^(1/L) / sqrt(m) [Borm & Menq 1991]: overall; same ranking as D at fixed m
    O2,  ///< sL / s1 [Driels & Pathre 1990]: inverse condition number
    O3,  ///< sL [Nahvi & Hollerbach 1996]: the worst direction
    O4,  ///< sL^2 / s1 [Nahvi & Hollerbach 1996]: noise amplification
    O5,  ///< 1 / (1/s1 + ... + 1/sL) [Sun & Hollerbach 2008]
    A,   ///< 1 / trace(M^-1): mean parameter variance
    D,   ///< log det M: volume of the confidence ellipsoid; free of scales
    E,   ///< smallest eigenvalue of M: variance of the worst direction
    G,   ///< 1 / largest trace(B0 M^-1 B0^T) over test poses: worst prediction
    V,   ///< 1 / mean trace(B0 M^-1 B0^T) over test poses (also called I): mean prediction
};

/// All criteria, in the order that reports show.
inline constexpr std::array all_criteria{Criterion::O1, Criterion::O2, Criterion::O3, Criterion::O4,
                                         Criterion::O5, Criterion::A,  Criterion::D,  Criterion::E,
                                         Criterion::G,  Criterion::V};

/// Whether the criterion rates predictions at test poses.
constexpr bool needs_test_poses(Criterion criterion) {
    return criterion == Criterion::G || criterion == Criterion::V;
}

/// Whether the criterion has a derivative at every regular M; the others have kinks where the
/// extreme eigenvalue or the worst test pose changes.
constexpr bool is_smooth(Criterion criterion) {
    return criterion == Criterion::O1 || criterion == Criterion::O5 || criterion == Criterion::A ||
           criterion == Criterion::D || criterion == Criterion::V;
}

/// Whether the value is a logarithm, so that plans compare by differences, not ratios.
constexpr bool is_logarithm(Criterion criterion) { return criterion == Criterion::D; }

/// Lower-case name as on the command line ("o1", ..., "v").
std::string_view criterion_name(Criterion criterion);

/// Inverse of criterion_name(). Accepts upper case, and "i" for V. Throws InputError listing all.
Criterion parse_criterion(std::string_view name);

/// Singular values of stacked blocks, largest first, by QR and SVD of R, so that small ones keep
/// their digits. Padded with zeros to parameter_count().
VectorXd singular_values(const RowMatrixXd& stacked);

/// The criterion from the singular values of m poses, largest first. Returns minus infinity if they
/// are singular (sL <= 1e-12 s1). Throws InputError for G and V, which need test poses.
double evaluate(Criterion criterion, const VectorXd& singular_values, Index pose_count);

/// The criterion of the stacked blocks (rows x parameters) of m poses, by QR of the rows, which
/// keeps more digits than their information matrix. Only G and V need `test_poses`. Never NaN:
/// returns minus infinity if the rows do not identify all parameters (at most 1e-10 of a column is
/// independent of the others).
double evaluate_rows(Criterion criterion, const RowMatrixXd& stacked, Index pose_count,
                     const Blocks* test_poses = nullptr);

/// The criterion from the information matrix of m poses. Only G and V need `test_poses`. Never NaN:
/// returns minus infinity if M is singular or not positive definite.
double evaluate(Criterion criterion, const MatrixXd& M, Index pose_count,
                const Blocks* test_poses = nullptr);

}  // namespace posewise
