#include "../../src/planner/refinement.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"
#include "support/derivative_check.hpp"
#include "support/fanuc_planning.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

/// Each criterion of a whole plan, those with kinks smoothed, by one pose of it.
TEST(DesignSpace, GivesTheGradientOfEveryCriterion) {
    Campaign campaign = fanuc_planning_campaign();
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{2e-5, 2e-5});
    campaign.joint_repeatability = VectorXd::Constant(6, 2e-5);
    const DesignSpace space = make_design_space(campaign, campaign.nominal);
    const RowMatrixXd plan = fanuc_pool(12);
    const Blocks test_poses =
        make_prediction_blocks(campaign, campaign.nominal, fanuc_workspace(9));
    MatrixXd rest = MatrixXd::Zero(33, 33);
    for (Index i = 1; i < 12; ++i) rest += space.information(plan.row(i).transpose());
    const VectorXd q = plan.row(0).transpose();
    for (const Criterion criterion : all_criteria) {
        for (const bool robot_only : {false, true}) {
            if (robot_only && (criterion == Criterion::G || criterion == Criterion::V)) continue;
            Objective objective = make_objective(criterion, 12, &test_poses);
            objective.sharpness = 20;
            if (robot_only) objective.nuisance = nuisance_of(Focus::Robot, campaign);
            const auto value = [&](const VectorXd& joints) -> VectorXd {
                return VectorXd::Constant(1, evaluate(objective, rest + space.information(joints)));
            };
            const VectorXd slope =
                space.information_gradient(q, gradient(objective, rest + space.information(q)));
            const VectorXd expected = numerical_jacobian(value, q, 4e-3).transpose();
            EXPECT_LE((slope - expected).norm(), 1e-5 * expected.norm())
                << criterion_name(criterion) << (robot_only ? ", robot only" : "");
        }
    }
}

TEST(RefinePoses, StaysFeasibleAndIsNeverWorseForAnyCriterion) {
    const Campaign campaign = fanuc_planning_campaign();
    DesignSpace space = make_design_space(campaign, campaign.nominal);
    space.margin = [](const VectorXd& q) { return 1.8 - q.tail<3>().norm(); };  // has a kink at 0
    space.least_joint_distance = 0.2;
    const Blocks test_poses =
        make_prediction_blocks(campaign, campaign.nominal, fanuc_workspace(20), 0);
    RowMatrixXd start(0, 6);
    const RowMatrixXd pool = fanuc_pool(300);
    for (Index i = 0; i < pool.rows() && start.rows() < 8; ++i) {
        if (space.margin(pool.row(i).transpose()) < 0) continue;
        start.conservativeResize(start.rows() + 1, 6);
        start.bottomRows(1) = pool.row(i);
    }
    RefineOptions options;
    options.round_limit = 2;
    options.tolerance = 1e-3;
    options.sharpness = {16};
    options.kink_rounds = 1;
    for (const Criterion criterion : all_criteria) {
        const Objective objective = make_objective(criterion, 8, &test_poses);
        const Refinement refined = refine_poses(space, objective, {}, start, options);
        EXPECT_GT(refined.value, refined.start_value) << criterion_name(criterion);
        MatrixXd M = MatrixXd::Zero(33, 33);
        for (Index i = 0; i < 8; ++i) {
            const VectorXd q = refined.configurations.row(i).transpose();
            M += space.information(q);
            EXPECT_GE(space.margin(q), 0);
            EXPECT_TRUE((q.array() >= space.lower.array()).all());
            EXPECT_TRUE((q.array() <= space.upper.array()).all());
            for (Index k = 0; k < i; ++k) {
                EXPECT_GE((refined.configurations.row(k).transpose() - q).cwiseAbs().maxCoeff(),
                          0.2);
            }
        }
        EXPECT_NEAR(evaluate(objective, M) / refined.value, 1, 1e-9);
    }
}

TEST(RefinePoses, AnInterruptedRefinementIsTheStartOrBetter) {
    const Campaign campaign = fanuc_planning_campaign();
    const DesignSpace space = make_design_space(campaign, campaign.nominal);
    const std::atomic<bool> interrupted = true;
    RefineOptions options;
    options.stop.interrupted = &interrupted;
    const RowMatrixXd start = fanuc_pool(10);
    const Refinement refined =
        refine_poses(space, make_objective(Criterion::D, 10), {}, start, options);
    EXPECT_EQ(refined.ending, Ending::Interrupted);
    EXPECT_EQ(refined.configurations, start);
}

TEST(RefinePoses, RefusesStartsItCannotRefine) {
    const Campaign campaign = fanuc_planning_campaign();
    const DesignSpace space = make_design_space(campaign, campaign.nominal);
    const Objective objective = make_objective(Criterion::D, 10);
    EXPECT_THROW(refine_poses(space, objective, {}, RowMatrixXd::Zero(10, 5)), InputError);
    EXPECT_THROW(refine_poses(space, objective, {}, RowMatrixXd::Constant(10, 6, 9)), InputError);
    EXPECT_THROW(refine_poses(space, objective, {}, RowMatrixXd::Zero(10, 6)), InputError);
}

}  // namespace
}  // namespace posewise
