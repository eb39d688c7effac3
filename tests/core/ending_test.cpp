#include <gtest/gtest.h>

#include <set>

#include "posewise/core/progress.hpp"

namespace posewise {
namespace {

TEST(EndingName, IsDifferentForEveryEnding) {
    std::set<std::string_view> names;
    for (int k = 0; k <= static_cast<int>(Ending::Failed); ++k) {
        names.insert(ending_name(static_cast<Ending>(k)));
    }
    EXPECT_EQ(names.size(), static_cast<std::size_t>(Ending::Failed) + 1);
    EXPECT_EQ(ending_name(Ending{}), "not run");
}

}  // namespace
}  // namespace posewise
