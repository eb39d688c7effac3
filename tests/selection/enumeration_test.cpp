#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>
#include <atomic>

#include "../../src/selection/bound.hpp"
#include "posewise/selection/choice.hpp"
#include "support/designs.hpp"

/// The search against all 38 760 choices of 6 out of 20, enumerated independently of the library.
namespace posewise {
namespace {

constexpr Index candidate_count = 20;
constexpr Index pose_count = 6;

struct BestValues {
    double D = -std::numeric_limits<double>::infinity();
    double A = 0;
    double V = 0;
    double E = 0;
};

/// Keeps the best of every criterion of the information matrices it is shown.
class Enumeration {
  public:
    Enumeration(const Blocks& candidates, const MatrixXd& held)
        : mean_(information(candidates) / static_cast<double>(candidates.count())) {
        for (Index i = 0; i < candidates.count(); ++i) {
            informations_.push_back(information(candidates, {i}));
        }
        complete(0, pose_count, held);
    }

    const BestValues& best() const { return best_; }

  private:
    void complete(Index from, Index missing, const MatrixXd& M) {
        if (missing == 0) return show(M);
        for (Index i = from; i + missing <= candidate_count; ++i) {
            const MatrixXd more = M + informations_[static_cast<std::size_t>(i)];
            complete(i + 1, missing - 1, more);
        }
    }

    void show(const MatrixXd& M) {
        const Eigen::LLT<MatrixXd> cholesky(M);
        if (cholesky.info() != Eigen::Success) return;
        const auto pivots = cholesky.matrixLLT().diagonal().array();
        const MatrixXd identity = MatrixXd::Identity(M.rows(), M.cols());
        const MatrixXd W = cholesky.solve(identity);
        if (pivots.minCoeff() < 1e-6) return;  // singular but for rounding
        best_.D = std::max(best_.D, 2 * pivots.log().sum());
        best_.A = std::max(best_.A, 1 / W.trace());
        best_.V = std::max(best_.V, 1 / W.cwiseProduct(mean_).sum());
        const Eigen::LLT<MatrixXd> shifted(M - best_.E * identity);
        if (shifted.info() != Eigen::Success) return;  // the least eigenvalue is not larger
        const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(M, Eigen::EigenvaluesOnly);
        best_.E = std::max(best_.E, eigen.eigenvalues()[0]);
    }

    MatrixXd mean_;
    std::vector<MatrixXd> informations_;
    BestValues best_;
};

struct Shape {
    Index rows = 1;
    Index parameters = 5;
    bool has_prior = false;
};

void expect_best_found(const Shape& shape, std::uint64_t seed) {
    const Blocks candidates =
        test::random_blocks(candidate_count, shape.rows, shape.parameters, seed);
    SelectOptions options;
    options.pose_count = pose_count;
    options.proof = 0;  // so that it is the search that finds
    const MatrixXd identity = MatrixXd::Identity(shape.parameters, shape.parameters);
    if (shape.has_prior) options.held_rows = identity;
    const BestValues best =
        Enumeration(candidates, shape.has_prior ? identity : MatrixXd(0 * identity)).best();
    for (const auto& [criterion, value] :
         {std::pair{Criterion::D, best.D}, std::pair{Criterion::A, best.A},
          std::pair{Criterion::V, best.V}, std::pair{Criterion::E, best.E}}) {
        options.criterion = criterion;
        const Choice plan = select_poses(candidates, options);
        EXPECT_NEAR(plan.value, value, 1e-9 * std::abs(value))
            << criterion_name(criterion) << ", " << shape.rows << " rows, " << shape.parameters
            << " parameters, prior " << shape.has_prior;
        EXPECT_GE(plan.bound, value - 1e-9 * std::abs(value));
    }
}

TEST(SelectAgainstEnumeration, FindsTheBestOfAllChoices) {
    constexpr std::array shapes = {Shape{1, 5}, Shape{2, 9}, Shape{3, 17}, Shape{9, 33}};
    for (std::size_t k = 0; k < shapes.size(); ++k) expect_best_found(shapes[k], 103 + k);
}

TEST(SelectAgainstEnumeration, FindsTheBestWithAPriorAndFewerRowsThanParameters) {
    constexpr std::array shapes = {Shape{1, 9, true}, Shape{1, 33, true}};
    for (std::size_t k = 0; k < shapes.size(); ++k) expect_best_found(shapes[k], 200 + k);
}

/// All choices are tried or ruled out, and the best one is found: of equals the first.
void expect_proven(const Blocks& candidates, const SelectOptions& options) {
    double best = -std::numeric_limits<double>::infinity();
    std::vector<Index> first;
    test::for_each_choice(candidates.count(), options, [&](const std::vector<Index>& poses) {
        const double value = detail::choice_value(candidates, options, poses);
        if (!(value > best + 1e-11 * std::abs(value))) return;
        best = value;
        first = poses;
    });
    const Choice plan = select_poses(candidates, options);
    EXPECT_EQ(plan.ending, Ending::Optimal) << criterion_name(options.criterion);
    EXPECT_NEAR(plan.value, best, 1e-11 * std::abs(best)) << criterion_name(options.criterion);
    EXPECT_EQ(plan.poses, first) << criterion_name(options.criterion);
    EXPECT_EQ(plan.bound, plan.value);
    EXPECT_EQ(plan.efficiency, 1);
    EXPECT_GE(plan.tried, 1);
}

SelectOptions few_poses(Criterion criterion, Index count) {
    SelectOptions options;
    options.criterion = criterion;
    options.pose_count = count;
    return options;
}

TEST(Enumeration, ProvesTheBestChoiceByEveryCriterion) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
        const Blocks candidates = test::random_blocks(12, 3, 13, 400 + seed);
        for (const Criterion criterion : all_criteria) {
            SelectOptions options = few_poses(criterion, 5);
            expect_proven(candidates, options);
            options.held_rows = std::sqrt(0.1) * MatrixXd::Identity(13, 13);
            options.pose_count = 3;
            expect_proven(candidates, options);
        }
    }
}

TEST(Enumeration, HonoursEveryLimit) {
    const Blocks candidates = test::random_blocks(9, 2, 5, 7);
    for (const Criterion criterion : all_criteria) {
        SelectOptions repeats = few_poses(criterion, 5);
        repeats.repeat_limit = 3;
        expect_proven(candidates, repeats);
        SelectOptions limited = few_poses(criterion, 4);
        limited.excluded = {4};
        limited.groups = {5, 5, 5, -1, -1, -1, 0, 0, 0};
        limited.group_limit = 2;
        limited.positions = VectorXd::LinSpaced(9, 0, 8);
        limited.least_distance = 1.5;
        expect_proven(candidates, limited);
    }
}

TEST(Enumeration, LeavesNuisanceOutOfTheValue) {
    const Blocks candidates = test::random_blocks(10, 2, 6, 9);
    for (const Criterion criterion :
         {Criterion::O1, Criterion::O3, Criterion::O5, Criterion::A, Criterion::D, Criterion::E}) {
        SelectOptions options = few_poses(criterion, 4);
        options.nuisance = {0, 2, 5};
        expect_proven(candidates, options);
    }
}

TEST(Enumeration, TakesTheFirstOfEquallyGoodChoices) {
    Blocks candidates = test::random_blocks(10, 2, 4, 11);
    candidates.matrix.bottomRows(10) = candidates.matrix.topRows(10);  // each is there twice
    for (const Criterion criterion : all_criteria) {
        expect_proven(candidates, few_poses(criterion, 4));
    }
}

TEST(Enumeration, GivesTheSamePlanForAnyNumberOfThreads) {
    const Blocks candidates = test::random_blocks(18, 3, 14, 12);
    const int threads = omp_get_max_threads();
    for (const Criterion criterion : all_criteria) {
        const SelectOptions options = few_poses(criterion, 5);
        omp_set_num_threads(1);
        const Choice serial = select_poses(candidates, options);
        omp_set_num_threads(3);
        const Choice parallel = select_poses(candidates, options);
        EXPECT_EQ(serial.ending, Ending::Optimal);
        EXPECT_EQ(serial.poses, parallel.poses);
        EXPECT_EQ(serial.value, parallel.value);
        EXPECT_EQ(serial.tried, parallel.tried);
    }
    omp_set_num_threads(threads);
}

TEST(Enumeration, ProvesMoreTheLongerItLasts) {
    const Blocks candidates = test::random_blocks(60, 3, 20, 13);
    for (const Criterion criterion : {Criterion::D, Criterion::O4}) {
        SelectOptions options = few_poses(criterion, 9);
        options.starts = 1;
        options.kicks = 0;
        double bound = std::numeric_limits<double>::infinity();
        for (const double seconds : {0.0, 0.3}) {
            options.proof = seconds;
            const Choice plan = select_poses(candidates, options);
            EXPECT_EQ(plan.ending, Ending::Converged);
            EXPECT_LT(plan.efficiency, 1);
            EXPECT_LT(plan.bound, bound) << seconds;
            bound = plan.bound;
        }
    }
}

TEST(Enumeration, TellsHowFarItIsAndEndsWithTheBestSoFar) {
    const Blocks candidates = test::random_blocks(60, 3, 20, 14);
    SelectOptions options = few_poses(Criterion::D, 9);
    options.starts = 1;
    options.kicks = 0;
    options.proof = 1e6;
    std::atomic<bool> is_interrupted = false;
    options.stop.interrupted = &is_interrupted;
    Index calls = 0;
    options.progress = [&](const Progress& progress) {
        EXPECT_LE(progress.done, progress.total);
        is_interrupted = ++calls >= 5;
    };
    const Choice plan = select_poses(candidates, options);
    EXPECT_GE(calls, 5);
    EXPECT_EQ(plan.ending, Ending::Interrupted);
    EXPECT_EQ(plan.poses.size(), 9U);
    EXPECT_LT(plan.efficiency, 1);
    EXPECT_GT(plan.efficiency, 0.1);
}

}  // namespace
}  // namespace posewise
