#include "../../src/core/parallel.hpp"

#include <gtest/gtest.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <new>
#include <stdexcept>
#include <string>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"

namespace posewise {
namespace {

using namespace detail;

TEST(ForEachIndex, VisitsEveryIndexOnce) {
    for (const Index count : {0, 1, 2, 1000}) {
        std::vector<int> visits(static_cast<std::size_t>(count), 0);
        for_each_index(count, [&](Index i) { ++visits[static_cast<std::size_t>(i)]; });
        EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(count), 1));
    }
}

TEST(SetThreadCount, RefusesLessThanOne) {
    for (const Index count : {0, -1}) EXPECT_THROW(set_thread_count(count), InputError);
    const int before = omp_get_max_threads();
    set_thread_count(3);
    EXPECT_EQ(omp_get_max_threads(), 3);
    set_thread_count(before);
}

TEST(SetThreadCount, UsesAtMostFourForEachCore) {
    const Index before = asked_thread_count();
    set_thread_count(100000);
    EXPECT_EQ(asked_thread_count(), 100000);
    EXPECT_EQ(thread_count(), 4 * omp_get_num_procs());
    std::atomic<int> used = 0;
    for_each_index(1000, [&](Index) { used = std::max(used.load(), omp_get_num_threads()); });
    EXPECT_LE(used, 4 * omp_get_num_procs());
    set_thread_count(before);
}

TEST(ForEachIndex, ThrowsTheFailureOfTheLowestIndex) {
    for (int repeat = 0; repeat < 20; ++repeat) {
        std::string message;
        try {
            for_each_index(200, [](Index i) {
                if (i % 7 == 6) throw std::runtime_error("index " + std::to_string(i));
            });
        } catch (const std::runtime_error& error) {
            message = error.what();
        }
        EXPECT_EQ(message, "index 6");
    }
}

TEST(ForEachIndex, VisitsAllBeforeTheFailure) {
    std::vector<int> visits(500, 0);
    EXPECT_THROW(for_each_index(500,
                                [&](Index i) {
                                    ++visits[static_cast<std::size_t>(i)];
                                    if (i >= 300) throw std::bad_alloc();
                                }),
                 std::bad_alloc);
    for (std::size_t i = 0; i <= 300; ++i) EXPECT_EQ(visits[i], 1) << i;
}

TEST(ForEachIndex, PassesOnAnythingThrown) {
    for (const Index count : {1, 50}) {
        EXPECT_THROW(for_each_index(count, [](Index) { throw 42; }), int);
        EXPECT_THROW(for_each_index(count, [](Index) { throw std::bad_alloc(); }), std::bad_alloc);
    }
}

TEST(ForEachIndex, MayBeNested) {
    std::atomic<int> visits = 0;
    EXPECT_THROW(for_each_index(4,
                                [&](Index) {
                                    for_each_index(10, [&](Index) { ++visits; });
                                    for_each_index(10, [](Index j) {
                                        if (j == 3) throw std::logic_error("inner");
                                    });
                                }),
                 std::logic_error);
    EXPECT_GE(visits, 10);
}

TEST(ForEachRange, CutsAllIndicesIntoRuns) {
    for (const Index count : {0, 1, 9, 10, 11, 35}) {
        std::vector<int> visits(static_cast<std::size_t>(count), 0);
        for_each_range(count, 10, [&](Index first, Index last) {
            EXPECT_EQ(first % 10, 0);
            EXPECT_TRUE(last == first + 10 || last == count);
            for (Index i = first; i < last; ++i) ++visits[static_cast<std::size_t>(i)];
        });
        EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(count), 1));
    }
}

}  // namespace
}  // namespace posewise
