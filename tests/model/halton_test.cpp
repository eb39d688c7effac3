#include "../../src/model/halton.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "support/robots.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::degree;
using testing::fanuc;
using testing::gantry_with_wrist;
using testing::planar_arm;

/// Two joints whose limits are 0 to 1, so that configurations are the sequence itself.
Chain unit_square() {
    const auto R = Motion::Rotation;
    return Chain({{"a", 0, 1}, {"b", 0, 1}},
                 {testing::driven(R, Axis::Z, 0), testing::driven(R, Axis::Z, 1)});
}

TEST(HaltonConfigurations, AreTheRadicalInversesOfTheIndex) {
    RowMatrixXd expected(6, 2);
    expected << 1. / 2, 1. / 3, 1. / 4, 2. / 3, 3. / 4, 1. / 9, 1. / 8, 4. / 9, 5. / 8, 7. / 9,
        3. / 8, 2. / 9;
    EXPECT_LT((halton_configurations(unit_square(), 6) - expected).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((halton_configurations(unit_square(), 2, {{}, 3, {}}) - expected.middleRows(2, 2))
                  .cwiseAbs()
                  .maxCoeff(),
              1e-15);
    const RowMatrixXd swapped = halton_configurations(unit_square(), 6, {{3, 2}, 1, {}});
    EXPECT_LT((swapped.col(0) - expected.col(1)).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(HaltonConfigurations, FillTheJointLimits) {
    const Chain robot = fanuc();
    for (const auto& seed : {std::optional<std::uint64_t>(), std::optional<std::uint64_t>(4)}) {
        const RowMatrixXd q = halton_configurations(robot, 500, {{}, 1, seed});
        for (Index j = 0; j < 6; ++j) {
            const Joint& joint = robot.joints()[static_cast<std::size_t>(j)];
            const double range = joint.upper - joint.lower;
            EXPECT_GE(q.col(j).minCoeff(), joint.lower);
            EXPECT_LE(q.col(j).minCoeff(), joint.lower + 0.02 * range);
            EXPECT_LE(q.col(j).maxCoeff(), joint.upper);
            EXPECT_GE(q.col(j).maxCoeff(), joint.upper - 0.02 * range);
            EXPECT_NEAR(q.col(j).mean(), joint.lower + range / 2, 0.01 * range);
        }
    }
}

TEST(HaltonConfigurations, HaveEqualCountsInEqualBoxesAlsoWhenScrambled) {
    for (const auto& seed : {std::optional<std::uint64_t>(), std::optional<std::uint64_t>(9)}) {
        const RowMatrixXd q = halton_configurations(unit_square(), 4 * 9 * 5, {{}, 36, seed});
        Eigen::Matrix<int, 4, 9> counts = Eigen::Matrix<int, 4, 9>::Zero();
        for (Index i = 0; i < q.rows(); ++i) {
            ++counts(static_cast<Index>(4 * q(i, 0)), static_cast<Index>(9 * q(i, 1)));
        }
        EXPECT_EQ(counts.minCoeff(), 5);
        EXPECT_EQ(counts.maxCoeff(), 5);
    }
}

TEST(HaltonConfigurations, ScrambledOnesDependOnTheSeedAndBreakTheRunsOfLargeBases) {
    const Chain robot = fanuc();
    const RowMatrixXd q = halton_configurations(robot, 40, {{}, 1, 1});
    EXPECT_EQ(halton_configurations(robot, 20, {{}, 1, 1}), q.topRows(20));
    EXPECT_NE(halton_configurations(robot, 40, {{}, 1, 2}), q);
    // The first ten points of bases 11 and 13 lie on a straight line in the plain sequence.
    const auto correlation = [](const RowMatrixXd& points) {
        const VectorXd x = points.col(4).head(10).array() - points.col(4).head(10).mean();
        const VectorXd y = points.col(5).head(10).array() - points.col(5).head(10).mean();
        return x.dot(y) / (x.norm() * y.norm());
    };
    EXPECT_GT(correlation(halton_configurations(robot, 10)), 0.999);
    EXPECT_LT(std::abs(correlation(q)), 0.9);
}

TEST(HaltonConfigurations, RejectBasesThatDoNotFit) {
    const Chain robot = unit_square();
    EXPECT_THROW(halton_configurations(robot, 5, {{2}, 1, {}}), InputError);
    EXPECT_THROW(halton_configurations(robot, 5, {{2, 1}, 1, {}}), InputError);
    EXPECT_THROW(halton_configurations(robot, 5, {{2, 4}, 1, {}}), InputError);
    EXPECT_THROW(halton_configurations(robot, 5, {{2, 1000003}, 1, {}}), InputError);
    EXPECT_THROW(halton_configurations(robot, -1), InputError);
    EXPECT_THROW(halton_configurations(robot, 5, {{}, -1, {}}), InputError);
    EXPECT_EQ(halton_configurations(robot, 0).rows(), 0);
}

TEST(WithMargin, DrawsInTheLimitsOfEachKindOfJoint) {
    const Chain robot = with_margin(gantry_with_wrist(), {5 * degree, 0.01});
    EXPECT_DOUBLE_EQ(robot.joints()[0].lower, 0.01);
    EXPECT_DOUBLE_EQ(robot.joints()[0].upper, 1.99);
    EXPECT_DOUBLE_EQ(robot.joints()[3].upper, 3 - 5 * degree);
    EXPECT_THROW(with_margin(gantry_with_wrist(), {0, 0.6}), InputError);
    EXPECT_THROW(with_margin(planar_arm({1}), {-0.1, 0}), InputError);
    EXPECT_THROW(with_margin(planar_arm({1}), {std::nan(""), 0}), InputError);
}

}  // namespace
}  // namespace posewise
