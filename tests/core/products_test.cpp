#include "../../src/core/products.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace posewise::detail {
namespace {

MatrixXd lower(const MatrixXd& M) { return M.triangularView<Eigen::Lower>(); }

TEST(Products, AreThoseOfEigen) {
    for (const Index rows : {1, 3, 127, 300}) {
        for (const Index size : {0, 1, 5, 16, 33, 90}) {
            const RowMatrixXd A = RowMatrixXd::Random(rows, size);
            const MatrixXd expected = lower(A.transpose() * A);
            const MatrixXd found = gram(A);
            ASSERT_EQ(found.rows(), size);
            EXPECT_LE((found - expected).norm(), 1e-14 * (1 + expected.norm()));

            EXPECT_EQ(lower(symmetric_gram(A)), found);
            EXPECT_EQ(symmetric_gram(A), symmetric_gram(A).transpose());
            const RowMatrixXd B = RowMatrixXd::Random(rows, 7);
            const MatrixXd product = transposed_product(A, B);
            ASSERT_EQ(product.rows(), size);
            EXPECT_LE((product - A.transpose() * B).norm(), 1e-13 * (1 + product.norm()));

            MatrixXd L = MatrixXd::Random(size, size);
            L.diagonal().array() += 3 * static_cast<double>(size);
            const RowMatrixXd X = solve_lower(L, A.transpose());
            ASSERT_EQ(X.cols(), rows);
            EXPECT_LE((lower(L) * X - A.transpose()).norm(), 1e-14 * (1 + A.norm()));
            const auto identity = RowMatrixXd::Identity(size, size);
            EXPECT_EQ(invert_lower(L), solve_lower(L, identity));
        }
    }
}

TEST(Products, FactoriseWhatIsPositiveDefinite) {
    for (const Index size : {0, 1, 3, 4, 17, 90}) {
        const MatrixXd A = MatrixXd::Random(2 * size + 1, size);
        const MatrixXd M = A.transpose() * A;
        const MatrixXd L = cholesky(lower(M));
        ASSERT_EQ(L.rows(), size);
        EXPECT_LE((L * L.transpose() - M).norm(), 1e-14 * M.norm());
        EXPECT_EQ(L, lower(L));
    }
    MatrixXd M = MatrixXd::Identity(20, 20);
    M(17, 17) = -1e-3;
    EXPECT_EQ(cholesky(M).size(), 0);
    M(17, 17) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_EQ(cholesky(M).size(), 0);
}

TEST(Products, SumRowsOneAfterTheOther) {
    RowMatrixXd A(200, 3);
    for (Index k = 0; k < A.rows(); ++k) A.row(k) << 1e8, 1, 1e-8 * static_cast<double>(k);
    double sum = 0;
    for (Index k = 0; k < A.rows(); ++k) sum += A(k, 2);
    EXPECT_EQ(gram(A)(2, 1), sum);
}

}  // namespace
}  // namespace posewise::detail
