#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/derivative_check.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

/// Values of the torque shapes of one joint, samples x shapes.
MatrixXd shape_values(const Chain& robot, const std::string& joint, const RowMatrixXd& q) {
    std::vector<const JointFunction*> functions;
    for (Index k = 0; k < robot.parameter_count(); ++k) {
        const ErrorTerm* const term = robot.parameter_term(k);
        if (term == nullptr || term->kind != TermKind::Torque) continue;
        if (term->parameter.starts_with(joint + '.')) functions.push_back(&term->function);
    }
    MatrixXd values(q.rows(), static_cast<Index>(functions.size()));
    for (Index i = 0; i < q.rows(); ++i) {
        for (std::size_t k = 0; k < functions.size(); ++k) {
            values(i, static_cast<Index>(k)) =
                functions[k]->torque->evaluate(q.row(i).transpose()).value;
        }
    }
    return values;
}

TEST(TorqueShapes, AreOrthogonalAndAtMostAsLargeAsASine) {
    const Chain robot = with_torque_shapes(without_parameters(fanuc()));
    const RowMatrixXd q = random_configurations(robot, 4000, 77);
    for (const std::string joint : {"q2", "q3", "q5"}) {
        MatrixXd values = shape_values(robot, joint, q);
        ASSERT_GT(values.cols(), 1) << joint;
        values.rowwise() -= values.colwise().mean().eval();
        const MatrixXd gram = values.transpose() * values / static_cast<double>(q.rows());
        EXPECT_LT(gram.diagonal().maxCoeff(), 0.55) << joint;
        EXPECT_GT(gram.diagonal().maxCoeff(), 0.05) << joint;
        const VectorXd sizes = gram.diagonal().cwiseSqrt();
        MatrixXd correlations =
            sizes.cwiseInverse().asDiagonal() * gram * sizes.cwiseInverse().asDiagonal();
        correlations.diagonal().setZero();
        EXPECT_LT(correlations.cwiseAbs().maxCoeff(), 0.25) << joint << '\n' << correlations;
    }
    EXPECT_EQ(shape_values(robot, "q1", q).cols(), 0);  // its axis is upright
}

TEST(TorqueShapes, ExplainTheTorqueOfWeightsAtTheJointsAndOfAnyTool) {
    RandomStream stream(5, 0);
    for (const Chain& robot : {fanuc(), ur_type(), seven_joint_arm()}) {
        const Chain shaped = with_torque_shapes(without_parameters(robot));
        const RowMatrixXd q = random_configurations(robot, 300, 8);
        std::vector<Load> loads;
        for (Index link = 1; link <= robot.joint_count() + 1; ++link) {
            const bool is_tool = link > robot.joint_count();
            loads.push_back({link, stream.uniform(2, 20),
                             is_tool ? Vector3d(random_vector(stream, 3, 0.1)) : Vector3d::Zero()});
        }
        const Chain bending = with_compliance(without_parameters(robot), loads);
        for (Index k = 0; k < bending.parameter_count(); ++k) {
            const ErrorTerm& term = *bending.parameter_term(k);
            VectorXd torque(q.rows());
            for (Index i = 0; i < q.rows(); ++i) {
                torque[i] = term.function.torque->evaluate(q.row(i).transpose()).value;
            }
            const MatrixXd shapes =
                shape_values(shaped, term.parameter.substr(0, term.parameter.find('.')), q);
            MatrixXd explaining(q.rows(), shapes.cols() + 1);
            explaining << shapes, VectorXd::Ones(q.rows());
            const VectorXd rest = torque - explaining * explaining.householderQr().solve(torque);
            torque.array() -= torque.mean();
            EXPECT_LT(rest.norm(), 0.05 * torque.norm()) << term.parameter;
        }
    }
}

class DifferentiatedFullModel : public ::testing::TestWithParam<Chain> {};

INSTANTIATE_TEST_SUITE_P(TorqueShapes, DifferentiatedFullModel,
                         ::testing::Values(without_parameters(fanuc()), arm_on_lift(),
                                           with_pitch(arm_on_lift(), 0, 1)));

TEST_P(DifferentiatedFullModel, AgreesWithDifferences) {
    const Chain robot = full_model(GetParam());
    const RowMatrixXd configurations = random_configurations(robot, 3, 4);
    RandomStream stream(6, 0);
    const VectorXd parameters = random_vector(stream, robot.parameter_count(), 1e-2);
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        FlangeMotion motion;
        robot.differentiate(Isometry3d::Identity(), q, parameters, motion);
        const Vector3d p = motion.world_from_flange.translation();
        const auto at_flange = [&](const TwistMatrix& twists) {
            MatrixXd J(3, twists.cols());
            for (Index k = 0; k < twists.cols(); ++k) {
                J.col(k) = twists.col(k).tail<3>() + Vector3d(twists.col(k).head<3>()).cross(p);
            }
            return J;
        };
        const auto position = [&](const VectorXd& joints, const VectorXd& errors) {
            return VectorXd(robot.base_from_flange(joints, errors).translation());
        };
        expect_is_jacobian(
            at_flange(motion.twists.rightCols(robot.parameter_count())),
            [&](const VectorXd& errors) { return position(q, errors); }, parameters);
        expect_is_jacobian(
            at_flange(motion.joint_twists),
            [&](const VectorXd& joints) { return position(joints, parameters); }, q);
    }
}

TEST(TorqueShapes, BendASlideAboutTheMiddleOfWhatIsOut) {
    const Chain robot = with_torque_shapes(arm_on_lift());
    const auto names = robot.parameter_names();
    const auto bends = [&](const char* start) {
        return std::count_if(names.begin(), names.end(),
                             [&](const std::string& name) { return name.starts_with(start); });
    };
    // Weights far out along x pull down about y, and none twists an upright column.
    EXPECT_GE(bends("lift.Rx.torque("), 1);
    EXPECT_GE(bends("lift.Ry.torque("), 1);
    EXPECT_EQ(bends("lift.Rz.torque("), 0);
    EXPECT_GE(bends("q2.torque("), 1);

    const auto found = std::find(names.begin(), names.end(), "lift.Ry.torque(q2)");
    ASSERT_NE(found, names.end());
    const Index k = found - names.begin();
    const GravityTorque& torque = *robot.parameter_term(k)->function.torque;
    VectorXd bent = VectorXd::Zero(robot.parameter_count());
    bent[k] = 1e-4;
    const VectorXd straight = VectorXd::Zero(robot.parameter_count());
    for (const double out : {0.0, 0.4, 0.8}) {
        const VectorXd q = Eigen::Vector3d(0.2 + out, 0.3, 0.1);
        const Isometry3d before = robot.base_from_flange(q, straight);
        const Isometry3d after = robot.base_from_flange(q, bent);
        EXPECT_TRUE(before.isApprox(arm_on_lift().base_from_flange(q, VectorXd()), 1e-14));
        const double angle = 1e-4 * torque.value(q) * out / 0.8;
        const Vector3d pivot(0, 0, 0.3 + 0.2 + out / 2);
        const Vector3d expected =
            angle * Vector3d::UnitY().cross(Vector3d(before.translation() - pivot));
        EXPECT_TRUE((after.translation() - before.translation()).isApprox(expected, 1e-3) ||
                    out == 0)
            << out;
        EXPECT_TRUE(out > 0 || after.isApprox(before, 1e-14));
    }
}

TEST(TorqueShapes, AreNotTakenForCompliances) {
    EXPECT_TRUE(compliances(with_torque_shapes(without_parameters(fanuc()))).empty());
    EXPECT_THROW(with_torque_shapes(fanuc(), Vector3d::Zero()), InputError);
}

TEST(Extent, IsHowFarTheFlangeSpreads) {
    const Chain lift({{"z", 0, 1.2}}, {driven(Motion::Translation, Axis::Z, 0)});
    EXPECT_NEAR(extent(lift), 1.2 / std::sqrt(12.0), 0.02);
}

}  // namespace
}  // namespace posewise
