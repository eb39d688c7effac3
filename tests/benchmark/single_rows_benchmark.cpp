#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <ctime>
#include <string>

#include "exchange_references.hpp"
#include "posewise/selection/choice.hpp"
#include "support/designs.hpp"

/// select_poses on single rows beside the textbook exchanges, which restart on the same threads for
/// the time that it took. Counters: D-efficiency of each relative to the best value anyone found
/// (mean over the seeds), what select_poses' bound proves, and the CPU time of a reference relative
/// to that of select_poses, which is 1 where other load on the machine favoured none. Label: how
/// many seeds ended at that best value.
namespace posewise {
namespace {

/// The full quadratic model on a grid of `levels` equidistant levels of each factor.
Blocks quadratic_grid(Index factors, Index levels) {
    const auto count = static_cast<Index>(std::pow(levels, factors) + 0.5);
    RowMatrixXd rows(count, (factors + 1) * (factors + 2) / 2);
    for (Index i = 0; i < count; ++i) {
        VectorXd x(factors + 1);
        x[0] = 1;
        for (Index f = 0, digits = i; f < factors; ++f, digits /= levels) {
            x[f + 1] =
                2.0 * static_cast<double>(digits % levels) / static_cast<double>(levels - 1) - 1;
        }
        Index column = 0;
        for (Index a = 0; a <= factors; ++a) {
            for (Index b = a; b <= factors; ++b) rows(i, column++) = x[a] * x[b];
        }
    }
    return make_equal_blocks(rows, 1);
}

enum Method { Select, Fedorov, Kl, InTurn, MethodCount };
constexpr std::array<const char*, MethodCount> method_names{"select", "fedorov", "kl", "in_turn"};
using Values = std::array<double, MethodCount>;  // log det by each method

/// Values of the references in the time that select_poses took, each with the starts and sizes that
/// served it well here; Fedorov with random ones, AlgDesign's default.
void run_references(const Blocks& candidates, Index n, double seconds, std::uint64_t seed,
                    Values& values) {
    const MatrixXd X = candidates.matrix;
    const Index largest_L = std::max(2 * n, candidates.count() / 4);
    values[Fedorov] =
        reference::restart_for(seconds, X, seed, [&](auto& design, auto& random, auto is_over) {
            if (!reference::start_randomly(design, n, random)) return;
            reference::exchange_by_fedorov(design, is_over);
        });
    values[Kl] =
        reference::restart_for(seconds, X, seed, [&](auto& design, auto& random, auto is_over) {
            if (!reference::start_either_way(design, n, random)) return;
            const Index L = random.index(2) == 0 ? 2 * n : largest_L;
            reference::exchange_by_kl(design, n, L, is_over);
        });
    values[InTurn] =
        reference::restart_for(seconds, X, seed, [&](auto& design, auto& random, auto is_over) {
            if (!reference::start_either_way(design, n, random)) return;
            reference::exchange_in_turn(design, is_over);
        });
}

void report(benchmark::State& state, const std::vector<Values>& runs, Index parameters) {
    double best = -std::numeric_limits<double>::infinity();
    for (const Values& values : runs)
        best = std::max(best, *std::max_element(values.begin(), values.end()));
    std::string hits = "at best:";
    for (std::size_t m = 0; m < MethodCount; ++m) {
        double mean = 0;
        Index count = 0;
        for (const Values& values : runs) {
            mean += std::exp((values[m] - best) / static_cast<double>(parameters)) /
                    static_cast<double>(runs.size());
            count += values[m] > best - 1e-7;
        }
        state.counters[method_names[m]] = mean;
        hits += " " + std::string(method_names[m]) + " " + std::to_string(count);
    }
    state.counters["log_det"] = best;
    state.SetLabel(hits + " of " + std::to_string(runs.size()));
}

/// Each iteration is a seed; only select_poses is timed.
void compare(benchmark::State& state, const Blocks& candidates, Index n) {
    SelectOptions options;
    options.pose_count = n;
    options.seed = 0;
    std::vector<Values> runs;
    Choice plan;
    std::array<double, 2> cpu{};  // of select_poses and the references
    for (auto _ : state) {
        ++options.seed;
        const std::clock_t cpu_begin = std::clock();
        const auto begin = std::chrono::steady_clock::now();
        plan = select_poses(candidates, options);
        const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
        state.SetIterationTime(taken.count());
        Values& values = runs.emplace_back();
        values[Select] = plan.value;
        const std::clock_t cpu_middle = std::clock();
        run_references(candidates, n, taken.count(), options.seed, values);
        cpu[0] += static_cast<double>(cpu_middle - cpu_begin);
        cpu[1] += static_cast<double>(std::clock() - cpu_middle) / (MethodCount - 1);
    }
    report(state, runs, candidates.parameter_count());
    state.counters["proven"] = plan.efficiency;
    state.counters["cpu_ratio"] = cpu[1] / cpu[0];
}

void BM_QuadraticGrid(benchmark::State& state) {
    compare(state, quadratic_grid(state.range(0), state.range(1)), state.range(2));
}
BENCHMARK(BM_QuadraticGrid)
    ->ArgNames({"factors", "levels", "n"})
    ->ArgsProduct({{3}, {3, 5}, {10, 13, 20}})
    ->ArgsProduct({{4}, {3, 5}, {15, 18, 30}})
    ->ArgsProduct({{5}, {3, 5}, {21, 24, 42}})
    ->Iterations(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

void BM_RandomRows(benchmark::State& state) {
    compare(state, test::random_blocks(state.range(0), 1, state.range(1), 1), state.range(2));
}
BENCHMARK(BM_RandomRows)
    ->ArgNames({"N", "parameters", "n"})
    ->ArgsProduct({{200, 1000, 5000}, {10}, {10, 13, 20}})
    ->ArgsProduct({{200, 1000, 5000}, {20}, {20, 23, 40}})
    ->ArgsProduct({{200, 1000}, {33}, {33, 36, 66}})
    ->Iterations(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

BENCHMARK(BM_RandomRows)
    ->ArgNames({"N", "parameters", "n"})
    ->ArgsProduct({{5000}, {33}, {33, 36, 66}})
    ->Iterations(2)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// Graphs with the most spanning trees: K33, K44 and Petersen's.
void BM_SpanningTrees(benchmark::State& state) {
    compare(state, test::complete_graph(state.range(0)), state.range(1));
}
BENCHMARK(BM_SpanningTrees)
    ->ArgNames({"vertices", "edges"})
    ->Args({6, 9})
    ->Args({8, 16})
    ->Args({10, 15})
    ->Iterations(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

/// Sign matrices of largest determinant.
void BM_SignMatrices(benchmark::State& state) {
    compare(state, test::sign_rows(state.range(0)), state.range(0));
}
BENCHMARK(BM_SignMatrices)
    ->ArgName("n")
    ->Arg(7)
    ->Arg(11)
    ->Iterations(5)
    ->UseManualTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace posewise
