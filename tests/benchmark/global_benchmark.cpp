#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdlib>
#include <ctime>

#include "../../src/calibrator/global_identification.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/campaigns.hpp"

/// Identification of a FANUC whose nominal parameters are wrong by up to 30 % in lengths and by up
/// to an angle, the argument, in all angles: how many of the simulated robots each way to find
/// starts finds, and the mean CPU time it takes. The first is Levenberg-Marquardt from the nominal
/// robot alone; covariance adaptation adds one start, the best of 20 000 robots it has
/// tried.
/// POSEWISE_BENCHMARK_ROBOTS: how many robots (default 1000).
namespace posewise {
namespace {

using namespace detail;

Index robot_count() {
    const char* const text = std::getenv("POSEWISE_BENCHMARK_ROBOTS");
    return text == nullptr ? 1000 : std::atol(text);
}

/// Of this process: other load on the machine does not count.
double cpu_seconds() {
    return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

struct Scene {
    Campaign campaign;
    Measurements measurements;
};

Scene make_scene(double angle, std::uint64_t item) {
    Scene scene{testing::tracked_campaign(testing::fanuc()), {}};
    const VectorXd bounds = error_bounds(scene.campaign.robot, {.angle = angle});
    Parameters truth = scene.campaign.nominal;
    RandomStream stream(1234, item);
    for (Index k = 0; k < truth.robot.size(); ++k) {
        truth.robot[k] = stream.uniform(-bounds[k], bounds[k]);
    }
    const Measurements drawn =
        simulate(scene.campaign, {.pose_count = 24, .truth_seed = 1, .seed = item}).measurements;
    scene.measurements =
        simulate_measurements(scene.campaign, truth, drawn.configurations, 3, item);
    return scene;
}

/// 24 means of three targets, noise and model error about 0.1 mm a coordinate.
bool is_found(const Estimate& estimate) { return estimate.fit_means.distance_rms < 4e-4; }

/// Starts searched in this way, at most so many.
void run(benchmark::State& state, StartSearch search, Index start_limit) {
    const double angle = static_cast<double>(state.range(0)) * testing::degree;
    const GlobalOptions options{.angle = angle, .search = search, .start_limit = start_limit};
    Index found = 0;
    double seconds = 0;
    for (auto _ : state) {
        for (Index i = 0; i < robot_count(); ++i) {
            const Scene scene = make_scene(angle, static_cast<std::uint64_t>(i));
            const double start = cpu_seconds();
            try {
                const GlobalEstimate result =
                    identify_globally(scene.campaign, scene.measurements, options);
                found += is_found(result.estimate) ? 1 : 0;
            } catch (const std::exception&) {  // not found
            }
            seconds += cpu_seconds() - start;
        }
    }
    state.counters["found_%"] =
        100.0 * static_cast<double>(found) / static_cast<double>(robot_count());
    state.counters["ms_a_robot"] = 1e3 * seconds / static_cast<double>(robot_count());
}

void BM_levenberg_marquardt(benchmark::State& state) { run(state, StartSearch::Random, 1); }
void BM_many_starts(benchmark::State& state) { run(state, StartSearch::Random, 200); }
void BM_cmaes(benchmark::State& state) { run(state, StartSearch::CmaEs, 2); }

void with_angles(benchmark::internal::Benchmark* curve) {
    curve->Arg(20)->Arg(45)->Arg(70)->ArgName("deg")->Iterations(1)->Unit(benchmark::kSecond);
}
BENCHMARK(BM_levenberg_marquardt)->Apply(with_angles);
BENCHMARK(BM_many_starts)->Apply(with_angles);
BENCHMARK(BM_cmaes)->Apply(with_angles);

}  // namespace
}  // namespace posewise
