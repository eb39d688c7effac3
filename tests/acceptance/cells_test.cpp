// Poses that are proposed in four cells, against a separate check of everything by points sampled
// on the bodies' surfaces.
#include <gtest/gtest.h>

#include <algorithm>

#include "../../src/planner/refinement.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/planner/planning.hpp"
#include "support/campaign_from.hpp"
#include "support/cell_recheck.hpp"
#include "support/sweep.hpp"

namespace posewise {
namespace {

using namespace testing;

const std::string arm = R"(
robot:
  errors: geometric
  joints:
    q1: {limits_deg: [-120, 120]}
    q2: {limits_deg: [-70, 100]}
    q3: {limits_deg: [-100, 110]}
    q4: {limits_deg: [-170, 170]}
    q5: {limits_deg: [-110, 110]}
    q6: {limits_deg: [-200, 200]}
  elements: [Tz 400 mm, Rz q1, Tx 120 mm, Ry q2, Tz 550 mm, Ry -q3, Tz 150 mm, Rx -q4, Tx 600 mm,
             Ry -q5, Tx 90 mm, Rx -q6, Ry -90 deg, Rx 180 deg]
model_error_mm: 0.05
base: {position_mm: [2800, -400, -1000], rpy_deg: [0, 0, 170]}
)";

const std::string links = R"(
  links:
    - {name: base, after: base, from_mm: [0, 0, 100], to_mm: [0, 0, 160], radius_mm: 110}
    - {name: shoulder, after: q1, from_mm: [0, 0, 0], to_mm: [120, 0, 0], radius_mm: 140}
    - {name: upper arm, after: q2, from_mm: [0, 0, 0], to_mm: [0, 0, 550], radius_mm: 100}
    - {name: forearm, after: q3, from_mm: [-120, 0, 150], to_mm: [430, 0, 150], radius_mm: 90}
    - {name: wrist, after: q5, from_mm: [0, 0, 0], to_mm: [90, 0, 0], radius_mm: 65}
    - {name: tool, after: flange, from_mm: [0, 0, 40], to_mm: [0, 0, 180], radius_mm: 30}
)";

/// One reflector beside a tool between two fences and over a floor.
const std::string between_fences = "name: fences" + arm + R"(
sensor: {kind: points, sigma_mm: 0.03, targets: {position_mm: [[70, 0, 220]]}}
cell:
  safety_distance_mm: 30
  floor_z_mm: 0
  keep_out:
    - {name: left, half_space: {point_mm: [0, 950, 0], normal: [0, -1, 0]}}
    - {name: right, half_space: {point_mm: [0, -950, 0], normal: [0, 1, 0]}})" +
                                   links;

/// Three reflectors among a table, a post and a ball, no links.
const std::string among_solids = "name: solids" + arm + R"(
sensor:
  kind: points
  sigma_mm: 0.03
  targets: {position_mm: [[90, 0, 60], [-50, 80, 60], [-50, -80, 60]]}
cell:
  safety_distance_mm: 15
  keep_out:
    - {name: table, box_mm: {min: [400, -500, -100], max: [1100, 500, 350]}}
    - {name: post, capsule_mm: {from: [0, 700, 0], to: [0, 700, 1500], radius: 120}}
    - {name: ball, sphere_mm: {center: [500, -600, 900], radius: 250}}
)";

/// Distances of large targets from anchors, folded over itself.
const std::string with_anchors = "name: anchors" + arm + R"(
sensor:
  kind: distances
  sigma_mm: 0.05
  anchors: {position_mm: [[0, 0, 0], [3000, 0, 0], [0, 3000, 0], [0, 0, 3000]], known: true}
  targets: {position_mm: [[0, 120, 100]]}
cell:
  safety_distance_mm: 10
  keep_out:
    - {name: roof, half_space: {point_mm: [0, 0, 1500], normal: [0, 0, -1]}})" +
                                 links;

io::CampaignFile cell_of(const std::string& text) {
    if (!text.empty()) return io::parse_campaign(text, "cell.yaml");
    return design_campaign("cell_demo/campaign.yaml");
}

/// Rows from `first` on that are apart from each other, refined for D beside a prior.
RowMatrixXd refined(const Campaign& campaign, const Constraints& constraints,
                    const RowMatrixXd& pool, Index first, Index count) {
    const auto space = detail::make_design_space(campaign, campaign.nominal, 1, &constraints);
    RowMatrixXd start(0, pool.cols());
    for (Index i = first; i < pool.rows() && start.rows() < count; ++i) {
        if (!detail::is_apart(start, pool.row(i), space.least_joint_distance)) continue;
        start.conservativeResize(start.rows() + 1, Eigen::NoChange);
        start.bottomRows(1) = pool.row(i);
    }
    HeldPoses prior;
    prior.rows = MatrixXd::Identity(space.parameter_count, space.parameter_count);
    detail::RefineOptions options;
    options.round_limit = 1;
    options.evaluation_limit = 100;
    return detail::refine_poses(space, detail::make_objective(Criterion::D, count), prior, start,
                                options)
        .configurations;
}

/// Feasible poses drawn, those nearest to something first.
RowMatrixXd nearest_first(const Constraints& constraints, Index drawn) {
    const RowMatrixXd pool = make_pool(constraints, drawn, 1).configurations;
    std::vector<std::pair<double, Index>> order;
    for (Index i = 0; i < pool.rows(); ++i) {
        order.emplace_back(constraints.nearest(pool.row(i).transpose()).distance, i);
    }
    std::sort(order.begin(), order.end());
    std::vector<Index> rows;
    for (const auto& [unused, row] : order) rows.push_back(row);
    return pool(rows, Eigen::all);
}

/// POSEWISE_SWEEP_COUNT / 10 poses a cell, or 100; a fifth of them refined continuously.
class ProposedPoses : public ::testing::TestWithParam<std::string> {};

TEST_P(ProposedPoses, KeepEveryBodyAtTheStatedDistanceFromEveryOther) {
    const io::CampaignFile file = cell_of(GetParam());
    const Constraints constraints(file, file.cell);
    const Index count = std::max<Index>(20, sweep_count() / 10);
    const RowMatrixXd pool = nearest_first(constraints, 60 * count);
    ASSERT_GE(pool.rows(), count);
    CellRecheck recheck(file, file.cell);
    double least = std::numeric_limits<double>::infinity();
    const auto check = [&](const RowMatrixXd& poses) {
        for (Index i = 0; i < poses.rows(); ++i) {
            const VectorXd q = poses.row(i).transpose();
            const auto violations = recheck.violations(q);
            EXPECT_TRUE(violations.empty()) << "pose " << i << ": " << violations.front();
            least = std::min(least, constraints.nearest(q).distance);
        }
    };
    constexpr Index at_once = 10;
    for (Index done = 0; done < count / 5; done += at_once) {
        check(refined(file, constraints, pool, done * 4, at_once));
    }
    check(pool.topRows(count - count / 5));
    EXPECT_LT(least, file.cell.safety_distance + 0.01) << "else there is nothing to test";
}

INSTANTIATE_TEST_SUITE_P(Cells, ProposedPoses,
                         ::testing::Values(std::string(), between_fences, among_solids,
                                           with_anchors));

}  // namespace
}  // namespace posewise
