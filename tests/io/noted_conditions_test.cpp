#include "io/measurements/noted_conditions.hpp"

#include <gtest/gtest.h>

namespace posewise::detail {
namespace {

std::map<std::string, double> times(const Notes& notes) {
    const std::vector<Condition> conditions = mean_conditions(notes, {});
    return conditions.empty() ? std::map<std::string, double>{} : conditions.front().values;
}

TEST(NotedConditions, AreMeansOfEachConfiguration) {
    const auto conditions = mean_conditions({{"a", "100"}, {"b", "3700"}, {"a", "300"}},
                                            {{"a", "21.5"}, {"b", ""}, {"a", "22.5"}});
    ASSERT_EQ(conditions.size(), 2U);
    EXPECT_EQ(conditions[0].name + conditions[0].unit, "timeh");
    EXPECT_DOUBLE_EQ(conditions[0].values.at("a"), 0);
    EXPECT_DOUBLE_EQ(conditions[0].values.at("b"), 3500.0 / 3600);
    EXPECT_EQ(conditions[1].name + conditions[1].unit, "temperatureC");
    EXPECT_EQ(conditions[1].values, (std::map<std::string, double>{{"a", 22}}));
}

TEST(NotedConditions, AreDatesAndTimesOfDay) {
    const auto over_midnight = times({{"a", "23:30"}, {"b", "23:59:30"}, {"c", "00:30:00"}});
    EXPECT_DOUBLE_EQ(over_midnight.at("b"), 29.5 / 60);
    EXPECT_DOUBLE_EQ(over_midnight.at("c"), 1);
    const auto dates = times({{"a", "2024-02-28 12:00:00"},
                              {"b", "2024-03-01T12:00:36Z"},
                              {"c", "2024-02-28T13:00:00.5+01:00"}});
    EXPECT_DOUBLE_EQ(dates.at("b"), 48.01);
    EXPECT_NEAR(dates.at("c"), 1 + 0.5 / 3600, 1e-9);
}

TEST(NotedConditions, WithACellThatCannotBeReadAreLeftOut) {
    for (const char* const text :
         {"noon", "12", "12:60", "25:00", "12:00:61", "2024-13-01 12:00", "2024-02-30 12:00",
          "2024-02-28", "12:0x", "-1:00", "2024-02-28 noon", "12:-5"}) {
        const bool is_number = std::string(text) == "12";
        EXPECT_EQ(times({{"a", "12"}, {"b", text}}).size(), is_number ? 2U : 0U) << text;
    }
    EXPECT_TRUE(mean_conditions({}, {}).empty());
    EXPECT_TRUE(mean_conditions({{"a", ""}}, {{"a", "warm"}}).empty());
}

}  // namespace
}  // namespace posewise::detail
