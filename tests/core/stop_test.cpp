#include <gtest/gtest.h>

#include <cmath>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"

namespace posewise {
namespace {

using Clock = std::chrono::steady_clock;

TEST(StopSignal, IsSetByTheFlagOrTheDeadline) {
    StopSignal stop;
    EXPECT_FALSE(stop.is_set());
    EXPECT_EQ(stop.ending_or(Ending::Converged), Ending::Converged);

    stop.deadline = Clock::now() - std::chrono::seconds(1);
    EXPECT_TRUE(stop.is_set());
    EXPECT_FALSE(stop.is_interrupted());
    EXPECT_EQ(stop.ending_or(Ending::Converged), Ending::TimeLimit);

    std::atomic<bool> flag = false;
    stop.interrupted = &flag;
    EXPECT_FALSE(stop.is_interrupted());
    flag = true;
    EXPECT_EQ(stop.ending_or(Ending::Converged), Ending::Interrupted);
}

TEST(StopSignal, CanBeHalved) {
    StopSignal stop;
    EXPECT_EQ(stop.with_half_the_time().deadline, Clock::time_point::max());
    std::atomic<bool> flag = false;
    stop = {&flag, Clock::now() + std::chrono::seconds(100)};
    const StopSignal half = stop.with_half_the_time();
    EXPECT_EQ(half.interrupted, &flag);
    EXPECT_NEAR(std::chrono::duration<double>(stop.deadline - half.deadline).count(), 50, 1);
}

TEST(DeadlineAfter, LiesAheadAndZeroIsNone) {
    const auto now = Clock::now();
    const auto deadline = deadline_after(100);
    EXPECT_GE(deadline, now + std::chrono::seconds(100));
    EXPECT_LE(deadline, Clock::now() + std::chrono::seconds(100));
    EXPECT_EQ(deadline_after(0), Clock::time_point::max());
    EXPECT_EQ(deadline_after(1e300), Clock::time_point::max());
    EXPECT_THROW(deadline_after(-1), InputError);
    EXPECT_THROW(deadline_after(std::nan("")), InputError);
}

}  // namespace
}  // namespace posewise
