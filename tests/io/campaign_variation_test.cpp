#include "posewise/io/campaign_variation.hpp"

#include <gtest/gtest.h>

#include "posewise/core/errors.hpp"

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
