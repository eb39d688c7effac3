#include "io/measurements/noted_conditions.hpp"

#include <gtest/gtest.h>

namespace posewise::detail {
namespace {

std::map<std::string, double> times(const Notes& notes) {
    const std::vector<Condition> conditions = mean_conditions(notes, {}).conditions;
    return conditions.empty() ? std::map<std::string, double>{} : conditions.front().values;
}

TEST(NotedConditions, AreMeansOfEachConfiguration) {
    const auto conditions = mean_conditions({{"a", "100"}, {"b", "3700"}, {"a", "300"}},
                                            {{"a", "21.5"}, {"b", ""}, {"a", "22.5"}})
                                .conditions;
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
    EXPECT_TRUE(mean_conditions({}, {}).conditions.empty());
    EXPECT_TRUE(mean_conditions({{"a", ""}}, {{"a", "warm"}}).conditions.empty());
}

TEST(NotedConditions, SayWhichClockTheyAreOf) {
    const auto clock_of = [](const std::string& a, const std::string& b) {
        const auto times = mean_conditions({{"a", a}, {"b", b}}, {}).times;
        return times ? times->clock : "none";
    };
    EXPECT_EQ(clock_of("5", "7.5"), "seconds");
    EXPECT_EQ(clock_of("12:30", "12:31:05"), "time of day");
    EXPECT_EQ(clock_of("2026-01-31 12:30", "2026-01-31T12:31:05"), "date");
    EXPECT_EQ(clock_of("2026-01-31T12:30+01:00", "2026-01-31T12:31+01:00"), "date+01:00");
    EXPECT_EQ(clock_of("5", "12:31"), "");
    EXPECT_EQ(clock_of("2026-01-31T12:30", "2026-01-31T12:31Z"), "");
    EXPECT_EQ(clock_of("", ""), "none");
    const auto times = mean_conditions({{"a", "30"}, {"b", "20"}, {"b", "40"}, {"c", "50"}}, {});
    EXPECT_EQ(times.times->first, 30);
    EXPECT_EQ(times.times->last, 50);
}

/// Measurements of one pose each of three plans, with these times and temperatures.
io::MeasurementsFile join(const std::vector<std::string>& times,
                          const std::vector<std::string>& temperatures) {
    std::vector<io::MeasurementsFile> parts;
    for (std::size_t k = 0; k < times.size(); ++k) {
        io::MeasurementsFile& part = parts.emplace_back();
        part.ids = {"p1", "p2"};
        part.configurations = RowMatrixXd::Zero(2, 1);
        part.observations = RowMatrixXd::Constant(2, 3, static_cast<double>(k));
        part.is_seen = Seen::Constant(2, 1, true);
        part.first_sample = {0, 1, 2};
        keep_conditions(mean_conditions({{"p1", times[k]}, {"p2", times[k]}},
                                        {{"p1", temperatures[k]}, {"p2", temperatures[k]}}),
                        false, false, part);
    }
    return io::join_measurements(std::move(parts), {"a.txt", "b.txt", "c.txt"},
                                 {"plans/a.json", "new/b.json", "old/b.json"});
}

TEST(NotedConditions, OfSeveralPlansAreKeptWhereAllHaveThem) {
    const auto both =
        join({"2026-01-31 12:00", "2026-01-31 14:00", "2026-01-31 11:00"}, {"20", "21", "22"});
    EXPECT_EQ(both.joined, "");
    ASSERT_EQ(both.conditions.size(), 2U);
    const std::map<std::string, double> hours{{"a/p1", 1},          {"a/p2", 1},
                                              {"new/b.json/p1", 3}, {"new/b.json/p2", 3},
                                              {"old/b.json/p1", 0}, {"old/b.json/p2", 0}};
    EXPECT_EQ(both.conditions[0].values, hours);
    EXPECT_EQ(both.conditions[1].values.at("old/b.json/p2"), 22);
    EXPECT_EQ(both.ids[2], "new/b.json/p1");

    const auto none = join({"", "", ""}, {"", "", ""});
    EXPECT_TRUE(none.conditions.empty() && none.joined.empty());
    const auto some = join({"", "", ""}, {"20", "", "22"});
    EXPECT_TRUE(some.conditions.empty());
    EXPECT_EQ(some.joined,
              "temperature is not in all of them, and not looked for in the residuals");
}

TEST(NotedConditions, OfSeveralPlansAreOfOneClockOrLeftOut) {
    const std::vector<std::string> no(3);
    const auto has_times = [&](const std::vector<std::string>& times) {
        const auto joined = join(times, no);
        EXPECT_EQ(joined.conditions.empty(), joined.joined.starts_with("time is not shown"));
        return !joined.conditions.empty();
    };
    EXPECT_TRUE(has_times({"0", "10", "20"}));
    EXPECT_TRUE(has_times({"12:00", "12:10", "12:20"}));
    EXPECT_FALSE(has_times({"0", "0", "20"})) << "counted from zero each";
    EXPECT_FALSE(has_times({"12:00", "09:00", "12:20"})) << "on another day";
    EXPECT_FALSE(has_times({"0", "12:00", "12:20"}));
    EXPECT_FALSE(has_times({"2026-01-31 12:00", "2026-01-31 12:00Z", "2026-01-31 12:00"}));
}

}  // namespace
}  // namespace posewise::detail
