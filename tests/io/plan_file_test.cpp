#include "posewise/io/plan_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>

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
class PlanFileTest : public ::testing::Test {
  protected:
    PlanFileTest() {
        const auto campaign = folder_.write("c.yaml", testing::campaign_text);
        campaign_ = read_campaign(campaign);
        file_.request.source.campaign = campaign;
        file_.request.source.path = "absent.csv";
        file_.request.source.repeats = 2.5;
        file_.request.pose_count = 3;
        file_.request.excluded = {"first"};
        file_.request.repeat_limit = 2;
        file_.candidate_count = 3;
        file_.checksum = "fnv1a64:0123456789abcdef";
        file_.poses = {{"2, \"the\" second", 1, Eigen::Vector3d(1.0 / 3, 0.5, 0.25)},
                       {"dritte Stück", 2, Eigen::Vector3d(0.7, 0.8, 0.125)}};
        file_.plan.value = -12.5;
        file_.plan.seed = 18446744073709551615U;
        file_.plan.starts = 20;
        file_.plan.starts_at_best = 4;
        file_.plan.ending = Ending::TimeLimit;
        file_.plan.certificate.M = Eigen::Matrix2d{{1.0 / 3, -0.1}, {-0.1, 7}};
    }

    std::string written() const {
        write_plan(path_, file_, &campaign_);
        return read_file(path_);
    }

    /// What reading says after `part` of the file was replaced.
    std::string error_with(const std::string& part, const std::string& by) const {
        const std::string text = testing::replaced(written(), part, by);
        EXPECT_NE(text, "") << part;
        return input_error_of([&] { read_plan(folder_.write("p.json", text)); });
    }

    std::string error_of(const std::string& text) const {
        return input_error_of([&] { read_plan_poses(folder_.write("p.json", text)); });
    }

    std::string error_with_poses(const std::string& poses) const {
        return error_of(R"({"kind": "posewise plan", "poses": )" + poses + "}");
    }

    TemporaryFolder folder_;
    std::string path_ = folder_.path("plan.json");
    Campaign campaign_;
    PlanFile file_;
};

TEST_F(PlanFileTest, IsReadBackToTheLastDigit) {
    written();
    const PlanFile read = read_plan(path_);
    EXPECT_EQ(read.request.source.campaign, folder_.path("c.yaml"));
    EXPECT_EQ(read.request.source.path, "absent.csv");
    EXPECT_EQ(read.request.source.repeats, 2.5);
    EXPECT_EQ(read.request.pose_count, 3);
    EXPECT_EQ(read.request.excluded, file_.request.excluded);
    EXPECT_EQ(read.request.repeat_limit, 2);
    EXPECT_EQ(read.candidate_count, 3);
    EXPECT_EQ(read.checksum, file_.checksum);
    ASSERT_EQ(read.poses.size(), 2U);
    EXPECT_EQ(read.poses[1].times, 2);
    EXPECT_EQ(read.poses[0].joints, file_.poses[0].joints);
    EXPECT_EQ(read.plan.value, -12.5);
    EXPECT_EQ(read.plan.bound, std::numeric_limits<double>::infinity());
    EXPECT_EQ(read.plan.seed, file_.plan.seed);
    EXPECT_EQ(read.plan.ending, Ending::TimeLimit);
    EXPECT_EQ(read.plan.certificate.M, file_.plan.certificate.M);
    EXPECT_EQ(read.plan.certificate.sharpness, std::numeric_limits<double>::infinity());
}

TEST_F(PlanFileTest, KeepsEveryKindOfCandidates) {
    using Kind = CandidateSource::Kind;
    for (const Kind kind : {Kind::Measurements, Kind::Configurations, Kind::Random, Kind::Blocks}) {
        file_.request.source.kind = kind;
        file_.request.source.seed = 9;
        file_.request.source.rows_per_block = 4;
        written();
        const CandidateSource read = read_plan(path_).request.source;
        EXPECT_EQ(read.kind, kind);
        EXPECT_EQ(read.seed, kind == Kind::Random ? 9U : 1U);
        EXPECT_EQ(read.rows_per_block, kind == Kind::Blocks ? 4 : 0);
    }
}

TEST_F(PlanFileTest, HasAMatrixRowOnOneLine) {
    EXPECT_NE(written().find("      [-0.1,7.0]\n"), std::string::npos) << written();
}

TEST_F(PlanFileTest, SaysWhereAnEditedFileIsWrong) {
    EXPECT_EQ(error_with("\"value\": -12.5", "\"value\": \"high\""),
              "p.json: value: is of type string; must be a number");
    EXPECT_EQ(error_with("\"criterion\": \"d\"", "\"criterion\": \"q\"").substr(0, 35),
              "p.json: criterion: 'q' is no criter");
    EXPECT_EQ(error_with("\"pose_count\": 3", "\"pose_count\": 0"),
              "p.json: problem.pose_count: is 0; must be at least 1");
    EXPECT_EQ(error_with("\"times\": 2", "\"times\": 1.5"),
              "p.json: poses[1].times: is of type number; must be a whole number");
    EXPECT_EQ(error_with("[-0.1,7.0]", "[7.0]"),
              "p.json: certificate.M_lower[1]: has 1 numbers; must have 2, the lower triangle");
    EXPECT_EQ(error_with("\"time limit\"", "\"tired\""),
              "p.json: search.stop_reason: is 'tired', which is none of posewise");
    EXPECT_EQ(error_with("\"starts\"", "\"begins\""),
              "p.json: search.starts: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_with("\"measurements\"", "\"hearsay\""),
              "p.json: candidates.kind: is 'hearsay'; must be measurements, configurations, random "
              "or blocks");
    EXPECT_EQ(error_with("\"repeats\": 2.5", "\"repeats\": 0.5"),
              "p.json: candidates.repeats: must be at least 1");
}

TEST_F(PlanFileTest, LeadsToItsFilesFromItsOwnFolder) {
    std::filesystem::create_directory(folder_.path("plans"));
    folder_.write("here.csv", "");
    const std::string path = folder_.path("plans/p.json");
    file_.request.source.path =
        std::filesystem::proximate(folder_.path("here.csv")).string();  // as typed
    write_plan(path, file_, &campaign_);
    EXPECT_NE(read_file(path).find("\"source\": \"../here.csv\""), std::string::npos);
    EXPECT_TRUE(
        std::filesystem::equivalent(read_plan(path).request.source.path, folder_.path("here.csv")));
}

TEST_F(PlanFileTest, KeepsTheIdsInTheirOrder) {
    written();
    std::vector<std::string> ids;
    for (const PlannedPose& pose : read_plan_poses(path_)) ids.push_back(pose.id);
    EXPECT_EQ(ids, (std::vector<std::string>{"2, \"the\" second", "dritte Stück"}));
}

TEST_F(PlanFileTest, SaysWhatThePlanIsAndAssumes) {
    const std::string text = written();
    for (const std::string& part :
         {"\"posewise_version\": \"" + std::string(version) + "\"",
          std::string("\"campaign\": \"crane\""), std::string("\"source\": \"absent.csv\""),
          std::string("\"criterion\": \"d\""), std::string("\"value\": -12.5"),
          std::string("\"bound\": null"), std::string("\"seed\": 18446744073709551615"),
          std::string("\"sigma_m\": 5e-05"), std::string("\"model_error_m\": 0.0002"),
          std::string("\"dq2_rad\": 0.0005"), std::string("\"target2.z_m\": 0.002"),
          std::string("\"q1_rad\": 0.3333333333333333"), std::string("\"lift_m\": 0.125")}) {
        EXPECT_NE(text.find(part), std::string::npos) << part << " is not in " << text;
    }
}

TEST_F(PlanFileTest, HasTheSameBytesForTheSamePlan) { EXPECT_EQ(written(), written()); }

TEST_F(PlanFileTest, IsNotWrittenWithAnIdThatIsNotText) {
    file_.poses[1].id = "\xFF\xFE";
    EXPECT_EQ(input_error_of([&] { written(); }),
              "plan.json: cannot be written, since a name or id is not UTF-8 text; must be UTF-8 "
              "(or plain ASCII)");
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(PlanFileTest, IsRefusedIfMissing) {
    EXPECT_EQ(input_error_of([&] { read_plan_poses(path_); }),
              "plan.json: cannot be read: No such file or directory");
}

TEST_F(PlanFileTest, IsRefusedIfItIsNotJson) {
    EXPECT_EQ(error_of(""), "p.json: is not JSON here; must be a plan as posewise writes it");
    EXPECT_EQ(error_of("{\n  \"kind\": oops}"),
              "p.json:2:11: is not JSON here; must be a plan as posewise writes it");
    const std::string whole = written();
    EXPECT_NE(error_of(whole.substr(0, whole.size() / 2)), "no error");
}

TEST_F(PlanFileTest, IsRefusedIfItIsAnotherDocument) {
    const std::string message =
        "p.json: kind: must be \"posewise plan\", as in a plan written by posewise";
    EXPECT_EQ(error_of("[]"), message);
    EXPECT_EQ(error_of("{}"), message);
    EXPECT_EQ(error_of(R"({"kind": 3})"), message);
    EXPECT_EQ(error_of(R"({"kind": "posewise estimate"})"), message);
}

TEST_F(PlanFileTest, IsRefusedWithoutPoses) {
    const std::string message = "p.json: poses: must be a list of at least one pose";
    EXPECT_EQ(error_of(R"({"kind": "posewise plan"})"), message);
    EXPECT_EQ(error_with_poses("{}"), message);
    EXPECT_EQ(error_with_poses("[]"), message);
}

TEST_F(PlanFileTest, IsRefusedIfAPoseHasNoProperId) {
    EXPECT_EQ(error_with_poses(R"([{"id": "a"}, 3])"),
              "p.json: poses[1]: is of type number; must be an object");
    EXPECT_EQ(error_with_poses("[{}]"),
              "p.json: poses[0].id: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_with_poses(R"([{"id": 3}])"),
              "p.json: poses[0].id: is of type number; must be text");
}

TEST_F(PlanFileTest, IsRefusedIfAPoseOccursTwice) {
    EXPECT_EQ(error_with_poses(R"([{"id": "a"}, {"id": "b"}, {"id": "a"}])"),
              "p.json: poses[2].id: 'a' occurs before in poses[0]; keep one");
}

TEST_F(PlanFileTest, SurvivesHostileNesting) {
    EXPECT_NE(error_of(std::string(100000, '[')), "no error");
    EXPECT_NE(error_of(std::string(100000, '[') + std::string(100000, ']')), "no error");
}

}  // namespace
}  // namespace posewise::io
