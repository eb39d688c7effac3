#include "../../src/core/nlopt_adapter.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "posewise/core/errors.hpp"

namespace posewise::detail {
namespace {

constexpr Method every_method[] = {Method::Lbfgs, Method::Sbplx, Method::Cobyla};

/// -(x - 1)^2 - 2 (y + 0.5)^2 on [-2, 2]^2.
BoxProblem paraboloid() {
    BoxProblem problem;
    problem.lower = VectorXd::Constant(2, -2);
    problem.upper = VectorXd::Constant(2, 2);
    problem.value = [](const VectorXd& x, VectorXd* slope) {
        if (slope != nullptr) *slope << -2 * (x[0] - 1), -4 * (x[1] + 0.5);
        return -std::pow(x[0] - 1, 2) - 2 * std::pow(x[1] + 0.5, 2);
    };
    return problem;
}

TEST(Maximise, FindsTheTopByEveryMethod) {
    for (const Method method : every_method) {
        const Maximum top = maximise(paraboloid(), VectorXd::Zero(2), {method});
        EXPECT_NEAR(top.value, 0, 1e-9);
        EXPECT_TRUE(top.x.isApprox(Eigen::Vector2d(1, -0.5), 1e-4));
        EXPECT_NE(top.ending, Ending::NotRun);
    }
}

TEST(Maximise, StopsAtTheBoundsAndKeepsFixedCoordinates) {
    BoxProblem problem = paraboloid();
    problem.upper[0] = 0.25;
    problem.lower[1] = problem.upper[1] = 0;
    for (const Method method : every_method) {
        const Maximum top = maximise(problem, VectorXd::Zero(2), {method});
        EXPECT_NEAR(top.x[0], 0.25, 1e-6);
        EXPECT_EQ(top.x[1], 0);
    }
}

TEST(Maximise, LetsOurExceptionsThroughUnchanged) {
    BoxProblem problem = paraboloid();
    int calls = 0;
    problem.value = [&calls](const VectorXd&, VectorXd*) -> double {
        if (++calls > 1) throw InputError("the very message");
        return 0;
    };
    for (const Method method : every_method) {
        calls = 0;
        try {
            maximise(problem, VectorXd::Zero(2), {method});
            FAIL() << "no exception";
        } catch (const InputError& error) {
            EXPECT_STREQ(error.what(), "the very message");
        }
    }
}

TEST(Maximise, IsNeverWorseThanItsStartWhateverTheGradientSays) {
    BoxProblem problem = paraboloid();
    const auto right = problem.value;
    problem.value = [right](const VectorXd& x, VectorXd* slope) {
        const double value = right(x, slope);
        if (slope != nullptr) *slope = -*slope;
        return value;
    };
    const Eigen::Vector2d start(0.9, -0.4);
    const Maximum top = maximise(problem, start, {Method::Lbfgs});
    EXPECT_GE(top.value, right(start, nullptr));
    EXPECT_EQ(top.value, right(top.x, nullptr));
}

TEST(Maximise, StartingAtTheTopIsNotAnError) {
    for (const Method method : every_method) {
        const Maximum top = maximise(paraboloid(), Eigen::Vector2d(1, -0.5), {method});
        EXPECT_EQ(top.value, 0);
    }
}

TEST(Maximise, LivesWithPointsOutsideTheDomain) {
    BoxProblem problem = paraboloid();
    problem.value = [](const VectorXd& x, VectorXd* slope) {  // log x0 - x0, top at 1
        if (slope != nullptr) slope->setZero();
        if (x[0] <= 0) return -std::numeric_limits<double>::infinity();
        if (slope != nullptr) (*slope)[0] = 1 / x[0] - 1;
        return std::log(x[0]) - x[0];
    };
    for (const Method method : every_method) {
        const Maximum top = maximise(problem, VectorXd::Constant(2, 0.01), {method});
        EXPECT_NEAR(top.value, -1, 1e-4) << static_cast<int>(method);
    }
}

TEST(Maximise, KeepsToTheFeasibleSideOfAConstraint) {
    BoxProblem problem = paraboloid();
    problem.margin = [](const VectorXd& x) { return 0.5 - x.norm(); };
    const Maximum top = maximise(problem, VectorXd::Zero(2), {Method::Cobyla});
    EXPECT_GE(problem.margin(top.x), 0);
    EXPECT_LT(problem.margin(top.x), 1e-4);
}

TEST(Maximise, StopsWhenAskedTo) {
    std::atomic<bool> interrupted = true;
    MaximiseOptions options;
    options.stop.interrupted = &interrupted;
    EXPECT_EQ(maximise(paraboloid(), VectorXd::Zero(2), options).ending, Ending::Interrupted);
    options.stop = {nullptr, std::chrono::steady_clock::now()};
    EXPECT_EQ(maximise(paraboloid(), VectorXd::Zero(2), options).ending, Ending::TimeLimit);
}

}  // namespace
}  // namespace posewise::detail
