#include "posewise/model/dh.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "../../src/model/complete_model.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace detail;
using namespace testing;
using Eigen::Matrix4d;

/// The matrix textbooks print for the standard convention.
Matrix4d textbook_standard(double a, double alpha, double d, double theta) {
    const double ct = std::cos(theta), st = std::sin(theta);
    const double ca = std::cos(alpha), sa = std::sin(alpha);
    Matrix4d T;
    T << ct, -st * ca, st * sa, a * ct,  //
        st, ct * ca, -ct * sa, a * st,   //
        0, sa, ca, d,                    //
        0, 0, 0, 1;
    return T;
}

/// The same for the modified convention [Craig 1986, eq. 3.6].
Matrix4d textbook_modified(double a, double alpha, double d, double theta) {
    const double ct = std::cos(theta), st = std::sin(theta);
    const double ca = std::cos(alpha), sa = std::sin(alpha);
    Matrix4d T;
    T << ct, -st, 0, a,                  //
        st * ca, ct * ca, -sa, -sa * d,  //
        st * sa, ct * sa, ca, ca * d,    //
        0, 0, 0, 1;
    return T;
}

DhRow random_row(RandomStream& stream, Motion motion) {
    const VectorXd x = random_vector(stream, 4, 2);
    return {x[0], x[1], x[2], x[3], motion, {{0, 1.0}}};
}

Matrix4d pose_of(const std::vector<Element>& elements, double q) {
    const Chain chain({{"q1", -4, 4}}, elements);
    return chain.base_from_flange(VectorXd::Constant(1, q), VectorXd()).matrix();
}

TEST(DhElements, AreTheTextbooksMatrices) {
    RandomStream stream(5);
    for (int i = 0; i < 20; ++i) {
        const double q = stream.uniform(-3, 3);
        const DhRow turning = random_row(stream, Motion::Rotation);
        EXPECT_TRUE(
            pose_of(dh_elements(turning), q)
                .isApprox(textbook_standard(turning.a, turning.alpha, turning.d, turning.theta + q),
                          1e-14));
        const DhRow sliding = random_row(stream, Motion::Translation);
        EXPECT_TRUE(
            pose_of(dh_elements(sliding), q)
                .isApprox(textbook_standard(sliding.a, sliding.alpha, sliding.d + q, sliding.theta),
                          1e-14));
    }
}

TEST(MdhElements, AreTheTextbooksMatrices) {
    RandomStream stream(6);
    for (int i = 0; i < 20; ++i) {
        const double q = stream.uniform(-3, 3);
        const DhRow turning = random_row(stream, Motion::Rotation);
        EXPECT_TRUE(
            pose_of(mdh_elements(turning), q)
                .isApprox(textbook_modified(turning.a, turning.alpha, turning.d, turning.theta + q),
                          1e-14));
        const DhRow sliding = random_row(stream, Motion::Translation);
        EXPECT_TRUE(
            pose_of(mdh_elements(sliding), q)
                .isApprox(textbook_modified(sliding.a, sliding.alpha, sliding.d + q, sliding.theta),
                          1e-14));
    }
}

TEST(DhElements, LeaveOutWhatDoesNothing) {
    const DhRow row{0, 90 * degree, 0, 0, Motion::Rotation, {{0, -1.0}}};
    const auto elements = dh_elements(row);
    ASSERT_EQ(elements.size(), 2U);
    EXPECT_EQ(elements[0].joints[0].coefficient, -1) << "a reversed joint";
    EXPECT_EQ(elements[1].value, 90 * degree);
    EXPECT_EQ(mdh_elements(row)[1].joints.size(), 1U);
}

TEST(DhElements, OfAFixedRowHaveNoJoint) {
    const DhRow row{0.1, 0.2, 0.3, 0.4, Motion::Rotation, {}};
    for (const Element& element : dh_elements(row)) EXPECT_TRUE(element.joints.empty());
    EXPECT_EQ(dh_elements(row).size(), 4U);
}

TEST(DhElements, OfNearlyParallelAxesTurnAboutYLast) {
    DhRow row{0.1, 0.2, 0, 0.4, Motion::Rotation, {{0, 1.0}}};
    const Matrix4d without = pose_of(dh_elements(row), 0.3);
    row.beta = 0.25;
    Matrix4d about_y = Matrix4d::Identity();
    about_y.topLeftCorner<3, 3>() =
        Eigen::AngleAxisd(row.beta, Vector3d::UnitY()).toRotationMatrix();
    EXPECT_TRUE(pose_of(dh_elements(row), 0.3).isApprox(without * about_y, 1e-14));
}

/// The rows as a chain of the same joints.
Chain chain_of(const Chain& chain, const std::vector<DhRow>& rows) {
    std::vector<Element> elements;
    for (const DhRow& row : rows) {
        for (Element& element : dh_elements(row)) elements.push_back(std::move(element));
    }
    return Chain(chain.joints(), elements);
}

void expect_same_flange(const Chain& chain, const VectorXd& errors, const std::vector<DhRow>& rows,
                        RandomStream& stream, double tolerance) {
    const Chain again = chain_of(chain, rows);
    for (int i = 0; i < 20; ++i) {
        const VectorXd q = random_vector(stream, chain.joint_count(), 2);
        EXPECT_LT((again.base_from_flange(q, VectorXd()).matrix() -
                   chain.base_from_flange(q, errors).matrix())
                      .norm(),
                  tolerance);
    }
}

TEST(DhRows, MoveTheFlangeExactlyAsTheChainDoes) {
    const std::vector<Chain> chains{fanuc(), planar_arm({1, 0.8, 0.5}), gantry_with_wrist(),
                                    scara(), complete_model(fanuc()),   complete_model(scara())};
    for (const Chain& chain : chains) {
        for (const double size : {0.0, 1e-3, 0.2}) {
            RandomStream stream(77);
            const VectorXd errors = random_vector(stream, chain.parameter_count(), size);
            const auto rows = dh_rows(chain, errors);
            EXPECT_LE(static_cast<Index>(rows.size()), chain.joint_count() + 2);
            expect_same_flange(chain, errors, rows, stream, 1e-12);
        }
    }
}

/// Of a UR, whose axes 2, 3 and 4 are parallel but for their errors.
TEST(DhRows, OfAxesThatAreNearlyParallelHaveNoFarOffsets) {
    const Chain chain = complete_model(ur_type());
    for (const double size : {1e-11, 1e-8, 1e-5, 1e-3, 0.05}) {
        RandomStream stream(78);
        const VectorXd errors = random_vector(stream, chain.parameter_count(), size);
        const auto rows = dh_rows(chain, errors);
        for (const DhRow& row : rows) {
            EXPECT_LT(std::hypot(row.a, row.d), 1) << size;
            EXPECT_TRUE(row.beta == 0 || row.d == 0) << "one of them says it";
        }
        EXPECT_NE(rows[1].beta, 0) << size;
        EXPECT_NE(rows[2].beta, 0) << size;
        EXPECT_EQ(rows[0].beta, 0) << "of axes that cross";
        SCOPED_TRACE(size);
        expect_same_flange(chain, errors, rows, stream, 1e-13);
    }
}

/// The table of a Motoman MA1400: a row that turns x the other way moves the flange the same.
TEST(DhRows, TurnTheirXAxesAsTheElementsDo) {
    constexpr double right = std::numbers::pi / 2;
    const std::vector<DhRow> table{{0.15, -right, 1.4159, 0, Motion::Rotation, {{0, 1.0}}},
                                   {0.614, 2 * right, 0, -right, Motion::Rotation, {{1, 1.0}}},
                                   {0.2, -right, 0, 0, Motion::Rotation, {{2, 1.0}}},
                                   {0, right, -0.64, 0, Motion::Rotation, {{3, 1.0}}},
                                   {0.03, right, 0, -right, Motion::Rotation, {{4, 1.0}}},
                                   {0, 0, 0.2, 0, Motion::Rotation, {{5, 1.0}}}};
    std::vector<Element> elements;
    for (const DhRow& row : table) {
        for (Element& element : dh_elements(row)) elements.push_back(std::move(element));
    }
    std::vector<Joint> joints;
    for (int j = 1; j <= 6; ++j) joints.push_back({"q" + std::to_string(j), -2, 2});
    const Chain chain = complete_model(Chain(joints, elements));
    RandomStream stream(79);
    const VectorXd errors = random_vector(stream, chain.parameter_count(), 1e-4);
    const auto rows = dh_rows(chain, errors);
    for (std::size_t k = 0; k < 5; ++k) {
        EXPECT_NEAR(rows[k].a, table[k].a, 1e-2) << k;
        EXPECT_NEAR(std::remainder(rows[k].alpha - table[k].alpha, 4 * right), 0, 1e-2) << k;
        EXPECT_NEAR(std::remainder(rows[k].theta - table[k].theta, 4 * right), 0, 0.1) << k;
    }
    expect_same_flange(chain, errors, rows, stream, 1e-13);
}

TEST(DhRows, OfATextbookRobotAreItsTable) {
    std::vector<Element> elements;
    const std::vector<DhRow> table{
        {0, std::numbers::pi / 2, 0.1273, 0, Motion::Rotation, {{0, 1.0}}},
        {0.612, 0, 0, 0, Motion::Rotation, {{1, 1.0}}},
        {0.1, 0, 0.3, 0, Motion::Rotation, {{2, 1.0}}}};
    for (const DhRow& row : table) {
        for (Element& element : dh_elements(row)) elements.push_back(std::move(element));
    }
    const auto rows = dh_rows(Chain({{"q1", -3, 3}, {"q2", -3, 3}, {"q3", -3, 3}}, elements), {});
    ASSERT_EQ(rows.size(), 4U);  // d of the last one is the tool's, behind a
    EXPECT_NEAR(rows[0].d, 0.1273, 1e-15);
    EXPECT_NEAR(rows[0].alpha, std::numbers::pi / 2, 1e-15);
    EXPECT_NEAR(rows[1].a, 0.612, 1e-15);
    EXPECT_NEAR(rows[2].a, 0.1, 1e-15);
    EXPECT_NEAR(rows[3].d, 0.3, 1e-15);
}

}  // namespace
}  // namespace posewise
