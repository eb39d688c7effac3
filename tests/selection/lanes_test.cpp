#include "../../src/selection/lanes.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include "../../src/core/sensitivities.hpp"
#include "../../src/selection/gains.hpp"
#include "../../src/selection/projected_gradient.hpp"
#include "support/designs.hpp"

namespace posewise {
namespace {

using namespace detail;
using test::indices_below;

TEST(Lanes, GainsMatchTheirDefinitionForEveryHeight) {
    constexpr Index L = 11;
    for (const Index rows : {1, 2, 3, 4, 6, 9, 11, 12}) {
        const Blocks candidates = test::random_blocks(13, rows, L, 1);
        const LaneBlocks lanes = make_lane_blocks(candidates, indices_below(13));
        const MatrixXd F = test::random_blocks(L, 1, L, 2).matrix;
        const MatrixXd E = test::random_blocks(L, 1, L, 3).matrix;
        const MatrixXd P = test::random_blocks(L, 1, rows, 4).matrix;
        const MatrixXd Q = test::random_blocks(L, 1, rows, 5).matrix;
        const LaneGrams G = make_grams(lanes, F);
        const LaneGrams H = make_grams(lanes, E);
        const std::vector<char> asked(2, 1);
        std::vector<Lane> determinants(2);
        std::vector<Lane> traces(2);
        lane_determinants(lanes, G, P, asked, determinants);
        lane_traces(lanes, G, H, P, Q, asked, traces);
        const VectorXd gram_trace = gram_traces(lanes, G);
        for (Index i = 0; i < 13; ++i) {
            const auto group = static_cast<std::size_t>(i / lane_width);
            const auto lane = static_cast<std::size_t>(i % lane_width);
            const MatrixXd B = candidates[i];
            const MatrixXd S = MatrixXd::Identity(rows, rows) +
                               B * (F * F.transpose() + P * P.transpose()) * B.transpose();
            const MatrixXd T =
                B * (E * E.transpose() + P * Q.transpose() + Q * P.transpose()) * B.transpose();
            const double determinant = S.determinant();
            const double trace = S.llt().solve(T).trace();
            EXPECT_NEAR(determinants[group].of[lane], determinant, 1e-9 * determinant);
            EXPECT_NEAR(traces[group].of[lane], trace, 1e-9 * (1 + std::abs(trace)));
            EXPECT_NEAR(gram_trace[i], (B * F).squaredNorm(), 1e-10 * gram_trace[i]);
        }
    }
}

/// What a removal of block 0 from M and each block's addition gain, and the sensitivities.
VectorXd everything_known(Gains& gains, const Blocks& candidates) {
    const Index count = candidates.count();
    EXPECT_TRUE(gains.remove(candidates[0]));
    VectorXd known(2 * count);
    known.head(count) = gains.compute(indices_below(count));
    for (Index i = 0; i < count; ++i) known[count + i] = gains.sensitivity(i);
    return known;
}

/// Calls `check` with 40 candidates of several heights, for the determinant and for a trace.
template <class Check>
void check_gains(const Check& check) {
    for (const Index rows : {1, 3, 9, 13}) {  // 13: no kernel
        constexpr Index L = 15;
        const Blocks candidates = test::random_blocks(40, rows, L, 1);
        const Shortlist shortlist = make_shortlist(candidates, indices_below(40));
        const MatrixXd C_root = test::random_blocks(L, 1, L, 2).matrix;
        for (const MatrixXd& root : {MatrixXd(), C_root}) check(rows, candidates, shortlist, root);
    }
}

TEST(Gains, AreTheSameByUpdatesAsFromTheStart) {
    check_gains([](Index rows, const Blocks& candidates, const Shortlist& shortlist,
                   const MatrixXd& root) {
        std::vector<Index> poses = indices_below(20);
        Gains updated(candidates, shortlist);
        updated.move_to(information(candidates, poses), root);
        for (Index i = 1; i < 20; ++i) {
            ASSERT_TRUE(updated.remove(candidates[i]));
            poses[static_cast<std::size_t>(i)] = i + 20;
            updated.exchange(candidates[i + 20], information(candidates, poses));
        }
        Gains anew(candidates, shortlist);
        anew.move_to(information(candidates, poses), root);
        const VectorXd expected = everything_known(anew, candidates);
        const VectorXd found = everything_known(updated, candidates);
        for (Index k = 0; k < expected.size(); ++k) {
            EXPECT_NEAR(found[k], expected[k], 1e-9 * std::abs(expected[k])) << rows << ' ' << k;
        }
    });
}

TEST(Gains, RuleOutWhatIsNoBetterThanTheRemovedBlock) {
    check_gains(
        [](Index rows, const Blocks& candidates, const Shortlist& shortlist, const MatrixXd& root) {
            Gains gains(candidates, shortlist);
            gains.move_to(information(candidates, indices_below(20)), root);
            for (Index i = 0; i < 20; ++i) {
                ASSERT_TRUE(gains.remove(candidates[i]));
                const double own = gains.compute({i})[0];
                EXPECT_LE(gains.least_gain(), own);
                EXPECT_GE(gains.least_gain(), own * (1 - 2e-8)) << rows << ' ' << i;
            }
        });
}

TEST(Gains, AreFoundLargestWhateverSinglePrecisionSays) {
    check_gains([](Index rows, const Blocks& candidates, const Shortlist&, const MatrixXd& root) {
        // Of one pose and one candidate: single precision loses what the others tell beside them.
        for (const double strength : {1.0, 1e3, 1e6, 1e9}) {
            Blocks uneven = candidates;
            for (const Index strong : {5, 25}) {
                const Index first = uneven.first_row[static_cast<std::size_t>(strong)];
                uneven.matrix.middleRows(first, rows) *= strength;
            }
            const Shortlist shortlist = make_shortlist(uneven, indices_below(40));
            Gains gains(uneven, shortlist);
            gains.move_to(information(uneven, indices_below(20)), root);
            for (Index i = 0; i < 20; ++i) {
                if (!gains.remove(uneven[i])) continue;
                const VectorXd all = gains.compute(indices_below(40));
                Index largest = -1;
                const double most = all.maxCoeff(&largest);
                const auto [position, gain] = gains.find_largest(indices_below(40));
                EXPECT_EQ(position, largest) << rows << ' ' << strength << ' ' << i;
                EXPECT_EQ(gain, most);
            }
        }
    });
}

TEST(Gains, AreRoughlyTheSameInSinglePrecision) {
    check_gains(
        [](Index rows, const Blocks& candidates, const Shortlist& shortlist, const MatrixXd& root) {
            Gains gains(candidates, shortlist);
            gains.move_to(information(candidates, indices_below(20)), root);
            ASSERT_TRUE(gains.remove(candidates[3]));
            const VectorXd exact = gains.compute(indices_below(40));
            const VectorXd rough = gains.compute_roughly();
            ASSERT_EQ(rough.size(), 40);
            for (Index i = 0; i < 40; ++i) {
                EXPECT_NEAR(rough[i], exact[i], 1e-4 * exact[i]) << rows << ' ' << i;
            }
            EXPECT_EQ(rows < 13, rough != exact) << rows;
        });
}

TEST(Gains, RuleOutExactlyWhatPredictsATestPoseTooBadly) {
    constexpr Index L = 15;
    for (const Index rows : {1, 3, 9, 13}) {  // 13: no kernel, nothing is ruled out
        const Blocks candidates = test::random_blocks(41, rows, L, 1);
        const Blocks test_poses = test::random_blocks(5, 4, L, 2);  // lower and higher than those
        const Shortlist shortlist = make_shortlist(candidates, indices_below(41));
        const MatrixXd M = information(candidates, indices_below(20));
        Gains gains(candidates, shortlist);
        gains.move_to(M, MatrixXd());
        ASSERT_TRUE(gains.remove(candidates[3]));
        const MatrixXd remaining = M - candidates[3].transpose() * candidates[3];
        VectorXd worst = VectorXd::Zero(41);
        std::vector<RowMatrixXd> poses;
        for (Index t = 0; t < 5; ++t) poses.emplace_back(test_poses[t]);
        for (Index i = 0; i < 41; ++i) {
            const MatrixXd W = (remaining + candidates[i].transpose() * candidates[i])
                                   .llt()
                                   .solve(MatrixXd::Identity(L, L));
            for (const RowMatrixXd& B0 : poses) {
                worst[i] = std::max(worst[i], (B0 * W * B0.transpose()).trace());
            }
        }
        for (const double most : {worst.minCoeff() * 1.001, worst.mean(), worst.maxCoeff() * 1.1}) {
            std::vector<Index> expected;
            for (Index i = 0; i < 41; ++i) {
                if (rows > 12 || worst[i] < most) expected.push_back(i);
            }
            EXPECT_EQ(gains.keeping_below(most, poses), expected) << rows;
        }
    }
}

TEST(Sensitivities, MatchTheirDefinitionForAnyShape) {
    for (const Index parameters : {1, 5, 16, 17, 33}) {
        const Blocks candidates = test::random_blocks(30, 3, parameters, 1);
        const MatrixXd definite = information(test::random_blocks(40, 1, parameters, 2));
        for (const MatrixXd& Z : {definite, MatrixXd(-definite)}) {
            const VectorXd d = sensitivities(candidates, Z);
            for (Index i = 0; i < 30; ++i) {
                const double expected = (candidates[i] * Z * candidates[i].transpose()).trace();
                EXPECT_NEAR(d[i], expected, 1e-11 * std::abs(expected));
            }
        }
    }
}

TEST(ProjectionOnTheCappedSimplex, IsFeasibleAndNearest) {
    for (std::uint64_t seed = 0; seed < 200; ++seed) {
        RandomStream random(seed);
        const Index n = 1 + random.index(20);
        VectorXd point(n);
        VectorXd upper(n);
        for (double& x : point) x = 3 * random.normal();
        for (double& u : upper) u = static_cast<double>(1 + random.index(3));
        const double total = random.uniform(0, upper.sum());
        const VectorXd w = project_on_capped_simplex(point, upper, total);
        EXPECT_NEAR(w.sum(), total, 1e-12 * (1 + total));
        EXPECT_GE(w.minCoeff(), 0);
        EXPECT_LE((w - upper).maxCoeff(), 0);
        // (point - w) has no component towards any other feasible weight.
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j < n; ++j) {
                if (w[i] < upper[i] - 1e-12 && w[j] > 1e-12) {
                    EXPECT_LE(point[i] - w[i], point[j] - w[j] + 1e-11);
                }
            }
        }
    }
}

}  // namespace
}  // namespace posewise
