#include <gtest/gtest.h>
#include <omp.h>

#include "../../src/model/halton.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
#include "support/cell_recheck.hpp"
#include "support/cells.hpp"

namespace posewise {
namespace {

using namespace detail;
using testing::cell_campaign;
using testing::CellRecheck;
using testing::degree;
using testing::demo_cell;

TEST(MakePool, KeepsOnlyPosesThatASeparateDenseCheckAccepts) {
    const Campaign campaign = cell_campaign();
    const Cell cell = demo_cell();
    const Pool pool = make_pool(Constraints(campaign, cell), 15000, 1);
    EXPECT_GT(pool.configurations.rows(), 1000);
    CellRecheck recheck(campaign, cell);
    for (Index i = 0; i < std::min<Index>(pool.configurations.rows(), 100); ++i) {
        const auto violations = recheck.violations(pool.configurations.row(i).transpose());
        EXPECT_TRUE(violations.empty()) << "pose " << i << ": " << violations.front();
        for (std::size_t j = 0; j < 3; ++j) {
            EXPECT_EQ(pool.is_seen(i, static_cast<Index>(j)), recheck.is_seen_[j]);
        }
    }
}

TEST(MakePool, RejectsOnlyWhatBreaksAConstraint) {
    const Campaign campaign = cell_campaign();
    Cell cell = demo_cell();
    cell.safety_distance = 0;
    const Constraints constraints(campaign, cell);
    CellRecheck recheck(campaign, cell, -0.03);  // sampling sees what is within 30 mm
    const RowMatrixXd candidates = halton_configurations(constraints.robot(), 120);
    Index infeasible = 0;
    for (Index i = 0; i < candidates.rows(); ++i) {
        const VectorXd q = candidates.row(i).transpose();
        if (constraints.check(q).is_feasible()) continue;
        ++infeasible;
        EXPECT_FALSE(recheck.violations(q).empty()) << "pose " << i;
    }
    EXPECT_GT(infeasible, 60);
}

TEST(MakePool, StopsWhenToldAndSaysHowMuchWasDrawn) {
    const Constraints constraints(cell_campaign(), demo_cell());
    const std::atomic<bool> interrupted = true;
    const Pool some = make_pool(constraints, 1000000, 1, {&interrupted});
    EXPECT_LT(some.candidate_count, 10000);
    // What was drawn is what the same count draws.
    const Pool whole = make_pool(constraints, some.candidate_count + 1000, 1);
    EXPECT_EQ(whole.configurations.topRows(some.configurations.rows()), some.configurations);
    const Pool same = make_pool(constraints, some.candidate_count, 1);
    EXPECT_EQ(same.configurations, some.configurations);
    EXPECT_TRUE((same.is_seen == some.is_seen).all());
    EXPECT_EQ(describe_rejections(same), describe_rejections(some));
}

TEST(MakePool, SaysWhatToDoAboutTooFew) {
    const Pool pool = make_pool(Constraints(cell_campaign(), demo_cell()), 200, 1);
    check_pool_size(pool, pool.configurations.rows());
    try {
        check_pool_size(pool, 190);
        FAIL() << "enough";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what())
                      .find("feasible poses of 200 candidates, 190 are needed; raise `pool_count` "
                            "or relax "),
                  std::string::npos)
            << error.what();
    }
}

TEST(MakePool, CountsWhatEachConstraintRemoved) {
    const Pool pool = make_pool(Constraints(cell_campaign(), demo_cell()), 2000, 1);
    Index first = 0;
    for (const Rejections& rejections : pool.rejections) {
        EXPECT_LE(rejections.first, rejections.in_all);
        first += rejections.first;
    }
    EXPECT_EQ(first + pool.configurations.rows(), 2000);
    EXPECT_NE(describe_rejections(pool).find("keep_out: "), std::string::npos);
}

TEST(MakePool, IsTheSameForAnyNumberOfThreads) {
    const Constraints constraints(cell_campaign(), demo_cell());
    omp_set_num_threads(1);
    const Pool one = make_pool(constraints, 3000, 7);
    omp_set_num_threads(2);
    const Pool two = make_pool(constraints, 3000, 7);
    EXPECT_EQ(one.configurations, two.configurations);
    EXPECT_TRUE((one.is_seen == two.is_seen).all());
    EXPECT_NE(make_pool(constraints, 3000, 8).configurations.row(0), one.configurations.row(0));
}

TEST(MakePool, HoldsFixedJoints) {
    Cell cell = demo_cell();
    cell.fixed_joints[5] = 10 * degree;
    const Pool pool = make_pool(Constraints(cell_campaign(), cell), 5000, 1);
    EXPECT_EQ(pool.configurations.col(5).minCoeff(), 10 * degree);
    EXPECT_EQ(pool.configurations.col(5).maxCoeff(), 10 * degree);
}

TEST(MakePool, SaysWhichConstraintLeavesNothing) {
    Cell cell = demo_cell();
    cell.target_boxes = {{Vector3d(9, 9, 9), Vector3d(10, 10, 10)}};
    const Constraints unreachable(cell_campaign(), cell);
    try {
        make_pool(unreachable, 500, 1);
        FAIL();
    } catch (const InputError& error) {
        const std::string text = error.what();
        EXPECT_NE(text.find("none of 500 candidates"), std::string::npos) << text;
        EXPECT_NE(text.find("target_boxes: 500"), std::string::npos) << text;
        EXPECT_NE(text.find("target_boxes alone leaves nothing, so relax target_boxes first"),
                  std::string::npos)
            << text;
    }
    EXPECT_THROW(make_pool(Constraints(cell_campaign(), demo_cell()), 0, 1), InputError);
}

}  // namespace
}  // namespace posewise
