// One calibration of a simulated FANUC campaign (33 parameters, 24 configurations of 10 samples),
// from registration with no initial guess to the covariance (target: at most 5 ms); and with the
// default error model, its model error and the held-out error (targets: 24 configurations within
// 20 ms, 1000 within 2 s).
#include <benchmark/benchmark.h>

#include "../../src/model/complete_model.hpp"
#include "freed_memory.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/calibration.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

struct Scene {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    Measurements measurements = simulate(campaign, {.pose_count = 24, .repeats = 10}).measurements;
};

void BM_registration(benchmark::State& state) {
    const Scene scene;
    for (auto _ : state) {
        benchmark::DoNotOptimize(register_base_and_targets(scene.campaign, scene.measurements));
    }
}
BENCHMARK(BM_registration)->Unit(benchmark::kMillisecond);

void BM_calibration_by_levenberg_marquardt(benchmark::State& state) {
    const Scene scene;
    Estimate estimate;
    for (auto _ : state) {
        const Parameters start =
            register_base_and_targets(scene.campaign, scene.measurements).parameters;
        estimate = identify(scene.campaign, scene.measurements, start);
    }
    if (estimate.ending != Ending::Converged) state.SkipWithError("did not converge");
    state.counters["iterations"] = static_cast<double>(estimate.iterations);
}
BENCHMARK(BM_calibration_by_levenberg_marquardt)->Unit(benchmark::kMillisecond);

void BM_calibration_by_two_steps(benchmark::State& state) {
    const Scene scene;
    for (auto _ : state) {
        const Parameters start =
            register_base_and_targets(scene.campaign, scene.measurements).parameters;
        benchmark::DoNotOptimize(identify_two_step(scene.campaign, scene.measurements, start));
    }
}
BENCHMARK(BM_calibration_by_two_steps)->Unit(benchmark::kMillisecond);

void BM_leave_one_configuration_out(benchmark::State& state) {
    const Scene scene;
    const Parameters start =
        register_base_and_targets(scene.campaign, scene.measurements).parameters;
    for (auto _ : state) {
        benchmark::DoNotOptimize(cross_validate(scene.campaign, scene.measurements, start, 24));
    }
}
BENCHMARK(BM_leave_one_configuration_out)->Unit(benchmark::kMillisecond)->UseRealTime();

/// All that the command does but reading and printing.
void BM_calibration_with_the_default_model(benchmark::State& state) {
    const Chain robot = without_parameters(testing::fanuc());
    Campaign campaign =
        with_robot(testing::tracked_campaign(testing::fanuc()), detail::full_model(robot));
    campaign.spread = population_spread(robot);
    campaign.model_error = 1e-4;
    const Measurements measurements =
        simulate(campaign, {.pose_count = state.range(0), .repeats = 1}).measurements;
    for (auto _ : state) benchmark::DoNotOptimize(calibrate(campaign, measurements));
}
BENCHMARK(BM_calibration_with_the_default_model)
    ->Arg(24)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
}  // namespace posewise
