// The linker sends what asks for memory through these (tests/CMakeLists.txt).
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "../../src/calibrator/least_squares.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"

namespace {

std::atomic<long> asked{0};

}  // namespace

extern "C" {
void* __real__Znwm(std::size_t size);  // operator new
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* memory, std::size_t size);
void* __wrap__Znwm(std::size_t size) {
    ++asked;
    return __real__Znwm(size);
}
void* __wrap_malloc(std::size_t size) {
    ++asked;
    return __real_malloc(size);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
    ++asked;
    return __real_calloc(count, size);
}
void* __wrap_realloc(void* memory, std::size_t size) {
    ++asked;
    return __real_realloc(memory, size);
}
}

namespace posewise {
namespace {

using namespace detail;
using namespace testing;

/// How often `work` asks for memory.
template <typename Work>
long asked_by(const Work& work) {
    const long before = asked;
    work();
    return asked - before;
}

/// What a calibration does for every configuration, by how many of them there are.
struct Asked {
    long simulating, linearising, comparing, left_over;
};
Asked asked_with(const Campaign& campaign, Index poses) {
    const RowMatrixXd configurations =
        simulate(campaign, {.pose_count = poses, .seed = 3}).measurements.configurations;
    Measurements measured;
    Asked by{};
    by.simulating = asked_by([&] {
        measured = simulate_measurements(campaign, campaign.nominal, configurations, 1, 4);
    });
    measured.is_seen.setConstant(true);  // views that show other targets take memory of their own
    const IdentificationProblem problem = make_problem(campaign, measured);
    by.linearising = asked_by([&] { linearise(problem, campaign.nominal); });
    by.comparing = asked_by([&] { total_loss(problem, campaign.nominal); });
    by.left_over = asked_by([&] { residuals(campaign, campaign.nominal, measured); });
    return by;
}

TEST(EverySensor, TakesNoMemoryForEachConfiguration) {
    auto campaigns = campaigns_of_every_sensor(fanuc());
    ASSERT_GT(asked, 0) << "nothing is counted";
    for (auto& [name, campaign] : campaigns) {
        if (campaign.sensor->has_contacts()) continue;
        if (campaign.sensor->is_combined()) continue;  // its parts' derivatives are taken apart
        campaign.base_is_known.fill(false);  // what is known of it is left out with a copy
        SCOPED_TRACE(name);
        if (const auto* camera = dynamic_cast<const CameraSensor*>(campaign.sensor.get())) {
            CameraSetup setup = camera->setup();  // Eigen has memory of its own for larger products
            setup.corners = chessboard(2, 2, 0.1);
            campaign.sensor = std::make_shared<CameraSensor>(setup);
        }
        const Asked few = asked_with(campaign, 12);
        const Asked many = asked_with(campaign, 48);
        EXPECT_EQ(few.simulating, many.simulating);
        EXPECT_EQ(few.linearising, many.linearising);
        EXPECT_EQ(few.comparing, many.comparing);
        EXPECT_EQ(few.left_over, many.left_over);
    }
}

TEST(ARobustCalibration, TakesNoMemoryForEachConfigurationEither) {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.joint_repeatability = VectorXd::Constant(6, 1e-5);
    const auto of = [&](Index poses) {
        const Measurements measured = simulate(campaign, {.pose_count = poses}).measurements;
        IdentificationProblem problem = make_problem(campaign, measured);
        problem.loss = {LossKind::Cauchy, 2};
        return asked_by([&] { linearise(problem, campaign.nominal); });
    };
    EXPECT_EQ(of(12), of(48));
}

}  // namespace
}  // namespace posewise
