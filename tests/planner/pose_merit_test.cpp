#include "../../src/planner/pose_merit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "support/designs.hpp"

namespace posewise::detail {
namespace {

constexpr Criterion quick_criteria[] = {Criterion::D, Criterion::O1, Criterion::A, Criterion::V};

/// 8 poses of three rows and 15 parameters; the last is the one that moves.
class OnePose : public ::testing::Test {
  protected:
    Objective objective(Criterion criterion) const {
        return make_objective(criterion, 8, &blocks_);
    }
    /// The merit as it is by a factorisation of M.
    double expected(Criterion criterion, const MatrixXd& M) const {
        const double value = evaluate(objective(criterion), M);
        return is_logarithm(criterion) ? value : std::log(value);
    }

    Blocks blocks_ = test::random_blocks(8, 3, 15, 1);
    RowMatrixXd B_ = blocks_[7];
    MatrixXd R_ = information(blocks_, {0, 1, 2, 3, 4, 5, 6});
};

TEST_F(OnePose, HasTheMeritAndTheSlopeOfTheWholePlan) {
    for (const Criterion criterion : quick_criteria) {
        const auto merit = PoseMerit::make(objective(criterion), R_, B_);
        ASSERT_TRUE(merit) << criterion_name(criterion);
        const MatrixXd M = R_ + B_.transpose() * B_;
        RowMatrixXd BZ;
        const double value = merit->evaluate(B_, &BZ);
        EXPECT_NEAR(value, expected(criterion, M), 1e-12 * (1 + std::abs(value)));
        MatrixXd Z = gradient(objective(criterion), M);
        if (!is_logarithm(criterion)) Z /= evaluate(objective(criterion), M);
        EXPECT_LE((BZ - B_ * Z).norm(), 1e-10 * BZ.norm()) << criterion_name(criterion);
    }
}

TEST_F(OnePose, ThatShowsNothingLeavesTheOthers) {
    for (const Criterion criterion : quick_criteria) {
        const auto merit = PoseMerit::make(objective(criterion), R_, B_);
        ASSERT_TRUE(merit);
        RowMatrixXd BZ;
        const double value = merit->evaluate(RowMatrixXd(0, 15), &BZ);
        EXPECT_NEAR(value, expected(criterion, R_), 1e-12 * (1 + std::abs(value)));
        EXPECT_EQ(BZ.rows(), 0);
        EXPECT_EQ(BZ.cols(), 15);
    }
}

TEST_F(OnePose, IsNotQuickWhereDigitsWouldBeLostOrForOtherCriteria) {
    for (const Criterion criterion : all_criteria) {
        const bool is_quick =
            std::ranges::count(std::begin(quick_criteria), std::end(quick_criteria), criterion) > 0;
        EXPECT_EQ(PoseMerit::make(objective(criterion), R_, B_).has_value(), is_quick);
        EXPECT_FALSE(PoseMerit::make(objective(criterion), MatrixXd(R_ * 0), B_));
    }
    Objective partial = objective(Criterion::D);
    partial.nuisance = {0};
    EXPECT_FALSE(PoseMerit::make(partial, R_, B_));
    // Four poses leave three directions open but for a weak prior: the fifth does nearly all.
    const MatrixXd weak = information(blocks_, {0, 1, 2, 3}) + 1e-8 * MatrixXd::Identity(15, 15);
    EXPECT_FALSE(PoseMerit::make(objective(Criterion::A), weak, B_));
    EXPECT_FALSE(PoseMerit::make(objective(Criterion::V), weak, B_));
}

}  // namespace
}  // namespace posewise::detail
