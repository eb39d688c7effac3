#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <numbers>
#include <numeric>

#include "../../src/core/decompositions.hpp"
#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaigns.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::driven;
using testing::rotation;
using testing::tracked_campaign;
using testing::translation;

std::vector<std::string> names_of(const Campaign& campaign, const std::vector<Index>& parameters) {
    const auto all = parameter_names(campaign);
    std::vector<std::string> names;
    for (const Index k : parameters) names.push_back(all[static_cast<std::size_t>(k)]);
    return names;
}

Index irreducible_count(const Chain& robot) {
    const Campaign campaign = tracked_campaign(complete_model(robot));
    return static_cast<Index>(find_identifiable(campaign).kept.size());
}

/// The seed report's mistake: T_x of the vertical upper arm instead of T_z.
Chain seed_report_chain() {
    const Chain fanuc = testing::fanuc();
    std::vector<Element> elements;
    for (const Element& element : fanuc.elements()) {
        elements.push_back(element);
        if (element.parameter != "Tz2") continue;
        elements.back().parameter.clear();
        elements.push_back(translation(Axis::X, 0, "Tx2"));
    }
    return Chain(fanuc.joints(), elements);
}

TEST(FindIndependentColumns, ExpressesADroppedColumnByTheKeptOnes) {
    MatrixXd J(4, 4);
    J.leftCols<2>() << 1, 2, 0, 1, 3, -1, 1, 1;
    J.col(2) = 2 * J.col(0) - 0.5 * J.col(1);
    J.col(3).setZero();
    const Identifiability found = find_independent_columns(J, {0, 1, 2, 3});
    EXPECT_EQ(found.kept, (std::vector<Index>{0, 1}));
    ASSERT_EQ(found.dropped.size(), 2U);
    ASSERT_EQ(found.dropped[0].absorbed_by.size(), 2U);
    EXPECT_NEAR(found.dropped[0].absorbed_by[0].coefficient, 2, 1e-12);
    EXPECT_NEAR(found.dropped[0].absorbed_by[1].coefficient, -0.5, 1e-12);
    EXPECT_TRUE(found.dropped[1].absorbed_by.empty()) << "a zero column moves nothing";
}

TEST(FindIndependentColumns, SaysNothingOfAColumnThatIsRounding) {
    MatrixXd J(4, 3);
    J.leftCols<2>() << 1, 2, 0, 1, 3, -1, 1, 1;
    J.col(2) = 1e-17 * (J.col(0) + J.col(1));
    const Identifiability found = find_independent_columns(J, {0, 1, 2});
    ASSERT_EQ(found.dropped.size(), 1U);
    EXPECT_TRUE(found.dropped[0].absorbed_by.empty());
}

TEST(FindIndependentColumns, KeepsWhatComesFirstInPriority) {
    MatrixXd J = MatrixXd::Random(6, 3);
    J.col(2) = J.col(0);
    EXPECT_EQ(find_independent_columns(J, {0, 1, 2}).kept, (std::vector<Index>{0, 1}));
    EXPECT_EQ(find_independent_columns(J, {2, 1, 0}).kept, (std::vector<Index>{1, 2}));
}

TEST(FindIndependentColumns, PrefersWhatIsNotNearlyACombination) {
    MatrixXd J = MatrixXd::Random(6, 4);
    J.col(1) = J.col(0) + 1e-6 * J.col(3);
    EXPECT_EQ(find_independent_columns(J, {0, 1, 2, 3}).kept, (std::vector<Index>{0, 2, 3}));
    J.col(3).setRandom();
    EXPECT_EQ(find_independent_columns(J, {0, 1, 2}).kept, (std::vector<Index>{0, 1, 2}))
        << "it counts where nothing else says the same";
}

/// Angles in files are often rounded: 1.5708 for a quarter turn.
TEST(IrreducibleModel, OfAxesThatAreParallelButForRoundingIsThatOfParallelAxes) {
    std::vector<Element> elements = testing::ur_type().elements();
    const auto elbow = std::find_if(elements.begin(), elements.end(), [](const Element& element) {
        return !element.joints.empty() && element.joints[0].joint == 2;
    });
    const auto forearm = elements.insert(elbow, rotation(Axis::X, 3.7e-6)) + 2;
    elements.insert(forearm, rotation(Axis::Y, -3.3e-7));
    const Campaign rounded = tracked_campaign(Chain(testing::ur_type().joints(), elements));
    EXPECT_EQ(irreducible_model(rounded).parameter_names(),
              irreducible_model(tracked_campaign(testing::ur_type())).parameter_names());
    const Campaign complete = tracked_campaign(complete_model(rounded.robot));
    EXPECT_GT(find_identifiable(complete).least_kept_residual, 1e-2);
}

TEST(IrreducibleModel, OfTheFanucIsTheEighteenOfTheRules) {
    const Chain irreducible = irreducible_model(tracked_campaign(testing::fanuc()));
    auto names = irreducible.parameter_names();
    auto expected = testing::fanuc().parameter_names();
    std::sort(names.begin(), names.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(names, expected);
}

TEST(IrreducibleModel, KeepsTermsBesideTheWholeGeometry) {
    const Chain with_terms = with_harmonics(with_gravity_terms(testing::fanuc()), {1}, {3});
    const Chain irreducible = irreducible_model(tracked_campaign(with_terms));
    auto names = irreducible.parameter_names();
    auto expected = with_terms.parameter_names();
    std::sort(names.begin(), names.end());
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(names, expected);
}

/// Four beside 4R + 2P + 3n. The tolerance does not matter: the singular values say the same.
TEST(IrreducibleModel, HasTheHarmonicsOfASlideBesideTheWholeGeometry) {
    const Chain rail = without_parameters(testing::with_pitch(testing::rail_with_fanuc(), 0, 0.02));
    const Chain driven = with_harmonics(rail, {1, 2}, {0});
    const Index formula = 4 * 6 + 2 * 1 + 3 * 3 + 4;
    EXPECT_EQ(irreducible_count(driven), formula);
    const Campaign campaign = tracked_campaign(complete_model(driven));
    EXPECT_TRUE(has_clear_gap(find_identifiable(campaign)));
    MatrixXd J = make_blocks(campaign, campaign.nominal, random_configurations(driven, 100, 5),
                             MatrixXd::Ones(100, 3))
                     .matrix;
    for (Index k = 0; k < J.cols(); ++k) J.col(k) /= std::max(J.col(k).norm(), 1e-300);
    const VectorXd singular = detail::singular_directions(J).values;
    EXPECT_EQ((singular.array() > 1e-6 * singular[0]).count(), formula);
    EXPECT_LT(singular[formula], 1e-12 * singular[0]);
}

TEST(IrreducibleModel, DropsTheTermThatGeometryExpresses) {
    const auto linear = JointFunction::Shape::Linear;
    std::vector<Element> elements = testing::fanuc().elements();
    elements[4].terms = {{"ratio", {linear, {{1, 1}}, 0}},
                         {"ratio_about_1", {linear, {{1, 1}}, 1}}};
    const Campaign campaign = tracked_campaign(Chain(testing::fanuc().joints(), elements));
    const Identifiability found = find_identifiable(campaign);
    ASSERT_EQ(found.dropped.size(), 1U);
    EXPECT_EQ(names_of(campaign, {found.dropped[0].parameter}),
              (std::vector<std::string>{"ratio_about_1"}));
    std::vector<Index> absorbing;
    for (const ParameterTerm& term : found.dropped[0].absorbed_by)
        absorbing.push_back(term.parameter);
    EXPECT_EQ(names_of(campaign, absorbing), (std::vector<std::string>{"dq2", "ratio"}));
    const Chain kept = keep_parameters(campaign.robot, {"dq2", "ratio"});
    EXPECT_EQ(kept.parameter_names(), (std::vector<std::string>{"dq2", "ratio"}));
    EXPECT_EQ(irreducible_model(campaign).parameter_count(), 19);
}

TEST(IrreducibleModel, PredictsAsTheStatedChainDoes) {
    const Chain stated = testing::fanuc();
    const Chain irreducible = irreducible_model(tracked_campaign(stated));
    const VectorXd zero = VectorXd::Zero(18);
    const RowMatrixXd configurations = random_configurations(stated, 20, 3);
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        EXPECT_TRUE(stated.base_from_flange(q, zero).isApprox(irreducible.base_from_flange(q, zero),
                                                              1e-14));
    }
}

TEST(FindIdentifiable, SeedReportsSetLacksOneDirectionAndSaysWhich) {
    const Campaign campaign = tracked_campaign(seed_report_chain());
    const Identifiability found = find_identifiable(campaign);
    EXPECT_EQ(parameter_count(campaign), 33);
    EXPECT_EQ(found.kept.size(), 32U);
    ASSERT_EQ(found.dropped.size(), 1U);
    EXPECT_EQ(names_of(campaign, {found.dropped[0].parameter}), std::vector<std::string>{"Tx2"});
    // Moving the elbow along x by t is turning the upper arm by t / 1.075 and the forearm back.
    ASSERT_EQ(found.dropped[0].absorbed_by.size(), 2U);
    std::vector<Index> absorbing;
    for (const auto& term : found.dropped[0].absorbed_by) {
        absorbing.push_back(term.parameter);
        EXPECT_NEAR(std::abs(term.coefficient), 1 / 1.075, 1e-12);
    }
    EXPECT_EQ(names_of(campaign, absorbing), (std::vector<std::string>{"dq2", "dq3"}));
    EXPECT_GT(found.least_kept_residual, 1e6 * found.largest_dropped_residual);
}

TEST(FindIdentifiable, CountIsFourRevoluteTwoPrismaticThreeTargets) {
    const Index targets = 3 * 3;
    EXPECT_EQ(irreducible_count(testing::fanuc()), 4 * 6 + targets);
    EXPECT_EQ(irreducible_count(testing::ur_type()), 4 * 6 + targets);
    EXPECT_EQ(irreducible_count(testing::planar_arm({1, 0.8, 0.5})), 4 * 3 + targets);
    EXPECT_EQ(irreducible_count(testing::scara()), 4 * 3 + 2 * 1 + targets);
    EXPECT_EQ(irreducible_count(testing::gantry_with_wrist()), 4 * 3 + 2 * 3 + targets);
    EXPECT_EQ(irreducible_count(testing::seven_joint_arm()), 4 * 7 + targets);
    EXPECT_EQ(irreducible_count(testing::rail_with_fanuc()), 4 * 6 + 2 * 1 + targets);
}

/// Of an axis that another joint drives along four errors count like those of any.
TEST(FindIdentifiable, CountsAnAxisThatOnlyFollows) {
    std::vector<Element> elements = testing::fanuc().elements();
    const auto last = std::find_if(elements.begin(), elements.end(), [](const Element& element) {
        return !element.joints.empty() && element.joints[0].joint == 5;
    });
    const std::vector<Element> more{rotation(Axis::Z, 0.6),
                                    Element{Motion::Rotation, Axis::Y, 0.0, {{4, -1.0}}, ""},
                                    rotation(Axis::Z, -0.7), translation(Axis::X, 0.1)};
    elements.insert(last, more.begin(), more.end());
    EXPECT_EQ(irreducible_count(Chain(testing::fanuc().joints(), elements)), 4 * 7 + 3 * 3);
}

/// A target that is on the last joint's axis but for rounded angles says as little as one on it.
TEST(FindIdentifiable, IsNotDecidedByTheRoundingOfAngles) {
    for (const double half : {std::numbers::pi / 2, 1.5707963, 1.570796, 1.5708}) {
        std::vector<Element> elements = testing::fanuc().elements();
        elements.push_back(rotation(Axis::Y, half));
        Campaign campaign = tracked_campaign(Chain(testing::fanuc().joints(), elements));
        campaign.robot = complete_model(campaign.robot);
        campaign.sensor = std::make_shared<PointSensor>(
            std::vector<std::optional<Vector3d>>(1, std::nullopt), 5e-5);
        campaign.nominal.sensor = Vector3d(0, 0, 0.15);
        const Identifiability found = find_identifiable(campaign);
        EXPECT_EQ(found.kept.size(), 25U) << half;
        EXPECT_TRUE(has_clear_gap(found)) << half;
        for (const DroppedParameter& dropped : found.dropped) {
            for (const ParameterTerm& term : dropped.absorbed_by) {
                EXPECT_LT(std::abs(term.coefficient), 1e2) << half;
            }
        }
    }
}

/// Faces that are touched tell no length: all could be larger.
Campaign touching_campaign(bool offset_is_known) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    campaign.nominal.world_from_base.setIdentity();
    campaign.base_is_known.fill(true);
    std::vector<Plane> planes{{{1, 0, 0}, 1.6}, {{0, 1, 0}, 0.4}, {{0, 0, 1}, 0.9}};
    planes[0].offset_is_known = offset_is_known;
    std::vector<double> unknowns{0.28, 0.05, -0.11};
    for (std::size_t k = 0; k < planes.size(); ++k) {
        unknowns.insert(unknowns.end(), {0, 0});
        if (k > 0 || !offset_is_known) unknowns.push_back(planes[k].offset);
    }
    campaign.sensor = std::make_shared<PlaneSensor>(
        Targets(std::vector<std::optional<Vector3d>>{std::nullopt}), planes, 5e-5);
    campaign.nominal.sensor = Eigen::Map<VectorXd>(unknowns.data(), std::ssize(unknowns));
    return campaign;
}

TEST(FindIdentifiable, TellsNoLengthByFacesThatAreTouched) {
    Campaign open = touching_campaign(false);
    Campaign known = touching_campaign(true);
    for (Campaign* const campaign : {&open, &known}) {
        *campaign = with_robot(*campaign, complete_model(campaign->robot));
    }
    const std::size_t told = find_identifiable(open).kept.size();
    EXPECT_EQ(find_identifiable(known).kept.size(), told) << "an unknown less, and a length";
    EXPECT_EQ(told, 24U + 3 - 6 + 9 - 1);
    EXPECT_GE(least_pose_count(open), static_cast<Index>(told)) << "a pose touches one face";
    EXPECT_LE(least_pose_count(open), static_cast<Index>(told) + 3);
}

TEST(IrreducibleOffsets, AreTheJointsZerosThatBaseAndTargetsDoNotTell) {
    const Chain offsets = irreducible_offsets(tracked_campaign(testing::fanuc()));
    EXPECT_EQ(offsets.parameter_names(), (std::vector<std::string>{"dq2", "dq3", "dq4", "dq5"}));
}

TEST(FindIdentifiable, DroppedColumnIsTheStatedCombination) {
    const Campaign campaign = tracked_campaign(complete_model(testing::fanuc()));
    const Identifiability found = find_identifiable(campaign);
    // Other configurations than the search looked at.
    const MatrixXd J =
        make_plain_blocks(campaign, campaign.nominal, random_configurations(campaign.robot, 40, 77))
            .matrix;
    EXPECT_EQ(found.dropped.size(), 12U);
    for (const DroppedParameter& dropped : found.dropped) {
        VectorXd combination = VectorXd::Zero(J.rows());
        for (const auto& term : dropped.absorbed_by) {
            combination += term.coefficient * J.col(term.parameter);
        }
        EXPECT_LT((combination - J.col(dropped.parameter)).norm(), 1e-9 * combination.norm());
    }
}

Campaign with_many_targets(Campaign campaign, Index count) {
    campaign.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(static_cast<std::size_t>(count), std::nullopt), 5e-5);
    campaign.nominal.sensor.resize(3 * count);
    RandomStream random(1);
    for (double& coordinate : campaign.nominal.sensor) coordinate = 0.3 * random.normal();
    return campaign;
}

TEST(IrreducibleModel, IsNotFoundWhenStopped) {
    const Campaign few = tracked_campaign(testing::fanuc());
    const Campaign campaign = with_many_targets(few, 40);
    StopSignal late;
    late.deadline = std::chrono::steady_clock::now();
    EXPECT_THROW(irreducible_model(campaign, late), InputError);
    EXPECT_THROW(least_pose_count(campaign, late), InputError);
    std::atomic<bool> flag = true;
    const StopSignal interrupted{&flag};
    std::vector<Index> all(200);
    std::iota(all.begin(), all.end(), Index{0});
    EXPECT_THROW(
        find_independent_columns(MatrixXd::Identity(200, 200), all, least_residual, interrupted),
        InputError);
    EXPECT_EQ(irreducible_model(few, late).parameter_count(), 18) << "takes no time";
}

TEST(FindIdentifiable, LooksAtManyTargetsInParts) {
    const Campaign campaign = tracked_campaign(complete_model(testing::fanuc()));
    const Identifiability three = find_identifiable(campaign);
    const Identifiability many = find_identifiable(with_many_targets(campaign, 40));
    EXPECT_EQ(many.kept.size(), three.kept.size() + 3 * 37);
    EXPECT_TRUE(has_clear_gap(many));
    EXPECT_EQ(many.dropped.size(), three.dropped.size());
}

/// 20 unknowns of base, place and lens, and a pinhole with a known place.
TEST(LeastPoseCount, OfACameraIsThatOfItsNumbers) {
    const Campaign arm = tracked_campaign(testing::fanuc());
    Campaign robot = testing::before_camera(arm, testing::fixed_camera());
    robot.spread.is_prior = true;
    EXPECT_LE(least_pose_count(robot), 4);
    CameraSetup open = testing::fixed_camera();
    open.is_known.assign(9, false);
    robot = testing::before_camera(arm, open);
    robot.spread.is_prior = true;
    EXPECT_LE(least_pose_count(robot), 6);
}

TEST(LeastPoseCount, IsFiveForThreeTargetsAndNineForOne) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    EXPECT_EQ(least_pose_count(campaign), 5);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 5e-5);
    campaign.nominal.sensor = Vector3d(0.28, 0.05, -0.11);
    EXPECT_EQ(least_pose_count(campaign), 9);
}

TEST(WeakestDirections, AreTheLastRightSingularVectors) {
    const MatrixXd stacked = VectorXd(Eigen::Vector3d(3, 1e-3, 2)).asDiagonal();
    const auto directions = weakest_directions(stacked, 2, 1);
    ASSERT_EQ(directions.size(), 2U);
    EXPECT_NEAR(directions[0].singular_value, 1e-3, 1e-15);
    EXPECT_EQ(directions[0].terms[0].parameter, 1);
    EXPECT_NEAR(directions[0].terms[0].coefficient, 1, 1e-12);
    EXPECT_EQ(directions[1].terms[0].parameter, 2);
}

TEST(WeakestDirections, OfFewerRowsThanColumnsHaveSingularValueZero) {
    const MatrixXd stacked = MatrixXd::Random(2, 5);
    const auto directions = weakest_directions(stacked, 3);
    for (const auto& direction : directions) EXPECT_EQ(direction.singular_value, 0);
}

TEST(HasClearGap, NotOfHarmonicsOnAJointThatTurnsLittle) {
    EXPECT_TRUE(
        has_clear_gap(find_identifiable(tracked_campaign(complete_model(testing::fanuc())))));
    std::vector<Joint> joints = testing::fanuc().joints();
    joints[3] = {joints[3].name, -0.15, 0.15};
    const Chain narrow(joints, testing::fanuc().elements());
    const Campaign campaign = tracked_campaign(with_harmonics(narrow, {1, 2, 3, 4, 5, 6, 7}, {3}));
    const Identifiability found = find_identifiable(campaign);
    EXPECT_FALSE(has_clear_gap(found))
        << found.least_kept_residual << " and " << found.largest_dropped_residual;
    const auto weakest = names_of(campaign, weakest_kept(campaign, found));
    ASSERT_EQ(weakest.size(), 4U);
    for (const std::string& name : weakest) EXPECT_NE(name.find("q4"), std::string::npos) << name;
}

}  // namespace
}  // namespace posewise
