#include "../../src/selection/working_set.hpp"

#include <gtest/gtest.h>

#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

/// Members 7, 2 and then 100 more, compared with sums over the candidates themselves.
TEST(WorkingSet, MatchesSumsOverItsMembers) {
    const Blocks candidates = test::random_blocks(120, 3, 5, 1);
    WorkingSet set(candidates);
    set.add({7, 2});
    std::vector<Index> more;
    for (Index i = 119; i >= 20; --i) more.push_back(i);
    set.add(more);
    ASSERT_EQ(set.size(), 102);
    EXPECT_EQ(set.members()[0], 7);
    EXPECT_EQ(set.members()[1], 2);
    EXPECT_EQ(set.members()[101], 20);

    RandomStream random(2, 0);
    VectorXd weights(set.size());
    for (double& weight : weights) weight = random.uniform();
    const MatrixXd Z = information(test::random_blocks(6, 1, 5, 3));
    const VectorXd d = set.sensitivities(Z);
    MatrixXd M = MatrixXd::Zero(5, 5);
    for (Index k = 0; k < set.size(); ++k) {
        const auto B = candidates[set.members()[static_cast<std::size_t>(k)]];
        M += weights[k] * B.transpose() * B;
        const double expected = (B * Z * B.transpose()).trace();
        EXPECT_NEAR(d[k], expected, 1e-12 * expected);
    }
    const MatrixXd found = set.weighted_information(weights);
    EXPECT_TRUE(found.isApprox(M, 1e-13));
    EXPECT_EQ(found, found.transpose());
}

TEST(WorkingSet, SensitivityIsTheSlopeOfTheWeightedInformation) {
    const Blocks candidates = test::random_blocks(9, 2, 4, 5);
    WorkingSet set(candidates);
    set.add({0, 3, 8});
    const MatrixXd Z = information(test::random_blocks(6, 1, 4, 6));
    const VectorXd d = set.sensitivities(Z);
    for (Index k = 0; k < 3; ++k) {
        const MatrixXd M = set.weighted_information(VectorXd::Unit(3, k));
        EXPECT_NEAR(d[k], Z.cwiseProduct(M).sum(), 1e-12 * d[k]);
    }
}

}  // namespace
}  // namespace posewise
