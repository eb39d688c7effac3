#include <benchmark/benchmark.h>

#include <Eigen/Cholesky>

#include "../../src/core/sensitivities.hpp"
#include "../../src/selection/bound.hpp"
#include "../../src/selection/gains.hpp"
#include "../../src/selection/relaxation.hpp"
#include "support/designs.hpp"
#include "support/fanuc_pool.hpp"

/// Speed of selection on pools of the FANUC robot (blocks of 9 x 33), each kernel beside a plain
/// reference that does the same work with Eigen alone.
namespace posewise {
namespace {

using namespace detail;
using test::indices_below;

MatrixXd information_of_plan(const Blocks& pool, Index pose_count) {
    return information(pool, indices_below(pose_count));
}

/// Exchanges of one pose out of 40 by each of 800 candidates, on one thread.
struct ExchangeSetting {
    Blocks pool = testing::fanuc_pool(800, 1);
    MatrixXd M = information_of_plan(pool, 40);
    RowMatrixXd B = pool[0];                         // the pose to be replaced
    MatrixXd W = (M - B.transpose() * B).inverse();  // what is left without it
};

void count_exchanges(benchmark::State& state) {
    state.counters["exchanges"] =
        benchmark::Counter(800, benchmark::Counter::kIsIterationInvariantRate);
}

void BM_ExchangesInLanes(benchmark::State& state) {
    const ExchangeSetting setting;
    const LaneBlocks lanes = make_lane_blocks(setting.pool, indices_below(800));
    const MatrixXd F = setting.M.llt().matrixU().solve(MatrixXd::Identity(33, 33));
    const LaneGrams G = make_grams(lanes, F);
    const std::vector<char> asked(static_cast<std::size_t>(lanes.groups), 1);
    std::vector<Lane> gains(asked.size());
    for (auto _ : state) {
        const MatrixXd WB = setting.W * setting.B.transpose();
        const MatrixXd growth = MatrixXd::Identity(9, 9) + setting.B * WB;
        const MatrixXd P = growth.llt().matrixL().solve(WB.transpose()).transpose();
        lane_determinants(lanes, G, P, asked, gains);
        benchmark::DoNotOptimize(gains.data());
    }
    count_exchanges(state);
}
BENCHMARK(BM_ExchangesInLanes)->Unit(benchmark::kMicrosecond);

void BM_ExchangesReference(benchmark::State& state) {
    const ExchangeSetting setting;
    for (auto _ : state) {
        for (Index i = 0; i < setting.pool.count(); ++i) {
            const auto candidate = setting.pool[i];
            const MatrixXd S =
                MatrixXd::Identity(9, 9) + candidate * setting.W * candidate.transpose();
            benchmark::DoNotOptimize(S.llt().matrixLLT().diagonal().prod());
        }
    }
    count_exchanges(state);
}
BENCHMARK(BM_ExchangesReference)->Unit(benchmark::kMicrosecond);

void BM_Sensitivities(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(10000, 1);
    const MatrixXd Z = information_of_plan(pool, 40).inverse();
    for (auto _ : state) benchmark::DoNotOptimize(sensitivities(pool, Z));
}
BENCHMARK(BM_Sensitivities)->UseRealTime()->Unit(benchmark::kMillisecond);

void BM_SensitivitiesReference(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(10000, 1);
    const MatrixXd Z = information_of_plan(pool, 40).inverse();
    for (auto _ : state) {
        VectorXd d(pool.count());
        for (Index i = 0; i < pool.count(); ++i) {
            d[i] = (pool[i] * Z).cwiseProduct(pool[i]).sum();
        }
        benchmark::DoNotOptimize(d);
    }
}
BENCHMARK(BM_SensitivitiesReference)->UseRealTime()->Unit(benchmark::kMillisecond);

/// Relaxation of D for K = 40 to a gap of 1e-4.
void BM_Relaxation(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(state.range(0), 1);
    SelectOptions options;
    options.pose_count = 40;
    options.gap = 1e-4;
    const Objective objective = make_objective(pool, options);
    Index iterations = 0;
    for (auto _ : state) {
        iterations = relax(objective, pool, options).iterations;
    }
    state.counters["iterations"] = static_cast<double>(iterations);
}
BENCHMARK(BM_Relaxation)
    ->Arg(500)
    ->Arg(2000)
    ->Arg(10000)
    ->Arg(100000)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

/// The whole selection by D with its proven efficiency: N candidates, K poses.
void BM_SelectPoses(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(state.range(0), 1);
    SelectOptions options;
    options.pose_count = state.range(1);
    options.starts = state.range(0) <= 10000 ? 20 : 4;
    options.stop.deadline = deadline_after(state.range(0) <= 10000 ? 10 : 0);  // one iteration
    Choice plan;
    for (auto _ : state) plan = select_poses(pool, options);
    state.counters["efficiency"] = plan.efficiency;
    state.counters["at_best"] = static_cast<double>(plan.starts_at_best);
}
BENCHMARK(BM_SelectPoses)
    ->ArgsProduct({{500, 2000, 10000}, {10, 20, 40, 60}})
    ->Args({100000, 40})
    ->Args({1000000, 40})
    ->Iterations(1)
    ->UseRealTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace posewise
