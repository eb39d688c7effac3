#include <gtest/gtest.h>

#include "posewise/measurement/sensor.hpp"

namespace posewise {
namespace {

TEST(Seen, RowsAreThoseOfTheTargetsSeen) {
    const SeenTargets seen = seen_targets({2, 0}, 4);
    EXPECT_EQ(targets_seen(seen), (std::vector<Index>{0, 2}));
    EXPECT_EQ(seen_rows(seen, 3), (std::vector<Index>{0, 1, 2, 6, 7, 8}));
    EXPECT_EQ(target_numbers(seen), "1 3");
    EXPECT_EQ(target_numbers(seen_targets({}, 4)), "");
}

TEST(Seen, IsObservedSoOften) {
    const Seen seen{{true, false}, {false, true}};
    EXPECT_EQ(times_seen(seen, 2.5), (RowMatrixXd{{2.5, 0}, {0, 2.5}}));
    EXPECT_EQ(times_seen(all_seen(2, 3), 1), RowMatrixXd::Ones(2, 3));
}

}  // namespace
}  // namespace posewise
