#pragma once

#include <gtest/gtest.h>

#include "posewise/core/types.hpp"

/// The one harness for every derivative: analytic against numerical.
namespace posewise::testing {

/// Jacobian of f: R^n -> R^m at x by central differences at h and h / 2, extrapolated
/// [Richardson 1911]: error h^4 f''''' / 480, about 1e-13 for the trigonometry of a robot.
template <typename Function>
MatrixXd numerical_jacobian(const Function& f, const VectorXd& x, double h = 2e-3) {
    MatrixXd J;
    for (Index k = 0; k < x.size(); ++k) {
        const auto slope = [&](double step) -> VectorXd {
            const VectorXd shift = step * VectorXd::Unit(x.size(), k);
            return (f(VectorXd(x + shift)) - f(VectorXd(x - shift))) / (2 * step);
        };
        const VectorXd column = (4 * slope(h / 2) - slope(h)) / 3;
        if (k == 0) J.resize(column.size(), x.size());
        J.col(k) = column;
    }
    return J;
}

/// Every column agrees with the numerical one to 1e-8 of its norm (columns that are zero: to
/// 1e-11 of the largest).
template <typename Function>
void expect_is_jacobian(const MatrixXd& J, const Function& f, const VectorXd& x) {
    const MatrixXd expected = numerical_jacobian(f, x);
    ASSERT_EQ(J.rows(), expected.rows());
    ASSERT_EQ(J.cols(), expected.cols());
    ASSERT_TRUE(J.allFinite());
    const double largest = expected.colwise().norm().maxCoeff();
    for (Index k = 0; k < J.cols(); ++k) {
        const double error = (J.col(k) - expected.col(k)).norm();
        EXPECT_LE(error, 1e-8 * expected.col(k).norm() + 1e-11 * largest) << "column " << k;
    }
}

}  // namespace posewise::testing
