#include <benchmark/benchmark.h>

#include "../../src/selection/lanes.hpp"
#include "exchange_references.hpp"
#include "support/designs.hpp"

/// Exchanges of single rows on one thread, beside the plain formula for all candidates with d kept
/// by rank-one updates. Arguments: candidates N, parameters p; 2 p of the candidates are chosen.
namespace posewise {
namespace {

using namespace detail;

struct Setting {
    Blocks pool;
    MatrixXd X = pool.matrix;
    LaneBlocks lanes;
    std::vector<Index> poses;
    MatrixXd F;  // M^-1 = F F^T

    explicit Setting(const benchmark::State& state)
        : pool(test::random_blocks(state.range(0), 1, state.range(1), 1)),
          poses(RandomStream(2).subset(pool.count(), 2 * state.range(1))) {
        std::vector<Index> all(static_cast<std::size_t>(pool.count()));
        std::iota(all.begin(), all.end(), Index{0});
        lanes = make_lane_blocks(pool, all);
        const Index L = pool.parameter_count();
        F = information(pool, poses).llt().matrixU().solve(MatrixXd::Identity(L, L));
    }
};

void count_exchanges(benchmark::State& state) {
    state.counters["exchanges"] = benchmark::Counter(static_cast<double>(state.range(0)),
                                                     benchmark::Counter::kIsIterationInvariantRate);
}

void BM_RankOneExchangesInLanes(benchmark::State& state) {
    const Setting setting(state);
    const LaneGrams G = make_grams(setting.lanes, setting.F);
    const MatrixXd P = setting.F.col(0);
    const std::vector<char> asked(static_cast<std::size_t>(setting.lanes.groups), 1);
    std::vector<Lane> gains(asked.size());
    for (auto _ : state) {
        lane_determinants(setting.lanes, G, P, asked, gains);
        benchmark::DoNotOptimize(gains.data());
    }
    count_exchanges(state);
}

void BM_RankOneExchangesReference(benchmark::State& state) {
    const Setting setting(state);
    reference::Design design(setting.X);
    design.start(setting.poses);
    VectorXd c;
    VectorXd gains;
    Index at = 0;
    for (auto _ : state) {
        at = (at + 1) % design.size();
        c.noalias() = setting.X * (design.W() * setting.X.row(design.pose(at)).transpose());
        reference::Exchange best;
        reference::keep_best(design, at, c, gains, best);
        benchmark::DoNotOptimize(best);
    }
    count_exchanges(state);
}

/// What an accepted exchange costs: d of all candidates for the next.
void BM_RankOneMoveInLanes(benchmark::State& state) {
    const Setting setting(state);
    for (auto _ : state) {
        benchmark::DoNotOptimize(gram_traces(setting.lanes, make_grams(setting.lanes, setting.F)));
    }
}

void BM_RankOneMoveReference(benchmark::State& state) {
    const Setting setting(state);
    reference::Design design(setting.X);
    design.start(setting.poses);
    Index other = 0;
    while (design.open()[other] == 0) ++other;
    for (auto _ : state) {
        const Index out = design.pose(0);
        design.exchange(0, other);
        other = out;
    }
}

void sizes(benchmark::internal::Benchmark* each) {
    each->ArgNames({"N", "p"})->ArgsProduct({{100, 800, 5000}, {10, 20, 33}});
}
BENCHMARK(BM_RankOneExchangesInLanes)->Apply(sizes);
BENCHMARK(BM_RankOneExchangesReference)->Apply(sizes);
BENCHMARK(BM_RankOneMoveInLanes)->Apply(sizes);
BENCHMARK(BM_RankOneMoveReference)->Apply(sizes);

}  // namespace
}  // namespace posewise
