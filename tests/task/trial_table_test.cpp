#include "../../src/task/study/trial_table.hpp"

#include <gtest/gtest.h>

#include <set>

#include "posewise/core/random.hpp"

namespace posewise {
namespace {

using detail::ScratchFile;
using detail::TrialTable;

Trial trial_of(Index number) {
    std::vector<double> values(static_cast<std::size_t>(number % 4));
    for (double& value : values) value = 0.5 + static_cast<double>(number);
    return {number, values};
}

std::vector<Trial> trials_in(const TrialTable& table) {
    std::vector<Trial> trials;
    table.for_each([&](const Trial& trial) { trials.push_back(trial); });
    return trials;
}

TEST(TrialTable, HasTrialsByNumberInWhateverOrderTheyCame) {
    for (const std::size_t in_memory : {0UL, 1000000UL}) {
        const auto file = std::make_shared<ScratchFile>(in_memory);
        TrialTable table(file, 3), other(file, 5);
        RandomStream stream(1);
        std::set<Index> numbers;
        for (int k = 0; k < 600; ++k) numbers.insert(stream.index(3000));
        numbers.insert(4000000000);  // of one shard of many
        std::vector<Index> shuffled(numbers.begin(), numbers.end());
        for (std::size_t i = shuffled.size(); i > 1; --i) {
            std::swap(shuffled[i - 1],
                      shuffled[static_cast<std::size_t>(stream.index(static_cast<Index>(i)))]);
        }
        for (const Index number : shuffled) {
            EXPECT_FALSE(table.has(number));
            table.put(trial_of(number));
            other.put({number, {1, 2, 3, 4, 5}});
            EXPECT_TRUE(table.has(number));
        }
        EXPECT_EQ(table.count(), std::ssize(numbers));
        EXPECT_FALSE(table.has(5000));
        auto expected = numbers.begin();
        for (const Trial& trial : trials_in(table)) {
            ASSERT_EQ(trial.number, *expected++);
            EXPECT_EQ(trial.values, trial_of(trial.number).values);
        }
        EXPECT_EQ(expected, numbers.end());

        table.close_ranks();
        EXPECT_EQ(table.count(), std::ssize(numbers));
        expected = numbers.begin();
        Index rank = 0;
        for (const Trial& trial : trials_in(table)) {
            ASSERT_EQ(trial.number, rank++);
            EXPECT_EQ(trial.values, trial_of(*expected++).values);
        }
        EXPECT_EQ(rank, table.count());
        EXPECT_FALSE(table.has(4000000000));
        std::vector<double> last(2);
        other.read(4000000000, 3, last);
        EXPECT_EQ(last, (std::vector<double>{4, 5}));
    }
}

}  // namespace
}  // namespace posewise
