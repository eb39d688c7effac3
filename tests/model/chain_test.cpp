#include "posewise/model/chain.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "../../src/core/simd.hpp"
#include "../../src/model/complete_model.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;
using Eigen::Vector2d;

constexpr double pi = std::numbers::pi;

TEST(Chain, PlacesAPlanarArmByItsClosedForm) {
    const Chain arm = planar_arm({1.0, 0.8});
    const Vector2d q(0.3, 1.1);
    const Isometry3d pose = arm.base_from_flange(q, VectorXd::Zero(4));
    EXPECT_NEAR(pose.translation().x(), std::cos(0.3) + 0.8 * std::cos(1.4), 1e-15);
    EXPECT_NEAR(pose.translation().y(), std::sin(0.3) + 0.8 * std::sin(1.4), 1e-15);
    EXPECT_EQ(pose.translation().z(), 0);
    EXPECT_TRUE(pose.linear().isApprox(Eigen::AngleAxisd(1.4, Vector3d::UnitZ()).toRotationMatrix(),
                                       1e-15));
}

TEST(Chain, PlacesTheFanucAtZero) {
    const Chain robot = fanuc();
    const Isometry3d pose = robot.base_from_flange(VectorXd::Zero(6), VectorXd::Zero(18));
    EXPECT_TRUE(pose.translation().isApprox(Vector3d(1.592, 0, 1.3), 1e-15));
    EXPECT_TRUE(pose.linear().isIdentity(1e-15));
}

TEST(Chain, TurnsAReversedJointTheOtherWay) {
    // Forearm up: positive q3 of the FANUC lifts it, since Ry(-q3) turns x towards z.
    VectorXd q = VectorXd::Zero(6);
    q[2] = pi / 2;
    const Isometry3d pose = fanuc().base_from_flange(q, VectorXd::Zero(18));
    EXPECT_TRUE(pose.translation().isApprox(Vector3d(0.312 - 0.225, 0, 1.075 + 1.280), 1e-14));
}

TEST(Chain, CouplesJointsThatShareAnElement) {
    // Parallelogram: the second link's absolute angle is q2 alone, so the joint turns q2 - q1.
    const Element elbow{Motion::Rotation, Axis::Z, 0.0, {{1, 1.0}, {0, -1.0}}, ""};
    const Chain arm({{"q1", -1, 1}, {"q2", -1, 1}},
                    {driven(Motion::Rotation, Axis::Z, 0), translation(Axis::X, 1.0), elbow,
                     translation(Axis::X, 0.5)});
    const Isometry3d pose = arm.base_from_flange(Vector2d(0.4, 0.9), VectorXd());
    EXPECT_NEAR(pose.translation().x(), std::cos(0.4) + 0.5 * std::cos(0.9), 1e-15);
    EXPECT_NEAR(pose.translation().y(), std::sin(0.4) + 0.5 * std::sin(0.9), 1e-15);
}

TEST(Chain, SlidesAPrismaticJoint) {
    VectorXd q(6);
    q << 1.2, 0.7, -0.4, 0, 0, 0;
    const Isometry3d pose = gantry_with_wrist().base_from_flange(q, VectorXd());
    EXPECT_TRUE(pose.translation().isApprox(Vector3d(1.3, 0.7, -0.6), 1e-15));
    EXPECT_EQ(gantry_with_wrist().joint(1).motion, Motion::Translation);
    EXPECT_EQ(gantry_with_wrist().joint(4).motion, Motion::Rotation);
}

TEST(Chain, AddsTheErrorParameterToItsElement) {
    const Chain arm = planar_arm({1.0, 0.8});
    Eigen::Vector4d errors(0.01, 0.002, -0.02, 0.003);
    const Isometry3d pose = arm.base_from_flange(Vector2d(0.3, 1.1), errors);
    const Isometry3d expected =
        planar_arm({1.002, 0.803}).base_from_flange(Vector2d(0.31, 1.08), VectorXd::Zero(4));
    EXPECT_TRUE(pose.isApprox(expected, 1e-15));
}

TEST(Chain, WithKnownErrorsMovesAsWithTheirParameters) {
    const Chain bare = without_parameters(fanuc());
    const Chain full = detail::full_model(with_compliance(bare, fanuc_loads()));
    const Index count = full.parameter_count();
    const VectorXd values = 1e-2 * VectorXd::Random(count);
    std::vector<bool> is_known;
    VectorXd open(count);
    Index open_count = 0;
    for (Index k = 0; k < count; ++k) {
        is_known.push_back(k % 3 != 0);
        if (!is_known.back()) open[open_count++] = values[k];
    }
    const Chain known = with_known_errors(full, values, is_known);
    ASSERT_EQ(known.parameter_count(), open_count);
    open.conservativeResize(open_count);
    const VectorXd q = VectorXd::LinSpaced(6, -0.7, 0.9);
    FlangeMotion expected, found;
    std::vector<FlangeMotionRate> expected_rates, rates;
    const Isometry3d base = Isometry3d::Identity();
    full.differentiate_twice(base, q, values, expected, expected_rates);
    known.differentiate_twice(base, q, open, found, rates);
    EXPECT_TRUE(known.base_from_flange(q, open).isApprox(expected.world_from_flange, 1e-13));
    EXPECT_TRUE(found.world_from_flange.isApprox(expected.world_from_flange, 1e-13));
    EXPECT_TRUE(found.joint_twists.isApprox(expected.joint_twists, 1e-12));
    for (Index k = 0, own = 0; k < count; ++k) {
        if (is_known[static_cast<std::size_t>(k)]) continue;
        EXPECT_TRUE(found.twists.col(6 + own).isApprox(expected.twists.col(6 + k), 1e-11)) << k;
        EXPECT_TRUE(
            rates[1].twists.col(6 + own).isApprox(expected_rates[1].twists.col(6 + k), 1e-10))
            << k;
        ++own;
    }
    for (std::size_t j = 0; j < rates.size(); ++j) {
        EXPECT_TRUE(rates[j].joint_twists.isApprox(expected_rates[j].joint_twists, 1e-11)) << j;
    }
    EXPECT_EQ(
        with_known_errors(full, values, std::vector<bool>(static_cast<std::size_t>(count), true))
            .parameter_count(),
        0);
}

TEST(Chain, GivesWayInProportionToAMeasuredTorque) {
    const Chain arm = with_measured_compliance(planar_arm({1.0, 0.8}), {{1, 200}});
    EXPECT_EQ(arm.parameter_names(),
              (std::vector<std::string>{"dq1", "dl1", "dq2", "q2.compliance", "dl2"}));
    VectorXd errors = VectorXd::Zero(5), same = errors;
    errors[3] = 2e-3;
    same[2] = 2e-3 * -150 / 200;
    const Vector3d q(0.3, 1.1, -150);
    EXPECT_TRUE(arm.base_from_flange(q, errors).isApprox(arm.base_from_flange(q, same), 1e-15));
    EXPECT_THROW(arm.check_configuration(Vector2d(0.3, 1.1)), InputError);
    EXPECT_THROW(arm.check_configuration(Vector3d(0.3, 1.1, std::nan(""))), InputError);
    EXPECT_NO_THROW(arm.check_configuration(q));
    EXPECT_EQ(without_parameters(arm).configuration_size(), 3);
}

TEST(Chain, RefusesTorquesThatMakeNoSense) {
    const Chain arm = planar_arm({1.0, 0.8});
    EXPECT_THROW(with_measured_compliance(arm, {{2, 1}}), InputError) << "no such joint";
    EXPECT_THROW(with_measured_compliance(arm, {{0, 0}}), InputError) << "nothing at its largest";
    EXPECT_THROW(with_measured_compliance(arm, {{0, 1}, {0, 1}}), InputError) << "twice";
    EXPECT_THROW(with_measured_compliance(gantry_with_wrist(), {{0, 1}}), InputError) << "slides";
}

TEST(Chain, AddsATermToItsElement) {
    const VectorXd q = Eigen::Vector3d(0.4, -0.7, 0.1);
    const Chain chain = with_every_term();
    VectorXd errors = VectorXd::Zero(8), same = errors;
    errors[2] = 0.02;
    same[1] = 0.02 * std::sin(0.4 + 2 * 0.7);
    EXPECT_TRUE(chain.base_from_flange(q, errors).isApprox(chain.base_from_flange(q, same), 1e-15));
    errors[3] = -0.03;
    same[1] += -0.03 * std::cos(1.5 * -0.7);
    EXPECT_TRUE(chain.base_from_flange(q, errors).isApprox(chain.base_from_flange(q, same), 1e-15));
}

TEST(Chain, RefusesTermsThatMakeNoSense) {
    using Shape = JointFunction::Shape;
    const auto error_of = [](const ErrorTerm& term) -> std::string {
        Element turn = driven(Motion::Rotation, Axis::Z, 0, "dq1");
        turn.terms = {term};
        try {
            Chain({{"q1", -1, 1}}, {turn});
        } catch (const InputError& problem) {
            return problem.what();
        }
        return "";
    };
    EXPECT_EQ(error_of({"k", {Shape::Sine, {{0, 1}}, 0}}), "");
    EXPECT_EQ(error_of({"", {Shape::Sine, {{0, 1}}, 0}}),
              "element 1 of the chain has an error term without name");
    EXPECT_EQ(error_of({"k", {Shape::Sine, {}, 0}}),
              "term 'k' of element 1 of the chain depends on no joint");
    EXPECT_EQ(
        error_of({"k", {Shape::Sine, {{1, 1}}, 0}}),
        "term 'k' of element 1 of the chain is driven by joint index 1, the robot has 1 joints");
    EXPECT_EQ(error_of({"dq1", {Shape::Sine, {{0, 1}}, 0}}), "parameter 'dq1' occurs twice");
    EXPECT_NE(error_of({"k", {Shape::Sine, {{0, 1}}, std::nan("")}}), "");
}

TEST(Chain, MovesWithItsBase) {
    RandomStream stream(23);
    const Chain robot = fanuc();
    const Isometry3d base = random_pose(stream);
    const VectorXd q = random_vector(stream, 6, pi), errors = random_vector(stream, 18, 1e-2);
    FlangeMotion at_origin, moved;
    robot.differentiate(Isometry3d::Identity(), q, errors, at_origin);
    robot.differentiate(base, q, errors, moved);
    EXPECT_TRUE(moved.world_from_flange.isApprox(base * at_origin.world_from_flange, 1e-14));
    for (Index k = 6; k < 24; ++k) {
        const Vector3d w = base.linear() * at_origin.twists.col(k).head<3>();
        const Vector3d v = base.linear() * at_origin.twists.col(k).tail<3>();
        EXPECT_TRUE(w.isApprox(moved.twists.col(k).head<3>(), 1e-13));
        EXPECT_LT((v - w.cross(base.translation()) - moved.twists.col(k).tail<3>()).norm(), 1e-13);
    }
}

TEST(Chain, NamesItsParametersInTheOrderOfTheElements) {
    const Chain arm = planar_arm({1, 1});
    EXPECT_EQ(arm.parameter_names(), (std::vector<std::string>{"dq1", "dl1", "dq2", "dl2"}));
    EXPECT_EQ(arm.parameter_element(2).parameter, "dq2");
    EXPECT_EQ(without_parameters(arm).parameter_count(), 0);
    EXPECT_EQ(without_parameters(arm).elements().size(), 4U);
}

TEST(Chain, RefusesRobotsThatMakeNoSense) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Element turn = driven(Motion::Rotation, Axis::Z, 0);
    const Joint q1{"q1", -1, 1};
    EXPECT_THROW(Chain({q1}, {}), InputError) << "joint without element";
    EXPECT_THROW(Chain({q1}, {turn, driven(Motion::Translation, Axis::Z, 0)}), InputError)
        << "joint that turns and slides";
    EXPECT_THROW(Chain({{"q1", 1, -1}}, {turn}), InputError) << "limits out of order";
    EXPECT_THROW(Chain({{"q1", nan, 1}}, {turn}), InputError) << "limit not a number";
    EXPECT_THROW(Chain({q1, q1}, {turn, driven(Motion::Rotation, Axis::Z, 1)}), InputError)
        << "two joints of one name";
    EXPECT_THROW(Chain({q1}, {turn, rotation(Axis::X, 0, "a"), rotation(Axis::Y, 0, "a")}),
                 InputError)
        << "two parameters of one name";
    EXPECT_THROW(Chain({q1}, {turn, driven(Motion::Rotation, Axis::X, 1)}), InputError)
        << "joint that does not exist";
    EXPECT_THROW(Chain({q1}, {turn, translation(Axis::X, nan)}), InputError) << "NaN length";
    EXPECT_THROW(Chain({q1}, {driven(Motion::Rotation, Axis::X, 0, "", nan)}), InputError)
        << "NaN coefficient";
    EXPECT_THROW(Chain({q1}, {driven(Motion::Rotation, Axis::X, 0, "", 0)}), InputError)
        << "coefficient zero";
    const Element slide = driven(Motion::Translation, Axis::Z, 0);
    const auto rail = [](double pitch) { return Joint{"rail", 0, 1, Motion::Translation, pitch}; };
    EXPECT_NO_THROW(Chain({rail(0.02)}, {slide}));
    EXPECT_THROW(Chain({rail(0.02)}, {turn}), InputError) << "pitch of a joint that turns";
    EXPECT_THROW(Chain({rail(-0.02)}, {slide}), InputError) << "pitch below 0";
    EXPECT_THROW(Chain({rail(nan)}, {slide}), InputError) << "NaN pitch";
}

TEST(Chain, RefusesConfigurationsItCannotTake) {
    const Chain arm = planar_arm({1, 1});
    EXPECT_NO_THROW(arm.check_configuration(Vector2d(0, 9)));
    EXPECT_THROW(arm.check_configuration(VectorXd::Zero(3)), InputError);
    const double infinity = std::numeric_limits<double>::infinity();
    EXPECT_THROW(arm.check_configuration(Vector2d(0, infinity)), InputError);
}

TEST(Chain, KnowsTheFramesOfItsLinks) {
    const Chain arm = planar_arm({1, 0.8});
    const VectorXd q = Eigen::Vector2d(90 * degree, -90 * degree);
    const auto links = arm.base_from_links(q, VectorXd::Zero(4));
    ASSERT_EQ(links.size(), 4U);
    EXPECT_TRUE(links[0].isApprox(Isometry3d::Identity()));
    EXPECT_LT(links[1].translation().norm(), 1e-15);
    EXPECT_LT((links[1].linear().col(0) - Vector3d::UnitY()).norm(), 1e-15);
    EXPECT_LT((links[2].translation() - Vector3d(0, 1, 0)).norm(), 1e-15);
    EXPECT_LT((links[2].linear().col(0) - Vector3d::UnitX()).norm(), 1e-15);
    EXPECT_LT((links[3].translation() - Vector3d(0.8, 1, 0)).norm(), 1e-15);
}

TEST(Chain, PutsTheFrameOfACoupledJointBehindItsFirstElement) {
    const auto R = Motion::Rotation;
    Element elbow = driven(R, Axis::Y, 1);
    elbow.joints.push_back({0, -1});
    const Chain parallelogram({{"q1", -1, 1}, {"q2", -1, 1}},
                              {driven(R, Axis::Y, 0), translation(Axis::Z, 1), elbow});
    const auto links = parallelogram.base_from_links(Eigen::Vector2d(0.5, 0.2), VectorXd());
    EXPECT_LT(links[1].translation().norm(), 1e-15);
    EXPECT_NEAR(links[2].translation().norm(), 1, 1e-15);
    EXPECT_TRUE(links[3].isApprox(links[2]));
}

TEST(ManyFlanges, AreTheSameToTheLastDigitAsOneByOne) {
    for (const Chain& robot : {fanuc(), detail::full_model(fanuc(), -9.81 * Vector3d::UnitZ())}) {
        RandomStream stream(31);
        VectorXd parameters = 1e-2 * stream.normals(robot.parameter_count());
        parameters[1] = 0;
        for (const double largest : {4.0, 3e6}) {  // the latter is beyond what vectors take
            RowMatrixXd configurations(13, robot.configuration_size());
            for (double& q : configurations.reshaped()) q = stream.uniform(-largest, largest);
            for (int width = 2; width <= detail::simd::widest(); width *= 2) {
                detail::simd::use_width(width);
                const auto flanges = robot.base_from_flanges(configurations, parameters);
                ASSERT_EQ(flanges.size(), 13U);
                for (Index i = 0; i < 13; ++i) {
                    const Isometry3d alone =
                        robot.base_from_flange(configurations.row(i).transpose(), parameters);
                    EXPECT_EQ(flanges[static_cast<std::size_t>(i)].matrix(), alone.matrix());
                }
            }
            detail::simd::use_width(detail::simd::widest());
        }
    }
    EXPECT_TRUE(fanuc().base_from_flanges(RowMatrixXd(0, 6), VectorXd::Zero(18)).empty());
}

TEST(Chain, IsWholeWhereItWasMovedFrom) {
    Chain robot = fanuc();
    const Chain other = std::move(robot);
    EXPECT_EQ(robot.joint_count(), other.joint_count());  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace posewise
