#include <gtest/gtest.h>

#include <filesystem>

#include "../../src/io/format/atomic_file.hpp"
#include "campaign_text.hpp"
#include "posewise/core/version.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/io/measurements_file.hpp"
#include "posewise/io/result_files.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::input_error_of;
using testing::TemporaryFolder;

/// Two of three candidates of the crane, chosen by D, and the plan's file.
class PlanFileTest : public ::testing::Test {
  protected:
    PlanFileTest() {
        const auto path = folder_.write("c.yaml", testing::campaign_text);
        const Campaign campaign = read_campaign(path);
        plan_.campaign = campaign.name;
        plan_.columns = configuration_columns(campaign);
        plan_.assumptions = assumptions_of(campaign);
        plan_.request.criterion = Criterion::D;
        plan_.kind = CandidateKind::Measurements;
        plan_.request.sources.campaign = path;
        plan_.request.sources.candidates = "absent.csv";
        plan_.request.repeats = 2.5;
        plan_.request.pose_count = 3;
        plan_.request.excluded = {"first"};
        plan_.request.repeat_limit = 2;
        plan_.request.starts = 20;
        plan_.request.seed = 18446744073709551615U;
        plan_.candidate_count = 3;
        plan_.checksum = "fnv1a64:0123456789abcdef";
        plan_.poses = {{"2, \"the\" second", Eigen::Vector3d(1.0 / 3, 0.5, 0.25), 1, {0, 1}},
                       {"dritte Stück", Eigen::Vector3d(0.7, 0.8, 0.125), 2, {1}}};
        plan_.value = -12.5;
        plan_.starts_at_best = 4;
        plan_.tried = 38760;
        plan_.ending = Ending::TimeLimit;
        plan_.certificate.M = Eigen::Matrix2d{{1.0 / 3, -0.1}, {-0.1, 7}};
    }

    /// The two poses, each once, as a continuous plan.
    void make_continuous() {
        plan_.kind = CandidateKind::Pool;
        plan_.request.pose_count = 2;
        plan_.poses[1].times = 1;
        plan_.predicted = {1e-4, 2e-4, 0};
        plan_.standard_deviations = {{"dq2_rad", 1e-5}};
        plan_.visiting_time = 17.5;
    }

    std::string written() const {
        write_plan(path_, plan_);
        return read_file(path_);
    }

    /// What reading says after `part` of the file was replaced.
    std::string error_with(const std::string& part, const std::string& by) const {
        const std::string text = testing::replaced(written(), part, by);
        EXPECT_NE(text, "") << part;
        return input_error_of([&] { read_plan(folder_.write("p.json", text)); });
    }

    std::string error_of(const std::string& text) const {
        return input_error_of([&] { read_plan(folder_.write("p.json", text)); });
    }

    /// Of plain blocks, in place of the two.
    std::string error_with_poses(const std::string& poses) {
        plan_.kind = CandidateKind::Blocks;
        plan_.request.sources.rows_per_block = 1;
        const std::string text = written();
        const std::size_t begin = text.find("\"poses\": ") + 9;
        const std::size_t end = text.find(",\n  \"certificate\"");
        return error_of(text.substr(0, begin) + poses + text.substr(end));
    }

    TemporaryFolder folder_;
    std::string path_ = folder_.path("plan.json");
    Plan plan_;
};

TEST_F(PlanFileTest, IsReadBackToTheLastDigit) {
    written();
    const Plan read = read_plan(path_);
    EXPECT_EQ(read.request.sources.campaign, folder_.path("c.yaml"));
    EXPECT_EQ(read.request.sources.candidates, "absent.csv");
    EXPECT_EQ(read.request.repeats, 2.5);
    EXPECT_EQ(read.request.pose_count, 3);
    EXPECT_EQ(read.request.excluded, plan_.request.excluded);
    EXPECT_EQ(read.request.repeat_limit, 2);
    EXPECT_EQ(read.request.seed, plan_.request.seed);
    EXPECT_EQ(read.campaign, plan_.campaign);
    EXPECT_EQ(read.columns, plan_.columns);
    EXPECT_EQ(read.candidate_count, 3);
    EXPECT_EQ(read.checksum, plan_.checksum);
    ASSERT_EQ(read.poses.size(), 2U);
    EXPECT_EQ(read.poses[1].times, 2);
    EXPECT_EQ(read.poses[1].targets, plan_.poses[1].targets);
    EXPECT_EQ(read.poses[0].configuration, plan_.poses[0].configuration);
    EXPECT_EQ(read.value, -12.5);
    EXPECT_EQ(read.bound, std::numeric_limits<double>::infinity());
    EXPECT_EQ(read.ending, Ending::TimeLimit);
    EXPECT_EQ(read.tried, 38760);
    EXPECT_EQ(read.certificate.M, plan_.certificate.M);
    EXPECT_EQ(read.certificate.sharpness, std::numeric_limits<double>::infinity());
    ASSERT_EQ(read.assumptions.size(), plan_.assumptions.size());
    for (std::size_t i = 0; i < read.assumptions.size(); ++i) {
        EXPECT_EQ(read.assumptions[i].name, plan_.assumptions[i].name);
        EXPECT_EQ(read.assumptions[i].value, plan_.assumptions[i].value);
    }
}

TEST_F(PlanFileTest, KeepsEveryKindOfCandidates) {
    plan_.request.sources.rows_per_block = 4;
    for (const CandidateKind kind : {CandidateKind::Measurements, CandidateKind::Configurations,
                                     CandidateKind::Random, CandidateKind::Blocks}) {
        plan_.kind = kind;
        written();
        const Plan read = read_plan(path_);
        EXPECT_EQ(read.kind, kind);
        EXPECT_EQ(read.request.sources.rows_per_block, kind == CandidateKind::Blocks ? 4 : 0);
    }
}

TEST_F(PlanFileTest, KeepsPosesToVerifyApart) {
    make_continuous();
    EXPECT_EQ(written().find("verification\""), std::string::npos);
    plan_.request.verification_count = 3;
    plan_.verification = {{"v1", Eigen::Vector3d(0.25, 0.5, 0.125), 1, {0}},
                          {"v2", Eigen::Vector3d(0.5, 0.25, 1.0 / 3), 1, {0, 1}}};
    plan_.verification[0].via = Eigen::Vector3d(0.1, 0.2, 0.3);
    plan_.verification_time = 3.5;
    written();
    const Plan read = read_plan(path_);
    EXPECT_EQ(read.poses.size(), 2U);
    EXPECT_EQ(read.request.verification_count, 3);
    EXPECT_EQ(read.verification_time, 3.5);
    ASSERT_EQ(read.verification.size(), 2U);
    EXPECT_EQ(read.verification[0].via, plan_.verification[0].via);
    EXPECT_EQ(read.verification[1].configuration, plan_.verification[1].configuration);
    EXPECT_EQ(read.verification[1].targets, plan_.verification[1].targets);
    const std::string error = error_with("\"id\": \"v2\"", "\"id\": \"dritte Stück\"");
    EXPECT_NE(error.find("verification[1].id: is 'dritte Stück'; must be another than that of "
                         "poses[1]"),
              std::string::npos)
        << error;
    const CampaignFile campaign = read_campaign(folder_.path("c.yaml"));
    write_plan(path_, plan_, {folder_.path("p.csv")}, campaign);
    const std::string csv = read_file(folder_.path("p.csv"));
    EXPECT_NE(csv.find(",visible_targets,purpose,way\n"), std::string::npos) << csv;
    EXPECT_NE(csv.find(",calibrate,straight\nv1.via,"), std::string::npos) << csv;
    EXPECT_NE(csv.find(",1,verify,straight\nv2,"), std::string::npos) << csv;
    EXPECT_EQ(read_configurations(folder_.path("p.csv"), campaign).ids.size(), 4U);
}

TEST_F(PlanFileTest, KeepsWhatAContinuousPlanIs) {
    make_continuous();
    plan_.poses[0].via = Eigen::Vector3d(0.1, 0.2, 0.3);
    plan_.poses[1].is_blocked = plan_.poses[1].is_kept = true;
    plan_.choice_value = -13;
    plan_.bound = -11;
    plan_.searched_bound = -12;
    plan_.searched_efficiency = 0.75;
    plan_.request.dropped = {"p3"};
    plan_.request.workspace_box_mm = {0, 0, 0, 1, 2, 3};
    plan_.request.pool_count = 1234;
    written();
    const Plan read = read_plan(path_);
    EXPECT_TRUE(read.is_continuous());
    EXPECT_EQ(read.poses[0].via, plan_.poses[0].via);
    EXPECT_FALSE(read.poses[1].via);
    EXPECT_TRUE(read.poses[1].is_blocked && read.poses[1].is_kept);
    EXPECT_EQ(read.choice_value, -13);
    EXPECT_EQ(read.bound, -11);
    EXPECT_EQ(read.searched_bound, -12);
    EXPECT_EQ(read.searched_efficiency, 0.75);
    EXPECT_EQ(read.predicted->rms, 1e-4);
    EXPECT_EQ(read.predicted->percentile95, 2e-4);
    EXPECT_EQ(read.standard_deviations[0].name, "dq2_rad");
    EXPECT_EQ(read.visiting_time, 17.5);
    EXPECT_EQ(read.request.dropped, plan_.request.dropped);
    EXPECT_EQ(read.request.workspace_box_mm, plan_.request.workspace_box_mm);
    EXPECT_EQ(read.request.pool_count, 1234);
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
              "p.json: search.stop_reason: is 'tired'; must be converged, optimal, time limit, "
              "interrupted or not run");
    EXPECT_EQ(error_with("\"starts\"", "\"begins\""),
              "p.json: search.starts: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_with("\"measurements\"", "\"hearsay\""),
              "p.json: candidates.kind: is 'hearsay'; must be measurements, configurations, "
              "random, blocks or pool");
    EXPECT_EQ(error_with("\"repeats\": 2.5", "\"repeats\": 0.5"),
              "p.json: candidates.repeats: is 0.5; must be at least 1");
    EXPECT_EQ(error_with("\"id\": \"" + plan_.poses[1].id + "\"", "\"id\": \"\""),
              "p.json: poses[1].id: is ''; must be a name");
    std::string text = written();
    for (std::size_t at; (at = text.find("\"joints\"")) != text.npos;) {
        text.replace(at, 8, "\"angles\"");
    }
    EXPECT_EQ(error_of(text),
              "p.json: poses[0].joints: is missing; must be there as posewise writes it");
}

TEST_F(PlanFileTest, RefusesNumbersNoPlanHas) {
    EXPECT_EQ(error_with("\"pose_count\": 3", "\"pose_count\": 9223372036854775807"),
              "p.json: problem.pose_count: is 9223372036854775807; must be at most 1000000");
    EXPECT_EQ(error_with("\"pose_count\": 3", "\"pose_count\": 18446744073709551615"),
              "p.json: problem.pose_count: is 18446744073709551615; must be at most 1000000");
    EXPECT_EQ(error_with("\"count\": 3", "\"count\": 10000001"),
              "p.json: candidates.count: is 10000001; must be at most 10000000");
    EXPECT_EQ(error_with("\"group_limit\": 0", "\"group_limit\": 1000001"),
              "p.json: problem.group_limit: is 1000001; must be at most 1000000");
    EXPECT_EQ(error_with("\"repeat_limit\": 2", "\"repeat_limit\": 1000001"),
              "p.json: problem.repeat_limit: is 1000001; must be at most 1000000");
    EXPECT_EQ(error_with("\"starts\": 20", "\"starts\": 1000001"),
              "p.json: search.starts: is 1000001; must be at most 1000000");
    EXPECT_EQ(error_with("\"starts_at_best\": 4", "\"starts_at_best\": 21"),
              "p.json: search.starts_at_best: is 21; must be at most 20");
    EXPECT_EQ(error_with("\"visible_targets\": [1,2]", "\"visible_targets\": [1,10001]"),
              "p.json: poses[0].visible_targets[1]: is 10001; must be at most 10000");
    EXPECT_EQ(error_with("\"visible_targets\": [1,2]", "\"visible_targets\": [1,1]"),
              "p.json: poses[0].visible_targets[1]: occurs before; keep one");
    EXPECT_EQ(error_with("\"repeats\": 2.5", "\"repeats\": 2e9"),
              "p.json: candidates.repeats: is 2000000000.0; must be at most 1e+09");
}

TEST_F(PlanFileTest, RefusesAContinuousPlanThatContradictsItself) {
    make_continuous();
    plan_.request.pool_count = 500;
    EXPECT_EQ(error_with("\"pose_count\": 2", "\"pose_count\": 99"),
              "p.json: problem.pose_count: is 99; must be 2, as many as there are poses");
    EXPECT_EQ(error_with("\"times\": 1", "\"times\": 50"),
              "p.json: poses[0].times: is 50; must be 1, since each pose is planned once");
    EXPECT_EQ(error_with("\"count\": 3", "\"count\": 501"),
              "p.json: candidates.count: is 501; must be at most 500");
    EXPECT_EQ(error_with("\"workspace_poses\": 500", "\"workspace_poses\": 10000000"),
              "p.json: problem.workspace_poses: is 10000000; must be at most 20000");
    EXPECT_EQ(error_with("\"time_limit_s\": 0.0", "\"time_limit_s\": -1"),
              "p.json: problem.time_limit_s: is -1; must be at least 0");
    EXPECT_EQ(error_with("\"visiting_time_s\": 17.5", "\"visiting_time_s\": -1"),
              "p.json: visiting_time_s: is -1; must be at least 0");
    EXPECT_EQ(error_with("\"efficiency\": 0.0", "\"efficiency\": -7"),
              "p.json: bounds.pool.efficiency: is -7; must be at least 0");
    EXPECT_EQ(error_with("\"is_proven\": false", "\"is_proven\": true"),
              "p.json: bounds.continuous.is_proven: is true; a bound that a search found is never "
              "proven");
    EXPECT_EQ(error_with("\"stop_reason\": \"time limit\"", "\"stop_reason\": \"optimal\""),
              "p.json: search.stop_reason: is 'optimal'; nothing proves that of continuous poses");
    EXPECT_EQ(error_with("\"via\": null", "\"via\": {}"),
              "p.json: poses[0].via: has other joints than poses[0].joints; must have the same");
}

TEST_F(PlanFileTest, LeadsToItsFilesFromItsOwnFolder) {
    std::filesystem::create_directory(folder_.path("plans"));
    folder_.write("here.csv", "");
    const std::string path = folder_.path("plans/p.json");
    plan_.request.sources.candidates =
        std::filesystem::proximate(folder_.path("here.csv")).string();  // as typed
    write_plan(path, plan_);
    EXPECT_NE(read_file(path).find("\"source\": \"../here.csv\""), std::string::npos);
    EXPECT_TRUE(std::filesystem::equivalent(read_plan(path).request.sources.candidates,
                                            folder_.path("here.csv")));
}

TEST_F(PlanFileTest, KeepsTheIdsInTheirOrder) {
    written();
    std::vector<std::string> ids;
    for (const PlannedPose& pose : read_plan(path_).poses) ids.push_back(pose.id);
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
    plan_.poses[1].id = "\xFF\xFE";
    EXPECT_EQ(input_error_of([&] { written(); }),
              "plan.json: cannot be written, since a name or id is not UTF-8 text; must be UTF-8 "
              "(or plain ASCII)");
    EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(PlanFileTest, IsWhatIsPrintedAsJsonToo) {
    const std::string file = written();
    const std::string printed = to_json(plan_, path_);
    const std::string common = file.substr(0, file.rfind("\n}"));
    EXPECT_EQ(printed.substr(0, common.size()), common);
    EXPECT_NE(printed.find("\n  \"value_rms_mm\": null"), std::string::npos) << printed;
    plan_.poses[1].id = "\xFF\xFE";
    EXPECT_EQ(input_error_of([&] { to_json(plan_, path_); }),
              "standard output: cannot be written, since a name or id is not UTF-8 text; must be "
              "UTF-8 (or plain ASCII)");
}

TEST_F(PlanFileTest, IsRefusedIfMissing) {
    EXPECT_EQ(input_error_of([&] { read_plan(path_); }),
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
    EXPECT_EQ(error_of(R"({"kind": "posewise plan", "format": 2})"),
              "p.json: poses: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_with_poses("{}"), "p.json: poses: is of type object; must be a list");
    EXPECT_EQ(error_with_poses("[]"), "p.json: poses: must be a list of at least one pose");
}

TEST_F(PlanFileTest, IsRefusedIfAPoseHasNoProperId) {
    EXPECT_EQ(error_with_poses(R"([{"id": "a", "times": 1}, 3])"),
              "p.json: poses[1]: is of type number; must be an object");
    EXPECT_EQ(error_with_poses("[{}]"),
              "p.json: poses[0].id: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_with_poses(R"([{"id": 3}])"),
              "p.json: poses[0].id: is of type number; must be text");
}

TEST_F(PlanFileTest, IsRefusedIfAPoseOccursTwice) {
    EXPECT_EQ(error_with_poses(R"([{"id": "a", "times": 1}, {"id": "b", "times": 1},
                                   {"id": "a", "times": 1}])"),
              "p.json: poses[2].id: is 'a'; must be another than that of poses[0]");
}

TEST_F(PlanFileTest, SurvivesHostileNesting) {
    EXPECT_NE(error_of(std::string(100000, '[')), "no error");
    EXPECT_NE(error_of(std::string(100000, '[') + std::string(100000, ']')), "no error");
}

}  // namespace
}  // namespace posewise::io
