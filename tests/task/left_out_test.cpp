#include "../../src/task/plan/left_out.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "../../src/model/complete_model.hpp"
#include "../../src/task/plan/workspace.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/planning.hpp"
#include "support/campaigns.hpp"
#include "support/cells.hpp"
#include "support/held_robot.hpp"

namespace posewise {
namespace {

/// A robot with geometric errors only, planned for, and with all errors, as it is.
class ErrorsLeftOutOfAPlan : public ::testing::Test {
  protected:
    ErrorsLeftOutOfAPlan() {
        const Chain bare = without_parameters(testing::cell_campaign().robot);
        const Campaign cell = testing::cell_campaign();
        poorer_ = with_robot(cell, detail::complete_model(bare));
        poorer_.spread = population_spread(bare);
        richer_ = with_robot(poorer_, detail::full_model(bare));
        options_.pose_count = 14;
        options_.pool_count = 100;
        options_.starts = 1;
        options_.workspace_count = 20;
        options_.richer = [&] { return std::vector<OtherCampaign>{{"errors: full", richer_}}; };
    }

    /// Mean square error of a calibrated robot's targets at the workspace, m^2.
    double error_of(const Campaign& fitted, const Parameters& truth, const Parameters& found,
                    const RowMatrixXd& workspace) const {
        double sum = 0;
        for (Index i = 0; i < workspace.rows(); ++i) {
            const VectorXd q = workspace.row(i).transpose();
            const VectorXd off =
                richer_.sensor->predict(world_from_flange(richer_, truth, q), truth.sensor) -
                fitted.sensor->predict(world_from_flange(fitted, found, q), found.sensor);
            sum += off.squaredNorm() / static_cast<double>(fitted.sensor->target_count());
        }
        return sum / static_cast<double>(workspace.rows());
    }

    Campaign poorer_, richer_;
    PlanningOptions options_;
};

/// Simulated robots that have the errors, calibrated without them: the model error is 0, so that
/// all that is left over is by noise and by what was left out.
TEST_F(ErrorsLeftOutOfAPlan, AreWhatSimulatedRobotsAreLeftWith) {
    poorer_.model_error = richer_.model_error = 0;
    const Planning planning = make_plan(poorer_, options_);
    ASSERT_TRUE(planning.left_out);
    const ErrorsLeftOut& said = *planning.left_out;
    EXPECT_EQ(said.key, "errors: full");
    EXPECT_EQ(said.error_count, parameter_count(richer_) - parameter_count(poorer_));
    EXPECT_DOUBLE_EQ(said.promised, predict_total(*planning.plan.predicted).rms);
    EXPECT_GT(said.expected, 2 * said.promised);
    EXPECT_LT(said.with_them, said.expected);
    EXPECT_LT(said.lower, said.expected);
    EXPECT_GT(said.upper, said.expected);

    RowMatrixXd poses(14, 6);
    Seen is_seen(14, 3);
    for (Index i = 0; i < 14; ++i) {
        const PlannedPose& pose = planning.plan.poses[static_cast<std::size_t>(i)];
        poses.row(i) = pose.configuration.transpose();
        is_seen.row(i) = seen_targets(pose.targets, 3);
    }
    const RowMatrixXd workspace = detail::workspace_configurations(
        poorer_, std::nullopt, options_.workspace_count, poorer_.seed + 1);
    constexpr Index robots = 100;
    LevenbergMarquardtOptions as_stated;
    as_stated.finds_model_error = false;
    double poor = 0, rich = 0;
    for (Index k = 0; k < robots; ++k) {
        const auto seed = static_cast<std::uint64_t>(k);
        const Parameters truth = draw_robot(richer_, 1, 1, seed).truth;
        const Measurements measured =
            simulate_measurements(richer_, truth, poses, is_seen, 1, seed);
        const auto fit = [&](const Campaign& campaign) {
            const Estimate found = identify(campaign, measured, campaign.nominal, as_stated);
            return error_of(campaign, truth, found.parameters, workspace);
        };
        poor += fit(poorer_) / robots;
        rich += fit(richer_) / robots;
    }
    EXPECT_NEAR(std::sqrt(poor), said.expected, 0.1 * said.expected);
    EXPECT_NEAR(std::sqrt(rich), said.with_them, 0.1 * said.with_them);
}

TEST_F(ErrorsLeftOutOfAPlan, AreNotToldWhereNothingIsRicherOrAnEstimateTells) {
    const auto richer = [&](const Campaign& campaign) {
        return [&campaign] { return std::vector<OtherCampaign>{{"errors: full", campaign}}; };
    };
    options_.richer = richer(poorer_);
    Planning planning = make_plan(poorer_, options_);
    EXPECT_FALSE(planning.left_out);
    options_.richer = [] { return std::vector<OtherCampaign>{}; };
    detail::judge_left_out(planning, options_);
    EXPECT_FALSE(planning.left_out);
    options_.richer = richer(richer_);
    planning.plan.request.sources.estimate = "estimate.json";
    detail::judge_left_out(planning, options_);
    EXPECT_FALSE(planning.left_out);
    planning.plan.request.sources.estimate = "";
    detail::judge_left_out(planning, options_);
    EXPECT_TRUE(planning.left_out);
}

}  // namespace
}  // namespace posewise
