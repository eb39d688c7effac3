#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "../../src/core/parallel.hpp"
#include "../../src/core/progress_counter.hpp"

namespace posewise {
namespace {

using namespace detail;

TEST(ProgressCounter, TellsOfEveryPartOnceAndInOrder) {
    std::vector<Progress> told;
    const ProgressCallback callback = [&](const Progress& progress) { told.push_back(progress); };
    ProgressCounter counter(callback, 100);
    for_each_index(100, [&](Index i) {
        counter.count([&](Progress& progress) {
            progress.value = std::max(progress.value, static_cast<double>(i));
        });
    });
    ASSERT_EQ(told.size(), 100U);
    for (Index k = 0; k < 100; ++k) {
        EXPECT_EQ(told[static_cast<std::size_t>(k)].done, k + 1);
        EXPECT_EQ(told[static_cast<std::size_t>(k)].total, 100);
    }
    EXPECT_EQ(told.back().value, 99);
}

TEST(ProgressCounter, NeedsNoCallback) {
    const ProgressCallback none;
    ProgressCounter counter(none, 2);
    EXPECT_NO_THROW(counter.count());
}

TEST(ProgressCounter, CanBeUsedAfterItsCallbackHasThrown) {
    const ProgressCallback callback = [](const Progress& progress) {
        if (progress.done == 1) throw std::logic_error("first");
    };
    ProgressCounter counter(callback, 2);
    EXPECT_THROW(counter.count(), std::logic_error);
    EXPECT_NO_THROW(counter.count());
}

}  // namespace
}  // namespace posewise
