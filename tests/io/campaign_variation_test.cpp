#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "posewise/core/errors.hpp"
#include "posewise/io/campaign_file.hpp"

namespace posewise::io {
namespace {

TEST(CampaignVariation, ReadsAKeyAndItsValues) {
    const VariedKey plain = parse_varied_key("sensor.sigma_mm=0.01,0.05");
    EXPECT_EQ(plain.key, "sensor.sigma_mm");
    EXPECT_EQ(plain.values, (std::vector<std::string>{"0.01", "0.05"}));
    const VariedKey lists = parse_varied_key("base.position_mm=[1, 2, 3],[4, 5, 6]");
    EXPECT_EQ(lists.values, (std::vector<std::string>{"[1, 2, 3]", "[4, 5, 6]"}));
    for (const char* wrong : {"", "=", "a", "a=", "=1", "a=1,", "a..b=1", ".a=1", "a=,1"}) {
        EXPECT_THROW(parse_varied_key(wrong), InputError) << wrong;
    }
}

TEST(CampaignVariation, HasEveryCombination) {
    const std::string text = "name: a\nsensor:\n  sigma_mm: 0.1\n  targets: [1, {x: 2}]\n";
    const auto all = vary_campaign(
        text, "c.yaml",
        {parse_varied_key("sensor.sigma_mm=1,2"), parse_varied_key("sensor.targets.2.x=3,[4, 5]")});
    ASSERT_EQ(all.size(), 4u);
    EXPECT_EQ(all[1].name, "sensor.sigma_mm=1 sensor.targets.2.x=[4, 5]");
    EXPECT_EQ(all[1].content,
              "name: a\nsensor:\n  sigma_mm: 1\n  targets:\n    - 1\n    - x: [4, 5]");
    EXPECT_EQ(all[2].content, "name: a\nsensor:\n  sigma_mm: 2\n  targets:\n    - 1\n    - x: 3");
    const auto same = vary_campaign(text, "c.yaml", {});
    ASSERT_EQ(same.size(), 1u);
    EXPECT_EQ(same[0].content, text);
}

/// Each point is in all ranges at once, fewer points are the first ones, and each of them is beside
/// every value that is listed.
TEST(CampaignVariation, FillsRangesTogether) {
    const std::string text = "a: 1\nb: 1\nc: 1\n";
    const std::vector<VariedKey> keys{parse_varied_key("a=2..3"), parse_varied_key("c=x,y"),
                                      parse_varied_key("b=0.01..100")};
    EXPECT_EQ(keys[0].range, (std::pair{2.0, 3.0}));
    const auto few = vary_campaign(text, "c.yaml", keys, 4);
    const auto many = vary_campaign(text, "c.yaml", keys, 64);
    ASSERT_EQ(few.size(), 8u);
    ASSERT_EQ(many.size(), 128u);
    EXPECT_EQ(few[0].name, "a=2.5 b=1 c=x");
    EXPECT_EQ(few[1].name, "a=2.5 b=1 c=y");
    // In each of 16 boxes, by a and by the ratio of b, are four points of 64, give or take two.
    int in_box[4][4] = {};
    for (std::size_t i = 0; i < many.size(); ++i) {
        if (i < few.size()) {
            EXPECT_EQ(many[i].name, few[i].name);
        }
        double a = 0;
        double b = 0;
        ASSERT_EQ(std::sscanf(many[i].name.c_str(), "a=%lf b=%lf", &a, &b), 2);
        ASSERT_TRUE(a > 2 && a < 3 && b > 0.01 && b < 100) << many[i].name;
        ++in_box[static_cast<int>(4 * (a - 2))][static_cast<int>(2 + std::log10(b))];
    }
    for (const auto& row : in_box) {
        for (const int count : row) EXPECT_NEAR(count, 8, 4);
    }
    EXPECT_THROW(vary_campaign(text, "c.yaml", keys), InputError);
    EXPECT_THROW(vary_campaign(text, "c.yaml", {keys[1]}, 4), InputError);
    for (const char* wrong : {"a=2..2", "a=3..2", "a=-1e308..1e308"}) {
        EXPECT_THROW(parse_varied_key(wrong), InputError) << wrong;
    }
    EXPECT_FALSE(parse_varied_key("a=x..y").range.has_value());
}

TEST(CampaignVariation, AddsKeysAndRefusesThoseUnderNothing) {
    const auto added = vary_campaign("name: a\n", "c.yaml", {parse_varied_key("cell.dwell=2")});
    EXPECT_EQ(added[0].content, "name: a\ncell:\n  dwell: 2");
    const std::string text = "name: a\nlist: [1, 2]\n";
    for (const char* wrong : {"name.first=1", "list.0=1", "list.3=1", "list.x=1"}) {
        EXPECT_THROW(vary_campaign(text, "c.yaml", {parse_varied_key(wrong)}), InputError) << wrong;
    }
    EXPECT_THROW(vary_campaign(text, "c.yaml", {parse_varied_key("name={")}), InputError);
    EXPECT_THROW(vary_campaign("a: [", "c.yaml", {parse_varied_key("a=1")}), InputError);
}

}  // namespace
}  // namespace posewise::io
