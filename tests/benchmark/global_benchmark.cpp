#include <benchmark/benchmark.h>
#include <nlopt.h>

#include <cmath>
#include <cstdlib>
#include <ctime>
#include <memory>

#include "posewise/calibrator/global_identification.hpp"
#include "posewise/calibrator/registration.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/simulation.hpp"
#include "support/campaigns.hpp"

/// Identification of a FANUC whose nominal parameters are wrong by up to 30 % in lengths and by up
/// to an angle, the argument, in all angles: how many of the simulated robots each method finds,
/// and the mean CPU time it takes. All but the first may take the same time a robot; the population
/// searches of NLopt run over the robot's parameters only, base and targets eliminated by
/// registration, and end in Levenberg-Marquardt. POSEWISE_BENCHMARK_ROBOTS: how many (default
/// 1000); POSEWISE_BENCHMARK_SECONDS: that time (default 0.1).
namespace posewise {
namespace {

double from_environment(const char* name, double otherwise) {
    const char* const text = std::getenv(name);
    return text == nullptr ? otherwise : std::strtod(text, nullptr);
}

double seconds_a_robot() { return from_environment("POSEWISE_BENCHMARK_SECONDS", 0.1); }

/// Of this process: other load on the machine does not count.
double cpu_seconds() {
    return static_cast<double>(std::clock()) / static_cast<double>(CLOCKS_PER_SEC);
}

struct Scene {
    Campaign campaign;
    Measurements measurements;
    VectorXd bounds;
};

Scene make_scene(double angle, std::uint64_t item) {
    Scene scene{testing::tracked_campaign(testing::fanuc()), {}, {}};
    scene.bounds = error_bounds(scene.campaign.robot, {.angle = angle});
    Parameters truth = scene.campaign.nominal;
    RandomStream stream(1234, item);
    for (Index k = 0; k < truth.robot.size(); ++k) {
        truth.robot[k] = stream.uniform(-scene.bounds[k], scene.bounds[k]);
    }
    const Measurements drawn =
        simulate(scene.campaign, {.pose_count = 24, .truth_seed = 1, .seed = item}).measurements;
    scene.measurements =
        simulate_measurements(scene.campaign, truth, drawn.configurations, 3, item);
    return scene;
}

/// 24 means of three targets, noise and model error about 0.1 mm a coordinate.
bool is_found(const Estimate& estimate) { return estimate.fit_means.distance_rms < 4e-4; }

Estimate polish(const Scene& scene, const VectorXd& errors) {
    return identify(scene.campaign, scene.measurements,
                    register_roughly_with_errors(scene.campaign, scene.measurements, errors));
}

bool by_one_start(const Scene& scene) {
    return is_found(polish(scene, VectorXd::Zero(scene.bounds.size())));
}

bool by_many_starts(const Scene& scene) {
    const double deadline = cpu_seconds() + seconds_a_robot();
    RandomStream stream(5);
    VectorXd errors = VectorXd::Zero(scene.bounds.size());
    while (true) {
        if (is_found(polish(scene, errors))) return true;
        if (cpu_seconds() > deadline) return false;
        for (Index k = 0; k < errors.size(); ++k) {
            errors[k] = stream.uniform(-scene.bounds[k], scene.bounds[k]);
        }
    }
}

struct Search {
    const Scene& scene;
    nlopt_opt handle;
    double deadline;
};

double misfit(unsigned size, const double* x, double*, void* data) {
    const auto& [scene, handle, deadline] = *static_cast<const Search*>(data);
    if (cpu_seconds() > deadline) nlopt_force_stop(handle);
    const VectorXd errors = Eigen::Map<const VectorXd>(x, size).cwiseProduct(scene.bounds);
    const Parameters found =
        register_roughly_with_errors(scene.campaign, scene.measurements, errors);
    return make_metrics(mean_residuals(scene.campaign, found, scene.measurements)).distance_rms;
}

bool by_population(const Scene& scene, nlopt_algorithm algorithm) {
    const auto size = static_cast<unsigned>(scene.bounds.size());
    const std::unique_ptr<nlopt_opt_s, void (*)(nlopt_opt)> handle(nlopt_create(algorithm, size),
                                                                   nlopt_destroy);
    nlopt_srand(7);
    Search search{scene, handle.get(), cpu_seconds() + seconds_a_robot()};
    nlopt_set_min_objective(handle.get(), misfit, &search);
    nlopt_set_lower_bounds1(handle.get(), -1);
    nlopt_set_upper_bounds1(handle.get(), 1);
    VectorXd x = VectorXd::Zero(size);
    double value = 0;
    nlopt_optimize(handle.get(), x.data(), &value);
    return is_found(polish(scene, x.cwiseProduct(scene.bounds)));
}

template <typename Method>
void run(benchmark::State& state, const Method& method) {
    const double angle = static_cast<double>(state.range(0)) * testing::degree;
    const auto count = static_cast<Index>(from_environment("POSEWISE_BENCHMARK_ROBOTS", 1000));
    Index found = 0;
    double seconds = 0;
    for (auto _ : state) {
        for (Index i = 0; i < count; ++i) {
            const Scene scene = make_scene(angle, static_cast<std::uint64_t>(i));
            const double start = cpu_seconds();
            try {
                found += method(scene) ? 1 : 0;
            } catch (const std::exception&) {  // not found
            }
            seconds += cpu_seconds() - start;
        }
    }
    state.counters["found_%"] = 100.0 * static_cast<double>(found) / static_cast<double>(count);
    state.counters["ms_a_robot"] = 1e3 * seconds / static_cast<double>(count);
}

void BM_levenberg_marquardt(benchmark::State& state) { run(state, by_one_start); }
void BM_many_starts(benchmark::State& state) { run(state, by_many_starts); }
void BM_crs2(benchmark::State& state) {
    run(state, [](const Scene& scene) { return by_population(scene, NLOPT_GN_CRS2_LM); });
}
void BM_esch(benchmark::State& state) {
    run(state, [](const Scene& scene) { return by_population(scene, NLOPT_GN_ESCH); });
}
void BM_isres(benchmark::State& state) {
    run(state, [](const Scene& scene) { return by_population(scene, NLOPT_GN_ISRES); });
}

void with_angles(benchmark::internal::Benchmark* curve) {
    curve->Arg(20)->Arg(45)->Arg(70)->ArgName("deg")->Iterations(1)->Unit(benchmark::kSecond);
}
BENCHMARK(BM_levenberg_marquardt)->Apply(with_angles);
BENCHMARK(BM_many_starts)->Apply(with_angles);
BENCHMARK(BM_crs2)->Apply(with_angles);
BENCHMARK(BM_esch)->Apply(with_angles);
BENCHMARK(BM_isres)->Apply(with_angles);

}  // namespace
}  // namespace posewise
