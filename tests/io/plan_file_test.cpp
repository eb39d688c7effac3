#include "posewise/io/plan_file.hpp"

#include <gtest/gtest.h>

#include "campaign_text.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/atomic_file.hpp"
#include "posewise/io/campaign_file.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::input_error_of;
using testing::TemporaryFolder;

/// Two of three candidates of the crane, chosen by D, and the plan's file.
class PlanFile : public ::testing::Test {
  protected:
    PlanFile() {
        const auto campaign = folder_.write("c.yaml", testing::campaign_text);
        campaign_ = read_campaign(campaign).campaign;
        candidates_.ids = {"first", "2, \"the\" second", "dritte Stück"};
        candidates_.configurations.resize(3, 3);
        candidates_.configurations << 0.1, 0.2, 0.3, 1.0 / 3, 0.5, 0.25, 0.7, 0.8, 0.125;
        plan_.poses = {1, 2};
        plan_.value = -12.5;
        plan_.seed = 18446744073709551615U;
    }

    std::string written() const {
        write_plan(path_, plan_, campaign_, candidates_, "m.csv");
        return read_file(path_);
    }

    std::string error_of(const std::string& text) const {
        return input_error_of([&] { read_plan_ids(folder_.write("p.json", text)); });
    }

    std::string error_with_poses(const std::string& poses) const {
        return error_of(R"({"kind": "posewise plan", "poses": )" + poses + "}");
    }

    TemporaryFolder folder_;
    std::string path_ = folder_.path("plan.json");
    Campaign campaign_;
    Measurements candidates_;
    Plan plan_;
};

TEST_F(PlanFile, KeepsTheIdsInTheirOrder) {
    written();
    EXPECT_EQ(read_plan_ids(path_),
              (std::vector<std::string>{"2, \"the\" second", "dritte Stück"}));
}

TEST_F(PlanFile, SaysWhatThePlanIsAndAssumes) {
    const std::string text = written();
    for (const std::string& part :
         {"\"posewise_version\": \"" + std::string(version) + "\"",
          std::string("\"campaign\": \"crane\""), std::string("\"source\": \"m.csv\""),
          std::string("\"criterion\": \"d\""), std::string("\"value\": -12.5"),
          std::string("\"bound\": null"), std::string("\"seed\": 18446744073709551615"),
          std::string("\"sigma_m\": 5e-05"), std::string("\"model_error_m\": 0.0002"),
          std::string("\"dq2_rad\": 0.0005"), std::string("\"target2.z_m\": 0.002"),
          std::string("\"q1_rad\": 0.3333333333333333"), std::string("\"lift_m\": 0.125")}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << " is not in " << text;
    }
}

TEST_F(PlanFile, HasTheSameBytesForTheSamePlan) { EXPECT_EQ(written(), written()); }

TEST_F(PlanFile, IsNotWrittenWithAnIdThatIsNotText) {
    candidates_.ids[2] = "\xFF\xFE";
    EXPECT_EQ(input_error_of([&] { written(); }),
              "plan.json: cannot be written, since a name or id is not UTF-8 text; must be UTF-8 "
              "(or plain ASCII)");
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(PlanFile, IsRefusedIfMissing) {
    EXPECT_EQ(input_error_of([&] { read_plan_ids(path_); }),
              "plan.json: cannot be read: No such file or directory");
}

TEST_F(PlanFile, IsRefusedIfItIsNotJson) {
    EXPECT_EQ(error_of(""), "p.json: is not JSON here; must be a plan as posewise writes it");
    EXPECT_EQ(error_of("{\n  \"kind\": oops}"),
              "p.json:2:11: is not JSON here; must be a plan as posewise writes it");
    const std::string whole = written();
    EXPECT_NE(error_of(whole.substr(0, whole.size() / 2)), "no error");
}

TEST_F(PlanFile, IsRefusedIfItIsAnotherDocument) {
    const std::string message =
        "p.json: kind: must be \"posewise plan\", as in a plan written by posewise";
    EXPECT_EQ(error_of("[]"), message);
    EXPECT_EQ(error_of("{}"), message);
    EXPECT_EQ(error_of(R"({"kind": 3})"), message);
    EXPECT_EQ(error_of(R"({"kind": "posewise estimate"})"), message);
}

TEST_F(PlanFile, IsRefusedWithoutPoses) {
    const std::string message = "p.json: poses: must be a list of at least one pose";
    EXPECT_EQ(error_of(R"({"kind": "posewise plan"})"), message);
    EXPECT_EQ(error_with_poses("{}"), message);
    EXPECT_EQ(error_with_poses("[]"), message);
}

TEST_F(PlanFile, IsRefusedIfAPoseHasNoProperId) {
    EXPECT_EQ(error_with_poses(R"([{"id": "a"}, 3])"),
              "p.json: poses[1]: must be an object with an id");
    EXPECT_EQ(error_with_poses("[{}]"), "p.json: poses[0].id: is missing; must be text");
    EXPECT_EQ(error_with_poses(R"([{"id": 3}])"),
              "p.json: poses[0].id: is of type number; must be text");
}

TEST_F(PlanFile, IsRefusedIfAPoseOccursTwice) {
    EXPECT_EQ(error_with_poses(R"([{"id": "a"}, {"id": "b"}, {"id": "a"}])"),
              "p.json: poses[2].id: 'a' occurs before in poses[0]; keep one");
}

TEST_F(PlanFile, SurvivesHostileNesting) {
    EXPECT_NE(error_of(std::string(100000, '[')), "no error");
    EXPECT_NE(error_of(std::string(100000, '[') + std::string(100000, ']')), "no error");
}

}  // namespace
}  // namespace posewise::io
