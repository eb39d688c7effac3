// Poses that are proposed in four cells, against a separate check of everything by points sampled
// on the bodies' surfaces.
#include <gtest/gtest.h>

#include <algorithm>

#include "posewise/io/campaign_file.hpp"
#include "posewise/planner/planning.hpp"
#include "support/cell_recheck.hpp"
#include "support/places.hpp"
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
    return io::read_campaign(source_folder() + "/designs/cell_demo/campaign.yaml");
}

/// POSEWISE_SWEEP_COUNT / 10 poses a cell, or 100: planned ones, then of the pool.
class ProposedPoses : public ::testing::TestWithParam<std::string> {};

TEST_P(ProposedPoses, KeepEveryBodyAtTheStatedDistanceFromEveryOther) {
    const io::CampaignFile file = cell_of(GetParam());
    const Constraints constraints(file, file.cell);
    const Index count = std::max<Index>(20, sweep_count() / 10);
    const Pool pool = make_pool(constraints, 60 * count, 1);
    ASSERT_GE(pool.configurations.rows(), count);
    PlanOptions options;
    options.criterion = Criterion::D;
    options.pose_count = 16;
    options.starts = 1;
    options.bound_iterations = 0;
    const Pool some{pool.configurations.topRows(std::min<Index>(400, pool.configurations.rows())),
                    pool.is_seen.topRows(std::min<Index>(400, pool.configurations.rows()))};
    const PlannedPoses plan = plan_poses(file, constraints, some, 1, options);
    RowMatrixXd poses(count, file.robot.joint_count());
    poses << plan.configurations, pool.configurations.topRows(count - 16);
    CellRecheck recheck(file, file.cell);
    double least = std::numeric_limits<double>::infinity();
    for (Index i = 0; i < count; ++i) {
        const auto violations = recheck.violations(poses.row(i).transpose());
        EXPECT_TRUE(violations.empty()) << "pose " << i << ": " << violations.front();
        least = std::min(least, constraints.nearest(poses.row(i).transpose()).distance);
    }
    EXPECT_LT(least, file.cell.safety_distance + 0.02) << "else there is nothing to test";
}

INSTANTIATE_TEST_SUITE_P(Cells, ProposedPoses,
                         ::testing::Values(std::string(), between_fences, among_solids,
                                           with_anchors));

}  // namespace
}  // namespace posewise
