#include <gtest/gtest.h>

#include <numbers>

#include "campaign_text.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

class ReadConfigurations : public ::testing::Test {
  protected:
    Configurations read(const std::string& text) const {
        return read_configurations(folder_.write("q.csv", text), campaign_);
    }

    testing::TemporaryFolder folder_;
    CampaignFile campaign_ = read_campaign(folder_.write("c.yaml", testing::campaign_text));
};

TEST_F(ReadConfigurations, NeedsNoColumnsOfTheSensor) {
    const Configurations read_back =
        read("config,q1_rad,q2_rad,lift_mm\nlow,0.5,0.25,125\nhigh,1,0.5,250\n");
    EXPECT_EQ(read_back.ids, (std::vector<std::string>{"low", "high"}));
    EXPECT_EQ(read_back.joints, (RowMatrixXd{{0.5, 0.25, 0.125}, {1, 0.5, 0.25}}));
}

TEST_F(ReadConfigurations, DoesNotLookAtWhatWasMeasured) {
    const Configurations read_back =
        read("config,q1_rad,q2_rad,lift_mm,p1_x_mm\nlow,0.5,0.25,125,lost\n");
    EXPECT_EQ(read_back.joints, (RowMatrixXd{{0.5, 0.25, 0.125}}));
}

TEST_F(ReadConfigurations, MayListTheTargetsThatAreVisible) {
    const std::string header = "config,q1_rad,q2_rad,lift_mm";
    const Seen all = Seen::Constant(2, 2, true);
    EXPECT_TRUE((read(header + "\na,0.5,0.25,125\nb,1,0.5,250\n").is_seen == all).all());
    const Configurations some =
        read(header + ",visible_targets\na,0.5,0.25,125,2\nb,1,0.5,250,\"2  1\"\n");
    EXPECT_TRUE((some.is_seen == Seen{{false, true}, {true, true}}).all());
    for (const std::string bad : {"", "0", "3", "1,2", "1.5", "-1", "one", "1 3", "1e999"}) {
        const std::string error = testing::input_error_of(
            [&] { read(header + ",visible_targets\na,0.5,0.25,125,\"" + bad + "\"\n"); });
        EXPECT_EQ(error, "q.csv:2:17: visible_targets is '" + bad +
                             "'; must be numbers of targets from 1 to 2, separated by blanks");
    }
    const std::string misspelt =
        testing::input_error_of([&] { read(header + ",visible_target\n"); });
    EXPECT_NE(misspelt.find("did you mean 'visible_targets'?"), std::string::npos) << misspelt;
}

TEST_F(ReadConfigurations, RefusesWhatIsBeyondTheLimits) {
    const std::string header = "config,q1_deg,q2_rad,lift_mm\n";
    const Joint& q1 = campaign_.robot.joints()[0];
    const double most = q1.upper * 180 / std::numbers::pi;
    read(header + "edge," + std::to_string(most + 1e-6) + ",0.25,125\n");
    const std::string error = testing::input_error_of(
        [&] { read(header + "in,0,0.25,125\nout," + std::to_string(most + 1) + ",0.25,125\n"); });
    EXPECT_EQ(error.rfind("q.csv: configuration 'out' is beyond the joint limits: q1 is ", 0), 0U)
        << error;
}

TEST_F(ReadConfigurations, LeavesOutThePointsToPassThatProgramsKeep) {
    const std::string text =
        "config,q1_rad,q2_rad,lift_mm,visible_targets,purpose,way,clearance_mm,nearest\n"
        "p1.via,0.7,0.2,100,,via,straight,,\n"
        "p1,0.5,0.25,125,2,calibrate,BLOCKED,31.50,target 1 to fence\n"
        "v1,1,0.5,250,1 2,verify,straight,,\n";
    const Configurations configurations = read(text);
    EXPECT_EQ(configurations.ids, (std::vector<std::string>{"p1", "v1"}));
    EXPECT_TRUE((configurations.is_seen == Seen{{false, true}, {true, true}}).all());
    const Configurations program = read_program(folder_.write("q.csv", text), campaign_);
    EXPECT_EQ(program.ids, (std::vector<std::string>{"p1.via", "p1", "v1"}));
    EXPECT_EQ(program.purposes, (std::vector<std::string>{"via", "calibrate", "verify"}));
    const std::string error = testing::input_error_of(
        [&] { read("config,q1_rad,q2_rad,lift_mm,purpose\na,0.5,0.25,125,Via\n"); });
    EXPECT_EQ(error, "q.csv:2:16: purpose is 'Via'; must be calibrate, verify or via");
}

TEST_F(ReadConfigurations, StillNeedsEveryJoint) {
    const std::string error =
        testing::input_error_of([&] { read("config,q1_rad,lift_mm\nlow,0.5,125\n"); });
    EXPECT_EQ(error.rfind("q.csv:1:22: missing column q2_rad", 0), 0U) << error;
}

TEST_F(ReadConfigurations, ACampaignMayStateAPrior) {
    EXPECT_FALSE(campaign_.spread.is_prior);
    const auto with_prior =
        folder_.write("p.yaml", std::string(testing::campaign_text) + "prior: true\n");
    EXPECT_TRUE(read_campaign(with_prior).spread.is_prior);
    const auto with_word =
        folder_.write("p.yaml", std::string(testing::campaign_text) + "prior: maybe\n");
    EXPECT_NE(testing::input_error_of([&] { read_campaign(with_word); }).find("true or false"),
              std::string::npos);
}

}  // namespace
}  // namespace posewise::io
