#include "../../src/selection/root_traces.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

TEST(InverseRoot, HasNineDigitsOverItsRange) {
    for (const double ratio : {1.0, 10.0, 1e4, 1e8, 1e12}) {
        const double least = 0.3;
        const InverseRoot root = make_inverse_root(least, least * ratio);
        const auto sum_at = [&](double x) {
            double sum = 0;
            for (std::size_t k = 0; k < root.shifts.size(); ++k) {
                sum += root.weights[k] / (x + root.shifts[k]);
            }
            return sum;
        };
        for (double part = 0; part <= 1; part += 0.05) {
            const double x = least * std::pow(ratio, part);
            EXPECT_NEAR(sum_at(x) * std::sqrt(x), 1, 1e-9) << ratio << ' ' << part;
        }
        for (const double x : {0.0, 0.1 * least, 0.9 * least}) EXPECT_GT(sum_at(x), sum_at(least));
    }
}

TEST(RootTraces, AreThoseOfEigenvalues) {
    for (const Index parameters : {1, 2, 3, 9, 33}) {
        for (const Index rows : {1, 9, 14}) {
            const Blocks candidates = test::random_blocks(11, rows, parameters, 1);
            MatrixXd M = information(test::random_blocks(parameters, 1, parameters, 2));
            M.diagonal().array() += 1e-3;
            M.row(0).setZero();  // a direction that needs no reflection where the block has none
            M.col(0).setZero();
            M(0, 0) = 2;
            std::vector<Index> all;
            for (Index i = 0; i < 11; ++i) all.push_back(i);
            const InverseRoot root = make_inverse_root(1e-5, 1e4);
            const auto traces =
                RootTraces(M, root).compute(make_lane_blocks(candidates, all, rows));
            for (std::size_t i = 0; i < 11; ++i) {
                const auto block = candidates[static_cast<Index>(i)];
                const MatrixXd with = M + block.transpose() * block;
                const double expected = Eigen::SelfAdjointEigenSolver<MatrixXd>(with)
                                            .eigenvalues()
                                            .array()
                                            .rsqrt()
                                            .sum();
                EXPECT_NEAR(traces[i / lane_width].of[i % lane_width], expected, 1e-9 * expected)
                    << parameters << ' ' << rows << ' ' << i;
            }
        }
    }
}

}  // namespace
}  // namespace posewise
