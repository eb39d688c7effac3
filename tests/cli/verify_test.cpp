#include <functional>
#include <nlohmann/json.hpp>

#include "program.hpp"

/// `verify` on sound plans, and on plans edited by hand.
namespace posewise::testing {
namespace {

using Json = nlohmann::ordered_json;

class Verify : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 40 -o s.csv");
        run_well("select " + fanuc_design +
                 " -m s.csv -k 10 --starts 3 --proof 0 --exclude 0,1 -o p.json");
    }

    /// Verifies the plan changed by `edit` and expects it found wrong, with `words` on standard
    /// output and `name` among the numbers that are not as stated.
    void expect_found(const std::function<void(Json&)>& edit, const std::string& words,
                      const std::string& name) const {
        Json plan = Json::parse(text_of("p.json"));
        edit(plan);
        write_text("edited.json", plan.dump());
        const Outcome outcome = run("verify edited.json");
        EXPECT_EQ(outcome.code, 1) << words;
        EXPECT_NE(outcome.out.find(words), std::string::npos) << outcome.out;
        const auto list = outcome.err.find("not as stated: ");
        ASSERT_NE(list, std::string::npos) << outcome.err;
        EXPECT_NE(outcome.err.find(name, list), std::string::npos) << outcome.err;
    }
};

TEST_F(Verify, FindsASoundPlanAsStated) {
    const std::string text = run_well("verify p.json");
    for (const std::string name :
         {"candidates: ", "value:      ", "bound:      ", "efficiency: "}) {
        EXPECT_NE(text.find(name + "as stated, "), std::string::npos) << text;
    }
    EXPECT_NE(text.find("poses:      10, within the limits"), std::string::npos);
}

TEST_F(Verify, FindsEveryPlanOfEveryCriterion) {
    for (const std::string criterion : {"o1", "o2", "o3", "o4", "o5", "a", "e", "g", "v"}) {
        run_well("select " + fanuc_design + " -m s.csv -k 8 --starts 1 -o c.json -c " + criterion);
        const std::string text = run_well("verify c.json");
        EXPECT_NE(text.find("bound:      as stated"), std::string::npos) << criterion << text;
    }
}

TEST_F(Verify, SaysInOneSentenceThatTheErrorsAreOthersNow) {
    std::string campaign = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    write_text("c.yaml", campaign);
    run_well("select c.yaml -m s.csv -k 10 --starts 1 -o q.json");
    run_well("plan c.yaml -k 10 --pool 500 --starts 1 --workspace-poses 50 -o r.json");
    campaign.insert(campaign.find("  elements:"), "  errors: full\n");
    write_text("c.yaml", campaign);
    for (const std::string plan : {"q.json", "r.json"}) {
        const Outcome outcome = run("verify " + plan);
        EXPECT_EQ(outcome.code, 1);
        EXPECT_NE(outcome.out.find("parameters: planned for 33, the campaign has "),
                  std::string::npos)
            << outcome.out;
        EXPECT_EQ(outcome.out.find("inf"), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.out.find("assumes"), std::string::npos) << outcome.out;
        EXPECT_EQ(outcome.err, "posewise: " + plan + ": not as stated: parameters\n");
    }
}

TEST_F(Verify, SaysWhichNumberWasEdited) {
    const auto shift = [](const std::string& key) {
        return [key](Json& plan) { plan[key] = plan[key].get<double>() + 1e-3; };
    };
    expect_found(shift("value"), "value:      stated", "value");
    expect_found(shift("bound"), "bound:      stated", "bound");
    expect_found(shift("efficiency"), "efficiency: stated", "efficiency");
    expect_found([](Json& plan) { plan["certificate"]["M_lower"][0][0] = 1e6; }, "bound:      st",
                 "bound");
    expect_found([](Json& plan) { plan["certificate"]["M_lower"] = Json::parse("[[1]]"); },
                 "certificate: is 1 x 1, must be 33 x 33", "certificate");
    expect_found([](Json& plan) { plan["certificate"]["M_lower"] = Json::array(); },
                 "certificate: none, so nothing is proven", "bound");
    expect_found([](Json& plan) { plan["criterion"] = "a"; }, "value:      stated", "value");
    expect_found([](Json& plan) { plan["value"] = nullptr; }, "value:      stated -inf", "value");
    expect_found([](Json& plan) { plan["bound"] = nullptr; }, "bound:      stated inf", "bound");
}

TEST_F(Verify, NoticesEditedPoses) {
    expect_found([](Json& plan) { plan["poses"][0]["joints"]["q1_rad"] = 0.5; },
                 "are not the candidate's", "poses");
    expect_found([](Json& plan) { plan["poses"][0]["times"] = 2; },
                 "is taken 2 times, at most 1 are allowed", "poses");
    expect_found([](Json& plan) { plan["poses"].erase(7); }, "stated 10, are 9", "poses");
    expect_found([](Json& plan) { plan["poses"][0]["id"] = "0"; },
                 "'0' is excluded or measured already", "poses");
    expect_found([](Json& plan) { plan["poses"][0]["times"] = 1000000000000; }, "is taken",
                 "poses");
    expect_found(
        [](Json& plan) {
            plan["poses"][0]["visible_targets"] = {1, 2};
        },
        "are not the candidate's", "poses");
    Json plan = Json::parse(text_of("p.json"));
    plan["poses"][0]["visible_targets"] = {1, 7};
    write_text("e.json", plan.dump());
    expect_input_error("verify e.json", "poses[0].visible_targets[1]: is 7, the campaign has 3");
    plan = Json::parse(text_of("p.json"));
    plan["poses"][2]["id"] = "ghost";
    write_text("e.json", plan.dump());
    expect_input_error("verify e.json", "e.json: poses[2].id: 'ghost' is not among the candidates");
    plan["poses"][2] = plan["poses"][1];
    write_text("e.json", plan.dump());
    expect_input_error("verify e.json", "must be another than that of poses[1]");
}

TEST_F(Verify, NoticesEditedAssumptions) {
    expect_found([](Json& plan) { plan["assumes"]["sigma_m"] = 1e-5; },
                 "assumes:    sigma_m: stated 1e-05, is 5.2e-05", "assumes");
    expect_found([](Json& plan) { plan["assumes"]["expected_error"].erase("Tx1_m"); },
                 "parameters: planned for 32, the campaign has 33 now", "parameters");
    expect_found([](Json& plan) { plan["assumes"]["expected_error"]["Tx1_m"] = 0.002; },
                 "assumes:    expected_error/Tx1_m: stated 0.002, is 0.001", "assumes");
    expect_found([](Json& plan) { plan["assumes"]["wind"] = 3; }, "wind: stated 3, is not assumed",
                 "assumes");
}

TEST_F(Verify, RefusesWhatIsMissingOrOutOfRange) {
    Json plan = Json::parse(text_of("p.json"));
    plan["problem"]["least_distance_rad"] = -1;
    write_text("e.json", plan.dump());
    expect_input_error("verify e.json", "problem.least_distance_rad: is -1; must be at least 0");
    plan = Json::parse(text_of("p.json"));
    plan["poses"][3].erase("times");
    write_text("e.json", plan.dump());
    expect_input_error("verify e.json", "poses[3].times: is missing");
}

TEST_F(Verify, ChecksPosePlans) {
    const std::string quick = " --pool 500 --starts 1 --workspace-poses 50 ";
    run_well("plan " + fanuc_design + " -k 8" + quick + "-o q.json --workspace-target 2");
    const std::string text = run_well("verify q.json");
    EXPECT_NE(text.find("poses:      8, all feasible"), std::string::npos) << text;
    EXPECT_NE(text.find("value:      as stated, "), std::string::npos);
    EXPECT_NE(text.find("RMS/mm:     as stated, "), std::string::npos);
    const Json sound = Json::parse(text_of("q.json"));
    const auto expect_wrong = [&](const std::function<void(Json&)>& edit,
                                  const std::string& words) {
        Json plan = sound;
        edit(plan);
        write_text("e.json", plan.dump());
        const Outcome outcome = run("verify e.json");
        EXPECT_EQ(outcome.code, 1) << words;
        EXPECT_NE((outcome.out + outcome.err).find(words), std::string::npos)
            << outcome.out << outcome.err;
    };
    expect_wrong([](Json& plan) { plan["value"] = plan["value"].get<double>() * 1.001; },
                 "value:      stated");
    expect_wrong(
        [](Json& plan) {
            plan["poses"][1]["joints"]["q2_rad"] = 1e6;
            plan["poses"][1].erase("readable");
        },
        "is beyond the joint limits");
    expect_wrong([](Json& plan) { plan["poses"][1]["readable"]["q2_deg"] = 12.5; },
                 "e.json: poses[1].readable.q2_deg: is 12.5; must be ");
    expect_wrong([](Json& plan) { plan["poses"][1]["readable"].erase("q2_deg"); }, "readable");
    expect_wrong([](Json& plan) { plan["poses"][1]["id"] = plan["poses"][0]["id"]; },
                 "must be another than that of poses[0]");
    expect_wrong([](Json& plan) { plan["bounds"]["pool"]["efficiency"] = 0.999; },
                 "pool bound efficiency: stated");
    expect_wrong([](Json& plan) { plan["bounds"]["continuous"]["efficiency"] = 1; },
                 "searched bound efficiency: stated");
    expect_wrong(
        [](Json& plan) {
            plan["bounds"]["pool"]["bound"] = 0.5 * plan["bounds"]["pool"]["value"].get<double>();
            plan["bounds"]["pool"]["efficiency"] = 1;
        },
        "pool bound: stated");
    expect_wrong([](Json& plan) { plan["poses"][1]["visible_targets"] = Json::array(); },
                 "shows no target");
    expect_wrong([](Json& plan) { plan["poses"][1]["visible_targets"] = {1}; },
                 "value:      stated");
    expect_wrong([](Json& plan) { plan["predicted"]["standard_deviation"]["base.x_m"] = 1e-9; },
                 "deviations: of base.x_m: stated 1e-09, is ");
    expect_wrong([](Json& plan) { plan["predicted"]["standard_deviation"].erase("Tx1_m"); },
                 "deviations: of Tx1_m: stated none, is ");
    expect_wrong([](Json& plan) { plan["campaign"] = "another"; },
                 "e.json: campaign: is 'another'; must be a plan of ");
    expect_wrong([](Json& plan) { plan["assumes"]["model_error_m"] = 1; },
                 "model_error_m: stated 1");
    EXPECT_EQ(run("verify q.json --groups g.csv").code, 2);
}

TEST_F(Verify, NoticesAChangedCandidateFile) {
    run_well("simulate " + fanuc_design + " --truth 8 --seed 3 --poses 40 -o s.csv");
    const Outcome outcome = run("verify p.json");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.out.find("changed since the plan was made"), std::string::npos);
    run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 41 -o s.csv");
    EXPECT_NE(run("verify p.json").out.find("candidates: stated 40, are 41"), std::string::npos);
}

TEST_F(Verify, TakesFilesThatMoved) {
    std::filesystem::rename(folder_ / "s.csv", folder_ / "moved.csv");
    expect_input_error("verify p.json", "s.csv");
    run_well("verify p.json -m moved.csv");
    run_well("verify p.json --campaign " + fanuc_design + " --measurements moved.csv");
}

TEST_F(Verify, RefusesFilesThePlanHasNoneOf) {
    run_well("select " + fanuc_design + " --random 40 -k 8 --prior --starts 1 -o c.json");
    const Outcome random = run("verify c.json -m s.csv");
    EXPECT_EQ(random.code, 2);
    EXPECT_NE(random.err.find("PLAN: is a choice from random configurations, which takes no "
                              "--candidates"),
              std::string::npos)
        << random.err;
    write_text("b.csv", "1,0\n0,1\n1,1\n1,-1\n2,1\n1,2\n");
    run_well("select --blocks b.csv --rows 1 -k 3 -o b.json");
    const Outcome plain = run("verify b.json --campaign " + fanuc_design);
    EXPECT_EQ(plain.code, 2);
    EXPECT_NE(plain.err.find("PLAN: is a choice from plain blocks, which takes no --campaign"),
              std::string::npos)
        << plain.err;
}

TEST_F(Verify, OfPlainBlocksTakesNoLeastDistance) {
    write_text("b.csv", "1,0\n0,1\n1,1\n1,-1\n2,1\n1,2\n");
    run_well("select --blocks b.csv --rows 1 -k 3 -o b.json");
    Json plan = Json::parse(text_of("b.json"));
    plan["problem"]["least_distance_rad"] = 0.1;
    write_text("b.json", plan.dump());
    const Outcome outcome = run("verify b.json");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("candidates without joints have no least distance"),
              std::string::npos)
        << outcome.err;
}

TEST_F(Verify, FindsAnOptimumAgain) {
    run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 16 -o few.csv");
    run_well("select " + fanuc_design + " -m few.csv -k 8 --starts 3 --exclude 0,1 -o o.json");
    EXPECT_NE(run_well("verify o.json").find("proof:      repeated"), std::string::npos);
    Json plan = Json::parse(text_of("o.json"));
    plan["search"]["tried"] = 1000 + plan["search"]["tried"].get<int>();
    write_text("o.json", plan.dump());
    EXPECT_NE(run("verify o.json").err.find("not as stated: tried"), std::string::npos);
}

TEST_F(Verify, RefusesWhatIsNoPlan) {
    write_text("no.json", "{\"kind\": \"posewise plan\", \"format\": 2}");
    expect_input_error("verify no.json", "no.json: poses");
    expect_input_error("verify s.csv", "s.csv");
    expect_input_error("verify absent.json", "absent.json");
}

TEST_F(Verify, RefusesAnotherFormat) {
    Json plan = Json::parse(text_of("p.json"));
    EXPECT_EQ(plan["format"], 2);
    plan["format"] = 3;
    write_text("e.json", plan.dump());
    expect_input_error("verify e.json",
                       "e.json: format: is 3; this posewise reads 2: make the plan again with it");
}

/// What is read through a pipe cannot be read twice: the second time it is empty or waits.
TEST_F(Verify, ParsesThePlanOnce) {
    run_well("select " + fanuc_design + " --random 40 -k 8 --prior --starts 1 -o c.json");
    const std::string quick = " --pool 500 --starts 1 --workspace-poses 50 ";
    run_well("plan " + fanuc_design + " -k 8" + quick + "-o q.json");
    for (const std::string name : {"c.json", "q.json"}) {
        const std::string piped = run_well("verify /dev/stdin --campaign " + fanuc_design,
                                           "cat " + name + " | timeout 60");
        const std::string plain = run_well("verify " + name + " --campaign " + fanuc_design);
        EXPECT_EQ(piped.substr(piped.find('\n')), plain.substr(plain.find('\n'))) << name;
        write_fifo("plan.fifo", name);
        const std::string from_fifo =
            run_well("verify plan.fifo --campaign " + fanuc_design, "timeout 60");
        EXPECT_EQ(from_fifo.substr(from_fifo.find('\n')), plain.substr(plain.find('\n')));
    }
}

TEST_F(Verify, EveryPlanOfTheRepositoryIsAsStated) {
    int count = 0;
    const std::filesystem::path designs = source_folder() + "/designs";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(designs)) {
        if (!entry.path().string().ends_with(".plan.json")) continue;
        run_well("verify '" + entry.path().string() + "'");
        ++count;
    }
    EXPECT_GT(count, 0);
}

}  // namespace
}  // namespace posewise::testing
