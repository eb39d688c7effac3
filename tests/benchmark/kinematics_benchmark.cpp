// One pose of the FANUC: forward kinematics, and the 9 x 33 identification Jacobian, analytic
// (target: at most 2 us on one core) and by central differences as the reference.
#include <benchmark/benchmark.h>

#include "../../src/model/sampling.hpp"
#include "posewise/jacobian/identification.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

using namespace detail;

/// A campaign and configurations enough to defeat the branch predictor.
struct Scene {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    std::vector<VectorXd> poses;
    RowMatrixXd J{9, 33};

    Scene() {
        const RowMatrixXd q = random_configurations(campaign.robot, 256, 1);
        for (Index i = 0; i < q.rows(); ++i) poses.emplace_back(q.row(i).transpose());
    }
};

void BM_forward_kinematics(benchmark::State& state) {
    const Scene scene;
    std::size_t i = 0;
    for (auto _ : state) {
        const VectorXd& q = scene.poses[i++ % scene.poses.size()];
        benchmark::DoNotOptimize(world_from_flange(scene.campaign, scene.campaign.nominal, q));
    }
}
BENCHMARK(BM_forward_kinematics);

void BM_jacobian_analytic(benchmark::State& state) {
    Scene scene;
    FlangeMotion motion;
    std::size_t i = 0;
    for (auto _ : state) {
        const VectorXd& q = scene.poses[i++ % scene.poses.size()];
        differentiate_pose(scene.campaign, scene.campaign.nominal, q, motion, scene.J);
        benchmark::DoNotOptimize(scene.J.data());
        benchmark::ClobberMemory();
    }
}
BENCHMARK(BM_jacobian_analytic);

void BM_jacobian_by_central_differences(benchmark::State& state) {
    Scene scene;
    const Campaign& campaign = scene.campaign;
    const double h = 1e-5;
    std::size_t i = 0;
    for (auto _ : state) {
        const VectorXd& q = scene.poses[i++ % scene.poses.size()];
        const auto predict = [&](const VectorXd& step) {
            const Parameters moved = advance(campaign, campaign.nominal, step);
            return campaign.sensor->predict(world_from_flange(campaign, moved, q), moved.sensor);
        };
        for (Index k = 0; k < 33; ++k) {
            const VectorXd step = h * VectorXd::Unit(33, k);
            scene.J.col(k) = (predict(step) - predict(-step)) / (2 * h);
        }
        benchmark::DoNotOptimize(scene.J.data());
        benchmark::ClobberMemory();
    }
}
BENCHMARK(BM_jacobian_by_central_differences);

}  // namespace
}  // namespace posewise
