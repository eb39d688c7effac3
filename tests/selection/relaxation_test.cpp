#include "../../src/selection/relaxation.hpp"

#include <gtest/gtest.h>

#include "../../src/criteria/objective.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;

TEST(Relax, HasTheWeightsOfItsCertificate) {
    for (const Criterion criterion : {Criterion::D, Criterion::A, Criterion::E, Criterion::V}) {
        for (std::uint64_t seed = 1; seed <= 6; ++seed) {
            SCOPED_TRACE(seed);
            const Blocks candidates = test::random_blocks(3000, 3, 12, seed);
            const Blocks tests = test::random_blocks(40, 3, 12, 100 + seed);
            SelectOptions options;
            options.criterion = criterion;
            options.pose_count = 6;
            options.gap = seed % 2 == 0 ? 1e-9 : 1e-3;
            const Objective objective = make_objective(criterion, options.pose_count, &tests);
            VectorXd start;
            if (seed > 3) start = VectorXd::Constant(3000, 6.0 / 3000);
            const Relaxation relaxation = relax(objective, candidates, options, start);
            ASSERT_EQ(relaxation.weights.size(), 3000);
            EXPECT_GE(relaxation.weights.minCoeff(), 0);
            EXPECT_NEAR(relaxation.weights.sum(), 6, 1e-9);
            MatrixXd M = MatrixXd::Zero(12, 12);
            for (Index i = 0; i < candidates.count(); ++i) {
                M += relaxation.weights[i] * candidates[i].transpose() * candidates[i];
            }
            const MatrixXd& certified = relaxation.certificate.M;
            EXPECT_LT((M - certified).norm(), 1e-9 * certified.norm());
        }
    }
}

}  // namespace
}  // namespace posewise
