#include <nlohmann/json.hpp>
#include <regex>

#include "program.hpp"

/// `plan` as a user runs it: on the FANUC, and in the demonstration cell.
namespace posewise::testing {
namespace {

const std::string cell_design = "'" + source_folder() + "/designs/cell_demo/campaign.yaml'";
const std::string quick = " --pool 500 --starts 2 --workspace-poses 50 ";

class PlanCommand : public Program {
  protected:
    nlohmann::json json_of(const std::string& name) const {
        return nlohmann::json::parse(text_of(name));
    }
    /// The demonstration cell with one line changed.
    void write_changed(const std::string& from, const std::string& to) const {
        std::string text = read_text(source_folder() + "/designs/cell_demo/campaign.yaml");
        const auto place = text.find(from);
        ASSERT_NE(place, std::string::npos) << from;
        write_text("changed.yaml", text.replace(place, from.size(), to));
    }
};

TEST_F(PlanCommand, WritesPosesAndTellsWhatTheyAchieve) {
    const std::string text =
        run_well("plan " + fanuc_design + " -k 12" + quick + "-o p.json --csv p.csv");
    const auto plan = json_of("p.json");
    ASSERT_EQ(plan.at("poses").size(), 12u);
    EXPECT_EQ(plan.at("criterion"), "v");
    EXPECT_EQ(plan.at("search").at("stop_reason"), "converged");
    EXPECT_EQ(plan.at("poses")[0].at("visible_targets").size(), 3u);
    EXPECT_EQ(plan.at("assumes").at("sigma_m"), 5.2e-5);
    EXPECT_GT(plan.at("value"), plan.at("bounds").at("pool").at("value"));
    EXPECT_GE(plan.at("bounds").at("continuous").at("bound"), plan.at("value"));
    EXPECT_NE(text.find("a search, not a proof"), std::string::npos) << text;
    EXPECT_NE(text.find("planned"), std::string::npos);
    // Another number than --target-mm finds, and why.
    const std::string line = std::regex_replace(text, std::regex("\\s+"), " ");
    EXPECT_NE(line.find("--target-mm plans for each number and keeps its limit with 95 %"),
              std::string::npos)
        << text;
    EXPECT_NE(text.find("target3.z"), std::string::npos);
    // What a person measures by: select reads it, and its digits are those of the plan.
    run_well("select " + fanuc_design + " --candidates p.csv -k 8 -o s.json");
    EXPECT_EQ(json_of("s.json").at("poses").size(), 8u);
    // And calibrate takes the plan as it takes that of select.
    run_well("simulate " + fanuc_design + " --configurations p.csv -o m.csv");
    run_well("calibrate " + fanuc_design + " -m m.csv --plan p.json --folds 0");
}

TEST_F(PlanCommand, IsTheSameForOneThreadAndTwo) {
    const std::string arguments =
        "plan " + cell_design + " -k 12 --pool 3000 --starts 2 --verification 4 -o p.json";
    const std::string one = run_well(arguments, "OMP_NUM_THREADS=1");
    const std::string file_one = text_of("p.json");
    EXPECT_EQ(run_well(arguments, "OMP_NUM_THREADS=2"), one);
    EXPECT_EQ(text_of("p.json"), file_one);
    EXPECT_NE(one.find("keep_out: "), std::string::npos);
    EXPECT_NE(one.find("laser tracker with sigma 10 um in range and 15 urad in angle"),
              std::string::npos);
    EXPECT_EQ(json_of("p.json").at("assumes").at("angle_sigma_rad"), 1.5e-5);
}

TEST_F(PlanCommand, RepairsAPlanWithoutMovingTheOthers) {
    run_well("plan " + fanuc_design + " -k 10" + quick + "-o p.json");
    const std::string text =
        run_well("plan " + fanuc_design + quick + "--plan p.json --drop 'p2, p5' -o r.json");
    EXPECT_NE(text.find("2 new, 8 kept"), std::string::npos) << text;
    const auto before = json_of("p.json").at("poses");
    const auto after = json_of("r.json").at("poses");
    ASSERT_EQ(after.size(), 10u);
    int kept = 0;
    for (const auto& pose : after) {
        if (!pose.at("kept")) continue;
        ++kept;
        for (const auto& old : before) {
            if (old.at("id") == pose.at("id")) {
                EXPECT_EQ(old.at("joints"), pose.at("joints"));
            }
        }
    }
    EXPECT_EQ(kept, 8);
    expect_input_error("plan " + fanuc_design + quick + "--plan p.json --drop p77 -o x.json",
                       "--drop p77: p.json has no such pose");
}

TEST_F(PlanCommand, ChecksThePlanItRepairs) {
    run_well("plan " + cell_design + " -k 8 --pool 1500 --starts 1 -o p.json");
    run_well("verify p.json");
    const auto sound = json_of("p.json");
    const auto expect_refused = [&](const nlohmann::json& plan, const std::string& words) {
        write_text("e.json", plan.dump());
        expect_input_error("plan " + cell_design + " --plan e.json --drop p2" + quick + "-o x.json",
                           words);
    };
    auto plan = sound;
    auto& pose = *std::find_if(plan.at("poses").begin(), plan.at("poses").end(),
                               [](const auto& other) { return other.at("id") == "p4"; });
    const auto joints = pose.at("joints");
    pose.erase("readable");
    pose.at("joints").at("q1_rad") = 1e6;
    expect_refused(plan,
                   "e.json: pose 'p4' is beyond the joint limits (less their margin): q1 is ");
    pose.at("joints") = joints;
    pose.at("joints").at("q2_rad") = 1.0;
    pose.at("joints").at("q3_rad") = -1.3;
    expect_refused(plan, "find another for it with --drop p4");
    write_text("e.json", plan.dump());  // what is dropped may be infeasible
    run_well("plan " + cell_design + " --plan e.json --drop p4 --pool 1500 --starts 1 -o r.json");
    pose.at("joints") = joints;
    pose.at("visible_targets") = nlohmann::json::array();
    expect_refused(plan, "e.json: poses[3].visible_targets: is empty");
    pose.at("visible_targets") = {1};
    pose.at("id") = "p5";
    expect_refused(plan, "is 'p5'; must be another than that of poses[");
    plan = sound;
    plan.at("campaign") = "another cell";
    expect_refused(plan, "campaign: is 'another cell'; must be a plan of 'FANUC");
    write_text("b.csv", "1,0\n0,1\n1,1\n1,-1\n2,1\n1,2\n");
    run("select --blocks b.csv --rows 1 -k 3 -o b.json");
    expect_input_error("plan " + cell_design + " --plan b.json --drop p2" + quick + "-o x.json",
                       "is a choice from plain blocks; must be a plan of continuous poses");
}

TEST_F(PlanCommand, SaysThatThePoolIsTooSmall) {
    expect_input_error("plan " + cell_design + " -k 12 --pool 60 -o x.json",
                       " feasible poses of 60 candidates, 12 are needed; raise --pool or relax ");
}

TEST_F(PlanCommand, TimeCoversThePool) {
    const std::string text = run("plan " + cell_design +
                                 " -k 12 --prior --pool 10000000 --workspace-poses 50 --time 4 "
                                 "-o p.json")
                                 .out;
    EXPECT_LT(json_of("p.json").at("candidates").at("drawn"), 10000000);
    EXPECT_EQ(json_of("p.json").at("search").at("stop_reason"), "time limit");
    EXPECT_NE(text.find("left out, planning was stopped"), std::string::npos) << text;
}

/// A snake of so many joints in turn about z and y.
std::string snake_campaign(int joints, const std::string& errors) {
    std::string limits, elements;
    for (int j = 1; j <= joints; ++j) {
        const std::string name = 'q' + std::to_string(j);
        limits += (j > 1 ? ", " : "") + name + ": {limits_deg: [-100, 100]}";
        elements += (j > 1 ? ", " : "") + std::string(j % 2 == 1 ? "Rz " : "Ry ") + name +
                    ", Tx 50 mm, Tz 100 mm";
    }
    return "name: snake\nrobot:\n  errors: " + errors + "\n  joints: {" + limits +
           "}\n  elements: [" + elements +
           "]\nsensor: {kind: points, sigma_mm: 0.05, targets: {count: 3}}\n";
}

TEST_F(PlanCommand, TimeCoversTheIrreducibleModel) {
    write_text("snake.yaml", snake_campaign(100, "geometric"));
    for (const std::string rest :
         {"plan snake.yaml -k 60", "select snake.yaml --random 99 -k 60"}) {
        const Outcome outcome = run(rest + " --time 0.02 -o p.json");
        EXPECT_EQ(outcome.code, 1);
        EXPECT_NE(outcome.err.find("no irreducible model was found: the time was up while finding "
                                   "what is identifiable of "),
                  std::string::npos)
            << outcome.err;
    }
}

TEST_F(PlanCommand, SaysWhatALimitThatWasNotKeptWentTo) {
    write_text("snake.yaml", snake_campaign(24, "full"));
    const Outcome outcome = run("plan snake.yaml -k 20 --pool 300 --time 0.02 -o p.json");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_NE(outcome.err.find(" s, --time is 0.02: "), std::string::npos) << outcome.err;
}

TEST_F(PlanCommand, CountsWhatWasMeasuredAlready) {
    run_well("simulate " + fanuc_design + " -k 8 --repeats 2 -o m.csv");
    const std::string text =
        run_well("plan " + fanuc_design + " -k 2 --augment m.csv --criterion d" + quick +
                 "--focus robot -o p.json");
    EXPECT_NE(text.find("2 new, 8 measured already"), std::string::npos) << text;
    EXPECT_EQ(json_of("p.json").at("problem").at("focus"), "robot");
}

TEST_F(PlanCommand, AnInterruptedPlanIsWrittenAndMarked) {
    const std::string arguments =
        "plan " + fanuc_design + " -k 16 --pool 2000 --starts 2000 --workspace-poses 50 -o p.json";
    const Outcome outcome = run(arguments, "timeout --signal=INT 4");
    EXPECT_NE(outcome.err.find("the plan is the best so far"), std::string::npos) << outcome.err;
    EXPECT_EQ(json_of("p.json").at("search").at("stop_reason"), "interrupted");
    EXPECT_EQ(json_of("p.json").at("poses").size(), 16u);
    const Outcome timed = run(arguments + " --time 2");
    EXPECT_EQ(timed.code, 0);
    EXPECT_EQ(json_of("p.json").at("search").at("stop_reason"), "time limit");
}

TEST_F(PlanCommand, RefusesDropOutsOfAllPoses) {
    expect_input_error("plan " + fanuc_design + " -k 8 --robust-to 8" + quick,
                       "8 poses that may be missing leave none of 8");
}

TEST_F(PlanCommand, RefusesContradictoryLimits) {
    write_changed("range_mm: [1500, 8000]", "range_mm: [8000, 1500]");
    expect_input_error("plan changed.yaml -k 12" + quick, "range");
    write_changed("q1: {limits_deg: [-90, 90]}", "q1: {limits_deg: [90, -90]}");
    expect_input_error("plan changed.yaml -k 12" + quick, "q1");
}

TEST_F(PlanCommand, RefusesARangeSigmaOfZero) {
    write_changed("range_um: 10", "range_um: 0");
    expect_input_error("plan changed.yaml -k 12" + quick, "range_um");
}

TEST_F(PlanCommand, RefusesABoxOutOfReach) {
    write_changed("max: [3000, 1800, 2400]", "max: [9000, 1800, 2400]");
    write_changed("{min: [300, -2200, -400], max: [3000, 1800, 2400]}",
                  "{min: [7000, 7000, 7000], max: [8000, 8000, 8000]}");
    expect_input_error("plan changed.yaml -k 12" + quick, "target_boxes alone leaves nothing");
    expect_input_error("plan " + fanuc_design + " -k 12" + quick +
                           "--workspace-box-mm 7000,7000,7000,8000,8000,8000",
                       "workspace: none of");
}

TEST_F(PlanCommand, RefusesFewerPosesThanIdentify) {
    expect_input_error("plan " + fanuc_design + " -k 3" + quick, "must be at least 5");
    run_well("plan " + fanuc_design + " -k 5 --prior" + quick + "-o p.json");
}

TEST_F(PlanCommand, RefusesAPlanThatSeesADirectionByRoundingOnly) {
    expect_input_error("plan " + cell_design + " -k 5 --pool 1500 --starts 1 -o p.json",
                       "no choice was found that identifies all 33 parameters");
    expect_input_error("plan " + seed_design + " -k 12" + quick,
                       "unseen (0.61 Tx2 - 0.56 dq2 + 0.56 dq3)");
}

TEST_F(PlanCommand, SaysThatTheBoundIsLooseAtFewPoses) {
    const std::string few = run_well("plan " + fanuc_design + " -k 5 -c a" + quick + "-o p.json");
    EXPECT_NE(few.find("note:        the bound is loose at so few poses: "), std::string::npos)
        << few;
    const std::string many = run_well("plan " + fanuc_design + " -k 40 -c d" + quick + "-o p.json");
    EXPECT_EQ(many.find("loose"), std::string::npos) << many;
}

TEST_F(PlanCommand, RefusesMeasurementsOfAnotherRobot) {
    std::string other = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const std::string length = "Tz 1075 mm";
    write_text("other.yaml", other.replace(other.find(length), length.size(), "Tz 600 mm"));
    run_well("simulate other.yaml -k 12 -o other.csv");
    expect_input_error("plan " + fanuc_design + " -k 4 --augment other.csv" + quick,
                       "another robot");
    expect_input_error("plan " + fanuc_design + " -k 4 --plan other.csv --drop p1" + quick,
                       "other.csv");
}

}  // namespace
}  // namespace posewise::testing
