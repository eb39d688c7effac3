// A 24-pose, 33-parameter plan: its value, its gradient by all 144 joint values (target: at most 8
// values), the same by central differences as the reference, and one whole refinement.
#include <benchmark/benchmark.h>

#include "../../src/planner/plan_space.hpp"
#include "../../src/planner/refinement.hpp"
#include "posewise/jacobian/identification.hpp"
#include "support/fanuc_planning.hpp"

namespace posewise {
namespace {

using namespace detail;

struct Scene {
    Campaign campaign = testing::fanuc_planning_campaign();
    DesignSpace space = make_design_space(campaign, campaign.nominal);
    Objective objective = make_objective(Criterion::D, 24);
    RowMatrixXd plan = testing::fanuc_pool(24);

    explicit Scene(bool has_tracker = false) {
        if (!has_tracker) return;
        campaign.sensor = std::make_shared<PointSensor>(
            std::vector<std::optional<Vector3d>>(3, std::nullopt), LaserTrackerNoise{1e-5, 1e-5});
        campaign.joint_repeatability = VectorXd::Constant(6, 1e-5);
        space = make_design_space(campaign, campaign.nominal);
    }

    MatrixXd information(const RowMatrixXd& poses) const {
        MatrixXd M = MatrixXd::Zero(33, 33);
        for (Index i = 0; i < poses.rows(); ++i) M += space.information(poses.row(i).transpose());
        return M;
    }
    double value(const RowMatrixXd& poses) const { return evaluate(objective, information(poses)); }
    RowMatrixXd slope(const RowMatrixXd& poses) const {
        const MatrixXd Z = gradient(objective, information(poses));
        RowMatrixXd result(poses.rows(), poses.cols());
        for (Index i = 0; i < poses.rows(); ++i) {
            result.row(i) = space.information_gradient(poses.row(i).transpose(), Z).transpose();
        }
        return result;
    }
};

void BM_plan_value(benchmark::State& state) {
    const Scene scene(state.range(0) != 0);
    for (auto _ : state) benchmark::DoNotOptimize(scene.value(scene.plan));
}
BENCHMARK(BM_plan_value)->ArgName("tracker")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void BM_plan_gradient(benchmark::State& state) {
    const Scene scene(state.range(0) != 0);
    for (auto _ : state) benchmark::DoNotOptimize(scene.slope(scene.plan));
}
BENCHMARK(BM_plan_gradient)->ArgName("tracker")->Arg(0)->Arg(1)->Unit(benchmark::kMicrosecond);

void BM_plan_gradient_by_central_differences(benchmark::State& state) {
    const Scene scene;
    RowMatrixXd plan = scene.plan;
    RowMatrixXd result = plan;
    const double h = 1e-5;
    for (auto _ : state) {
        for (Index k = 0; k < plan.size(); ++k) {
            const double q = plan.data()[k];
            plan.data()[k] = q + h;
            const double above = scene.value(plan);
            plan.data()[k] = q - h;
            result.data()[k] = (above - scene.value(plan)) / (2 * h);
            plan.data()[k] = q;
        }
        benchmark::DoNotOptimize(result.data());
    }
}
BENCHMARK(BM_plan_gradient_by_central_differences)->Unit(benchmark::kMicrosecond);

void BM_refinement(benchmark::State& state) {
    const Scene scene;
    double value = 0;
    for (auto _ : state) {
        value = refine_poses(scene.space, scene.objective, {}, scene.plan).value;
    }
    state.counters["log_det"] = value;
}
BENCHMARK(BM_refinement)->Unit(benchmark::kMillisecond);

/// The whole: 24 poses from a pool of 20 000.
void BM_plan_of_the_fanuc(benchmark::State& state) {
    const auto criterion = static_cast<Criterion>(state.range(0));
    const Scene scene;
    const RowMatrixXd pool = testing::fanuc_pool(20000);
    const Blocks blocks = make_blocks(scene.campaign, scene.campaign.nominal, pool);
    const Blocks workspace = make_prediction_blocks(scene.campaign, scene.campaign.nominal,
                                                    testing::fanuc_workspace(), 0);
    PlanOptions options;
    options.criterion = criterion;
    options.pose_count = 24;
    if (criterion == Criterion::G || criterion == Criterion::V) options.test_poses = &workspace;
    PlannedPoses plan;
    for (auto _ : state) plan = plan_poses(scene.space, pool, blocks, options);
    state.SetLabel(std::string(criterion_name(criterion)));
    state.counters["value"] = plan.value;
    state.counters["pool_value"] = plan.pool_choice.value;
    state.counters["efficiency"] = plan.efficiency;
    state.counters["rms_um"] = 1e6 * predict_accuracy(workspace, plan.information).rms;
}
BENCHMARK(BM_plan_of_the_fanuc)
    ->DenseRange(0, 9)
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace posewise
