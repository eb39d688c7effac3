#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/chain.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/inspection.hpp"
#include "support/campaigns.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

using namespace testing;

/// An IRB 120.
Chain irb120() {
    const auto R = Motion::Rotation;
    const std::vector<Joint> joints{{"q1", -2.7, 2.7}, {"q2", -1.6, 1.4}, {"q3", -1.4, 1.1},
                                    {"q4", -2.7, 2.7}, {"q5", -2, 2},     {"q6", -3, 3}};
    return Chain(joints, {driven(R, Axis::Z, 0), translation(Axis::Z, 0.29), driven(R, Axis::Y, 1),
                          translation(Axis::Z, 0.27), driven(R, Axis::Y, 2),
                          translation(Axis::Z, 0.07), translation(Axis::X, 0.302),
                          driven(R, Axis::X, 3), driven(R, Axis::Y, 4), driven(R, Axis::X, 5)});
}

/// Without noise.
Campaign exact_campaign(const Chain& robot) {
    Campaign campaign = tracked_campaign(robot);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-9);
    campaign.model_error = 0;
    return campaign;
}

Campaign campaign_with_gravity() {
    const Campaign bare = exact_campaign(irb120());
    return with_robot(bare, with_gravity_terms(irreducible_model(bare)));
}

double residual_rms(const Campaign& campaign, const Measurements& measured) {
    CalibrationOptions options;
    options.folds = 0;
    const Calibration calibration = calibrate(campaign, measured, options);
    EXPECT_EQ(calibration.estimate.ending, Ending::Converged);
    return calibration.estimate.fit.distance_rms;
}

/// What is lost is what a geometric calibration on the predictions of all errors leaves, and what
/// one on the predictions of the nearest geometry does not.
TEST(NearestGeometry, IsThatOfACalibrationOnThePredictionsOfAllErrors) {
    const Campaign campaign = campaign_with_gravity();
    const Campaign geometric = with_robot(campaign, irreducible_model(exact_campaign(irb120())));
    const Parameters truth = draw_truth(campaign, 5);
    const Geometry nearest = nearest_geometry(campaign, truth);
    const RowMatrixXd workspace = detail::random_configurations(campaign.robot, 1000, 8);
    const Measurements predicted = simulate_measurements(campaign, truth, workspace, 1, 1);
    const double left = residual_rms(geometric, predicted);
    EXPECT_GT(left, 1e-4) << "there is something to lose";
    EXPECT_NEAR(nearest.lost.rms, left, 0.03 * left);
    EXPECT_GT(nearest.lost.largest, 2 * nearest.lost.rms);

    const Geometry estimated = estimated_geometry(campaign, truth);
    EXPECT_GT(estimated.lost.rms, 1.3 * nearest.lost.rms);

    const Campaign exported = with_robot(campaign, nearest.robot);
    Parameters of_exported{nearest.world_from_base, nearest.errors, VectorXd(9)};
    for (Index j = 0; j < 3; ++j) {
        of_exported.sensor.segment<3>(3 * j) = nearest.targets[static_cast<std::size_t>(j)];
    }
    EXPECT_LT(
        residual_rms(geometric, simulate_measurements(exported, of_exported, workspace, 1, 1)),
        1e-8);
}

TEST(NearestGeometry, AtGivenConfigurationsLosesWhatACalibrationThereLeaves) {
    const Campaign campaign = campaign_with_gravity();
    const Campaign geometric = with_robot(campaign, irreducible_model(exact_campaign(irb120())));
    const Parameters truth = draw_truth(campaign, 6);
    GeometryOptions options;
    options.workspace = 0.4 * detail::random_configurations(campaign.robot, 200, 8);
    const Geometry nearest = nearest_geometry(campaign, truth, options);
    const double left =
        residual_rms(geometric, simulate_measurements(campaign, truth, options.workspace, 1, 1));
    EXPECT_NEAR(nearest.lost.rms, left, 1e-3 * left);
    options.workspace(0, 0) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(nearest_geometry(campaign, truth, options), InputError);
}

/// Of the full model, with its redundant errors and those that are far from small.
TEST(NearestGeometry, IsUniqueAndNearWhatWasFound) {
    const Campaign bare = exact_campaign(irb120());
    Campaign campaign = with_robot(bare, detail::full_model(irb120()));
    campaign.spread = population_spread(irb120());
    const Parameters truth = draw_truth(campaign, 7);
    const Geometry nearest = nearest_geometry(campaign, truth);
    EXPECT_LT(nearest.lost.rms, 2e-3);
    EXPECT_LT(nearest.errors.cwiseAbs().maxCoeff(), 0.02);
    EXPECT_LT((nearest.world_from_base.translation() - truth.world_from_base.translation()).norm(),
              0.01);
    for (Index k = 0; k < nearest.robot.parameter_count(); ++k) {
        EXPECT_EQ(nearest.robot.parameter_term(k), nullptr);
    }
}

TEST(NearestGeometry, OfARobotWithoutTermsLosesNothing) {
    const Campaign bare = exact_campaign(irb120());
    const Campaign campaign = with_robot(bare, detail::complete_model(irb120()));
    const Parameters truth = draw_truth(campaign, 3);
    EXPECT_LT(nearest_geometry(campaign, truth).lost.largest, 1e-9);
    EXPECT_EQ(estimated_geometry(campaign, truth).lost.largest, 0);
    EXPECT_EQ(estimated_geometry(campaign, truth).errors, truth.robot);
}

/// Errors behind the last joint go into the tool, its orientation too.
TEST(NearestGeometry, HasTheToolWhereItIs) {
    Campaign campaign = exact_campaign(irb120());
    campaign.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{1e-5}, 1e-5);
    campaign.nominal.sensor = (VectorXd(6) << 0.05, 0.02, 0.1, 0.3, -0.2, 1).finished();
    campaign = with_robot(campaign, detail::complete_model(irb120()));
    const Parameters truth = draw_truth(campaign, 3);
    const VectorXd q = VectorXd::LinSpaced(6, -0.4, 0.6);
    const VectorXd pose = campaign.sensor->predict(
        truth.world_from_base * campaign.robot.base_from_flange(q, truth.robot), truth.sensor);
    for (const Geometry& geometry :
         {nearest_geometry(campaign, truth), estimated_geometry(campaign, truth)}) {
        const Isometry3d tool = geometry.world_from_base *
                                geometry.robot.base_from_flange(q, geometry.errors) *
                                geometry.tool.value();
        EXPECT_LT((tool.translation() - pose.head<3>()).norm(), 1e-8);
        EXPECT_TRUE(tool.linear().isApprox(rotation_from_vector(pose.tail<3>()), 1e-7));
        EXPECT_EQ(geometry.targets.front(), geometry.tool->translation());
    }
    EXPECT_FALSE(estimated_geometry(campaign_with_gravity(), draw_truth(campaign_with_gravity(), 4))
                     .tool.has_value());
}

/// A tool and a base that are known stay where they are; one target says nothing of orientations,
/// points beside it do.
TEST(NearestGeometry, KeepsWhatIsKnown) {
    Campaign campaign = campaign_with_gravity();
    const Isometry3d tool(Eigen::Translation3d(0.05, 0.02, 0.1));
    campaign.sensor = std::make_shared<PoseSensor>(tool, IsotropicNoise{1e-5}, 1e-5);
    campaign.nominal.sensor.resize(0);
    campaign.base_is_known.fill(true);
    const Parameters truth = draw_truth(campaign, 4);
    const Geometry nearest = nearest_geometry(campaign, truth);
    ASSERT_EQ(nearest.targets.size(), 1U);
    EXPECT_EQ(nearest.targets.front(), tool.translation());
    EXPECT_TRUE(nearest.tool.value().isApprox(tool, 1e-12));
    EXPECT_TRUE(nearest.world_from_base.isApprox(truth.world_from_base, 0));
    EXPECT_LT(nearest.lost.rms, estimated_geometry(campaign, truth).lost.rms);
    VectorXd q = VectorXd::Constant(6, 0.3);
    const Isometry3d difference = campaign.robot.base_from_flange(q, truth.robot).inverse() *
                                  nearest.robot.base_from_flange(q, nearest.errors);
    EXPECT_LT(Eigen::AngleAxisd(difference.linear()).angle(), 5e-3);
}

TEST(NominalLoss, IsWhatBaseAndTargetsAloneLeave) {
    Campaign campaign = campaign_with_gravity();
    const Parameters truth = draw_truth(campaign, 3);
    const PositionLoss nominal = nominal_loss(campaign, truth);
    EXPECT_GT(nominal.rms, 1.2 * nearest_geometry(campaign, truth).lost.rms);
    EXPECT_GT(nominal.largest, nominal.rms);
    Parameters exact = truth;
    exact.robot.setZero();
    EXPECT_LT(nominal_loss(campaign, exact).largest, 1e-9);
    campaign.base_is_known.fill(true);
    EXPECT_GT(nominal_loss(campaign, truth).rms, nominal.rms);
}

TEST(NearestGeometry, IsOfTheCellsWorkspace) {
    Campaign campaign = campaign_with_gravity();
    const Parameters truth = draw_truth(campaign, 5);
    const double everywhere = nearest_geometry(campaign, truth).lost.rms;
    campaign.cell.target_boxes = {{Vector3d(0.2, -0.2, 0.2), Vector3d(0.7, 0.2, 0.8)}};
    EXPECT_LT(nearest_geometry(campaign, truth).lost.rms, 0.8 * everywhere);
    campaign.cell.target_boxes = {{Vector3d(8, 8, 8), Vector3d(9, 9, 9)}};
    EXPECT_EQ(input_error_of([&] { nearest_geometry(campaign, truth); }).rfind("workspace: ", 0),
              0U);
}

}  // namespace
}  // namespace posewise
