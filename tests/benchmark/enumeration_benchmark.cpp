#include <benchmark/benchmark.h>

#include "posewise/selection/choice.hpp"
#include "support/fanuc_pool.hpp"

/// Selections from few poses of the FANUC robot (9 rows and 33 parameters each).
namespace posewise {
namespace {

/// N, K and a criterion: proven by branch and bound.
void BM_ProveOptimum(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(state.range(0), 1);
    SelectOptions options;
    options.pose_count = state.range(1);
    options.criterion = static_cast<Criterion>(state.range(2));
    state.SetLabel(std::string(criterion_name(options.criterion)));
    Choice choice;
    for (auto _ : state) choice = select_poses(pool, options);
    state.counters["proven"] = choice.ending == Ending::Optimal ? 1 : 0;
    state.counters["tried"] = static_cast<double>(choice.tried);
}
BENCHMARK(BM_ProveOptimum)
    ->ArgsProduct({{20}, {6}, benchmark::CreateDenseRange(0, 9, 1)})
    ->ArgsProduct({{24}, {12}, benchmark::CreateDenseRange(0, 9, 1)})
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

/// D with K = 20: time must grow smoothly with the number of candidates.
void BM_SelectFromFew(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(state.range(0), 1);
    SelectOptions options;
    options.pose_count = 20;
    options.proof = 0;
    Choice choice;
    for (auto _ : state) choice = select_poses(pool, options);
    state.counters["starts"] = static_cast<double>(choice.starts);
}
BENCHMARK(BM_SelectFromFew)
    ->Arg(30)
    ->Arg(48)
    ->Arg(64)
    ->Arg(65)
    ->Arg(96)
    ->Arg(128)
    ->Iterations(1)
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posewise
