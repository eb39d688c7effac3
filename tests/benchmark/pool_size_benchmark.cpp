#include <benchmark/benchmark.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdlib>

#include "../../src/selection/bound.hpp"
#include "../../src/selection/relaxation.hpp"
#include "support/fanuc_pool.hpp"

/// Cost of the whole selection against the number of candidates N, up from the smallest so that the
/// peak memory of the process is that of the present N (pool included). A million candidates only
/// with POSEWISE_BENCHMARK_MILLION set.
namespace posewise {
namespace {

using namespace detail;

double peak_memory_mib() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;  // from KiB
}

/// D for K = 40: the time is that of select_poses, `relaxation_s` that of its relaxation by itself.
void BM_PoolSize(benchmark::State& state) {
    const Blocks pool = testing::fanuc_pool(state.range(0), 1);
    SelectOptions options;
    options.pose_count = 40;
    const Objective objective = make_objective(pool, options);
    const auto begin = std::chrono::steady_clock::now();
    const Index iterations = relax(objective, pool, options).iterations;
    const std::chrono::duration<double> relaxation = std::chrono::steady_clock::now() - begin;
    Choice plan;
    for (auto _ : state) plan = select_poses(pool, options);
    state.counters["relaxation_s"] = relaxation.count();
    state.counters["iterations"] = static_cast<double>(iterations);
    state.counters["pool_MiB"] = static_cast<double>(pool.matrix.size() * 8) / (1024 * 1024);
    state.counters["peak_MiB"] = peak_memory_mib();
    state.counters["efficiency"] = plan.efficiency;
}

void pool_sizes(benchmark::internal::Benchmark* curve) {
    for (const Index count : {1'000, 3'000, 10'000, 30'000, 100'000, 300'000}) curve->Arg(count);
    if (std::getenv("POSEWISE_BENCHMARK_MILLION") != nullptr) curve->Arg(1'000'000);
}
BENCHMARK(BM_PoolSize)
    ->ArgName("N")
    ->Apply(pool_sizes)
    ->Iterations(1)
    ->UseRealTime()
    ->MeasureProcessCPUTime()
    ->Unit(benchmark::kSecond);

}  // namespace
}  // namespace posewise
