#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <array>

#include "posewise/selection/exchange.hpp"
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
    options.enumeration = 0;  // so that it is the search that finds
    options.starts = 12;      // few poses: many local optima, and rounding decides which are met
    const MatrixXd identity = MatrixXd::Identity(shape.parameters, shape.parameters);
    if (shape.has_prior) options.held = identity;
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

}  // namespace
}  // namespace posewise
