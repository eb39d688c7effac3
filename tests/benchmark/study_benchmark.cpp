// What a simulated study adds to its calibrations (24 poses, 33 parameters, one core): drawing the
// robot, its measurements, judging at 200 configurations (target: at most 15 %).
#include <benchmark/benchmark.h>

#include <chrono>

#include "freed_memory.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/study.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

Campaign fanuc_campaign() {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    campaign.model_error = 1e-4;
    return campaign;
}

/// At random poses, of robots drawn one after the other as a study draws them: errors and model
/// error larger or smaller, too.
void BM_calibration_alone(benchmark::State& state) {
    const Campaign campaign = fanuc_campaign();
    std::vector<Measurements> campaigns;
    for (std::uint64_t seed = 0; seed < 1000; ++seed) {
        const DrawnRobot robot = draw_robot(campaign, seed);
        Campaign truth = campaign;
        truth.model_error = robot.model_error;
        const RowMatrixXd poses =
            simulate(campaign, {.pose_count = 24, .seed = seed}).measurements.configurations;
        campaigns.push_back(simulate_measurements(truth, robot.truth, poses, 1, seed));
    }
    std::size_t next = 0;
    for (auto _ : state) {
        const Measurements& measured = campaigns[next++ % campaigns.size()];
        const Parameters start = register_base_and_targets(campaign, measured).parameters;
        benchmark::DoNotOptimize(identify(campaign, measured, start));
    }
}
BENCHMARK(BM_calibration_alone)->Unit(benchmark::kMillisecond);

double seconds_of(const Campaign& campaign, Index trials) {
    SimulatedStudyOptions options;
    options.pose_counts = {24};
    options.criteria.emplace();
    options.random_subsets = 2;
    options.trials = trials;
    const auto begin = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(simulate_study({{"", campaign}}, options));
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Two at random poses of each robot, without what is done once.
void BM_calibration_in_a_study(benchmark::State& state) {
    const Campaign campaign = fanuc_campaign();
    constexpr Index trials = 1000;
    for (auto _ : state) {
        const double once = seconds_of(campaign, 1);
        state.SetIterationTime((seconds_of(campaign, 1 + trials) - once) / (2 * trials));
    }
}
BENCHMARK(BM_calibration_in_a_study)->Unit(benchmark::kMillisecond)->UseManualTime()->Iterations(5);

}  // namespace
}  // namespace posewise
