#include <algorithm>
#include <nlohmann/json.hpp>

#include "program.hpp"

/// `select` from every kind of candidates, with every limit, and what it refuses.
namespace posewise::testing {
namespace {

class Select : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 24 -o s.csv");
        write_blocks("b.csv", 20);
    }

    /// `count` candidates of 2 rows and 3 columns, of full rank and all different.
    void write_blocks(const std::string& name, int count, const std::string& last_row = "") const {
        std::string text = "x,y,z\n";
        for (int row = 0; row < 2 * count; ++row) {
            text += std::to_string(row * 37 % 41 - 20) + ',' + std::to_string(row * 17 % 43 - 21) +
                    ',' + std::to_string(row * 29 % 47 - 23) + '\n';
        }
        write_text(name, text + last_row);
    }

    nlohmann::json plan(const std::string& name) const {
        return nlohmann::json::parse(text_of(name));
    }
    std::vector<std::string> ids_of(const std::string& name) const {
        std::vector<std::string> ids;
        const auto document = plan(name);
        for (const auto& pose : document.at("poses")) ids.push_back(pose.at("id"));
        return ids;
    }

    const std::string input_ = fanuc_design + " -m s.csv ";
    const std::string plain_ = "--blocks b.csv --rows 2 ";
};

TEST_F(Select, ChoosesFromConfigurationsThatWereNotMeasured) {
    write_text("q.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "a,10,20,-30,40,50,60\nb,-20,5,10,80,-60,10\nc,40,-40,-60,-80,90,120\n"
               "d,-70,30,40,-10,30,-200\ne,60,-15,-5,150,-90,20\nf,0,50,-70,-120,70,-100\n");
    run_well("select " + fanuc_design + " --candidates q.csv -k 5");
    EXPECT_EQ(ids_of("q.plan.json").size(), 5U);
    run_well("verify q.plan.json");
}

/// By the pendant's name of the joint or as a sum: the same choice, from those that it allows.
TEST_F(Select, KeepsLimitsOfAControllersJoint) {
    std::string design = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml") +
                         "\ncontroller: {joints: {J3: q3 - q2}}\n";
    const auto chosen = [&](const std::string& sum) {
        write_text("sum.yaml",
                   design + "cell: {joint_sums: {" + sum + ": {limits_deg: [-40, 30]}}}\n");
        run_well("select sum.yaml --random 200 -k 8 --starts 4 -o sum.json");
        run_well("verify sum.json");
        for (const auto& pose : plan("sum.json").at("poses")) {
            const auto& q = pose.at("joints");
            const double third =
                (q.at("q3_rad").get<double>() - q.at("q2_rad").get<double>()) * 57.29577951308232;
            EXPECT_GE(third, -40 - 1e-9);
            EXPECT_LE(third, 30 + 1e-9);
        }
        return ids_of("sum.json");
    };
    EXPECT_EQ(chosen("J3"), chosen("q3 - q2"));
    // Listed candidates that it forbids are not chosen.
    write_text("q.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "a,10,20,-30,40,50,60\nb,-20,5,10,80,-60,10\nc,40,-40,-60,-80,90,120\n"
               "d,-70,30,40,-10,30,-200\ne,60,-15,-5,150,-90,20\nf,0,50,-70,-120,70,-100\n"
               "g,20,10,20,10,60,70\n");
    run("select sum.yaml --candidates q.csv -k 5 -o listed.json");
    EXPECT_EQ(ids_of("listed.json"), (std::vector<std::string>{"b", "c", "d", "e", "g"}));
}

TEST_F(Select, ReadsTheCampaignOnce) {
    const std::string plain = run_well("select " + input_ + "-k 8 --starts 1 -o one.json");
    const std::filesystem::path design =
        source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml";
    write_fifo("campaign.fifo", design.string());
    const std::string piped =
        run_well("select campaign.fifo -m s.csv -k 8 --starts 1 -o one.json", "timeout 60");
    EXPECT_EQ(piped, plain);
}

TEST_F(Select, ChoosesFromRandomConfigurationsTheSameEveryTime) {
    const std::string arguments = "select " + fanuc_design + " --random 200 -k 6 --starts 4 ";
    run_well(arguments + "-o one.json", "OMP_NUM_THREADS=1");
    run_well(arguments + "-o two.json", "OMP_NUM_THREADS=2");
    EXPECT_EQ(text_of("one.json"), text_of("two.json"));
    run_well(arguments + "--seed 5 -o other.json");
    EXPECT_NE(ids_of("one.json"), ids_of("other.json"));
    run_well("verify other.json");
}

TEST_F(Select, NeedsToKnowWhereTheBaseIs) {
    const std::string design =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    std::string text = design;
    text.erase(text.find("base: {"), text.find('\n', text.find("base: {")) - text.find("base: {"));
    write_text("c.yaml", text);
    run_well("select c.yaml --random 50 -k 8 --starts 1");  // nothing depends on it
    const std::string sigma = "sigma_mm: 0.052 ";
    text.replace(text.find(sigma), sigma.size(), "noise: {range_um: 10, angle_urad: 15} ");
    write_text("c.yaml", text);
    expect_input_error("select c.yaml --random 50 -k 8", "states no base");
    run_well("select c.yaml --random 50 -k 8 --augment s.csv");  // registered from these
}

TEST_F(Select, ChoosesFromPlainBlocksWithoutARobot) {
    const std::string text = run_well("select " + plain_ + "-k 4 --criterion a");
    EXPECT_EQ(plan("b.plan.json").at("poses").size(), 4U);
    EXPECT_TRUE(plan("b.plan.json").at("campaign").is_null());
    EXPECT_NE(text.find("proof:      optimal"), std::string::npos) << text;
    EXPECT_EQ(number_behind(text, "efficiency:"), 1);
}

TEST_F(Select, EffortStandsForStartsAndProof) {
    const auto search = [&](const std::string& options) {
        run_well("select " + plain_ + "-k 6 -c v -o p.json " + options);
        return plan("p.json").at("search");
    };
    EXPECT_EQ(search("--effort quick"), search("--starts 1 --proof 0"));
    EXPECT_EQ(search("--effort usual"), search(""));
    EXPECT_EQ(search("--effort thorough"), search("--starts 40 --proof 20"));
    for (const char* const wrong : {"--effort quick --starts 3", "--effort hard"}) {
        EXPECT_EQ(run("select " + plain_ + "-k 6 " + wrong).code, 2) << wrong;
    }
    const std::string fanuc = "plan " + fanuc_design + " -k 14 --pool 200 --workspace-poses 20 -o ";
    run_well(fanuc + "quick.json --effort quick");
    run_well(fanuc + "one.json --starts 1");
    EXPECT_EQ(plan("quick.json").at("search"), plan("one.json").at("search"));
    EXPECT_EQ(plan("quick.json").at("poses"), plan("one.json").at("poses"));
}

TEST_F(Select, SaysThatTheBoundIsLooseAtFewPoses) {
    const std::string text = run_well("select " + fanuc_design + " --random 200 -k 5");
    EXPECT_LT(number_behind(text, "efficiency:"), 0.9);
    EXPECT_NE(text.find("the bound is loose at so few poses: "), std::string::npos) << text;
    EXPECT_NE(text.find(" independent starts ended at this value"), std::string::npos);
}

/// 39 rows of 7 numbers: two blocks of three have six rows.
TEST_F(Select, RefusesFewerRowsThanParametersAndVerifyDoes) {
    std::string text;
    for (int row = 0; row < 39; ++row) {
        for (int column = 0; column < 7; ++column) {
            text += std::to_string((row + 3) * (column + 5) * 37 % 101 - 50) +
                    (column < 6 ? ',' : '\n');
        }
    }
    write_text("few.csv", text);
    const std::string few = "--blocks few.csv --rows 3 ";
    for (const std::string criterion : {"d", "e", "v", "o2"}) {
        for (const std::string relax : {"", " --relax -o w.csv"}) {
            expect_input_error("select " + few + "-k 2 -c " + criterion + relax,
                               "few.csv: pose count is 2, must be at least 3: 2 poses have 6 rows, "
                               "fewer than the 7 parameters; or state a prior");
        }
    }
    run_well("select " + few + "-k 3 -o p.json");
    run_well("verify p.json");
    auto edited = plan("p.json");
    edited["poses"].erase(2);
    edited["problem"]["pose_count"] = 2;
    edited["value"] = nullptr;
    write_text("e.json", edited.dump());
    const Outcome outcome = run("verify e.json");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.out.find("value:      stated -inf, but the poses do not identify all "
                               "parameters"),
              std::string::npos)
        << outcome.out;
}

TEST_F(Select, APriorAllowsFewerPosesThanParametersNeed) {
    expect_input_error("select " + input_ + "-k 3 -o p.json", "state a prior");
    run_well("select " + input_ + "-k 3 --prior -o p.json");
    EXPECT_EQ(ids_of("p.json").size(), 3U);
    write_text("c.yaml", read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml") +
                             "\nprior: true\n");
    run_well("select c.yaml -m s.csv -k 3 -o q.json");
    EXPECT_EQ(ids_of("q.json"), ids_of("p.json"));
    expect_input_error("select c.yaml -m s.csv -k 3 --no-prior -o r.json", "state a prior");
    run_well("verify q.json");
}

TEST_F(Select, SaysThatAllCandidatesAreMeasuredAlready) {
    expect_input_error("select " + input_ + "-k 6 --augment s.csv -o p.json",
                       "all 24 candidates are excluded or measured already; must leave at least "
                       "one to choose");
}

TEST_F(Select, FocusOnTheRobotLeavesBaseAndTargetsOut) {
    const std::string all = run_well("select " + input_ + "-k 8");
    const std::string robot = run_well("select " + input_ + "-k 8 --focus robot");
    EXPECT_LT(number_behind(robot, "value:"), number_behind(all, "value:"));
    run_well("verify s.plan.json");
    expect_input_error("select " + input_ + "-k 8 --focus robot -c g -o no.json",
                       "criterion g cannot leave columns out of account (--focus, ");
}

TEST_F(Select, MeasuredPosesAreHeldAndNotChosenAgain) {
    const std::string without = run_well("select " + plain_ + "-k 3");
    const auto taken = ids_of("b.plan.json");
    std::string rows;
    for (const std::string& id : taken) {
        std::istringstream lines(text_of("b.csv"));
        std::string line;
        std::getline(lines, line);
        for (int row = 0; std::getline(lines, line); ++row) {
            if (row / 2 == std::stoi(id)) rows += line + '\n';
        }
    }
    write_text("measured.csv", rows);
    const std::string with = run_well("select " + plain_ + "-k 3 --augment measured.csv -o c.json");
    EXPECT_GT(number_behind(with, "value:"), number_behind(without, "value:"));
    for (const std::string& id : ids_of("c.json")) {
        EXPECT_EQ(std::count(taken.begin(), taken.end(), id), 0) << id;
    }
    run_well("verify c.json");
}

TEST_F(Select, KeepsToExclusionsGroupsRepeatsAndDistances) {
    run_well("select " + plain_ + "-k 4");
    const std::string first = ids_of("b.plan.json").front();
    run_well("select " + plain_ + "-k 4 -o e.json --exclude " + first);
    const auto ids = ids_of("e.json");
    EXPECT_EQ(std::count(ids.begin(), ids.end(), first), 0);
    expect_input_error("select " + plain_ + "-k 4 --exclude 0,99 -o no.json", "'99'");

    std::string groups = "config,group\n";
    for (int i = 0; i < 20; ++i) groups += std::to_string(i) + ',' + (i < 12 ? "A" : "B") + '\n';
    write_text("g.csv", groups);
    run_well("select " + plain_ + "-k 6 --groups g.csv --per-group 3 -o g.json");
    const auto grouped = ids_of("g.json");
    EXPECT_EQ(std::count_if(grouped.begin(), grouped.end(),
                            [](const std::string& id) { return std::stoi(id) < 12; }),
              3);
    run_well("select " + plain_ + "-k 12 --repeat-limit 4 -o r.json");
    int total = 0;
    const auto repeated = plan("r.json");
    for (const auto& pose : repeated.at("poses")) total += pose.at("times").get<int>();
    EXPECT_EQ(total, 12);
    EXPECT_LT(repeated.at("poses").size(), 12U);
    run_well("select " + input_ + "-k 6 --least-distance-deg 60 -o d.json");
    for (const std::string name : {"e.json", "g.json", "r.json", "d.json"}) {
        run_well("verify " + name);
    }
}

TEST_F(Select, PredictsTestPosesWithGAndV) {
    run_well("select " + input_ + "-k 8 -c i --test-poses s.csv -o v.json");
    EXPECT_EQ(plan("v.json").at("criterion"), "v");
    run_well("verify v.json");
    expect_input_error("select " + input_ + "-k 8 -c d --test-poses s.csv -o no.json",
                       "must be g or v");
}

TEST_F(Select, ReturnsTheBestSoFarWhenTimeIsUpOrCtrlCComes) {
    const std::string much = "select " + fanuc_design + " --random 1000 -k 20 --starts 1000000 ";
    const std::string text = run(much + "--time 1 -o t.json").out;  // slow builds say they took 2 s
    EXPECT_NE(text.find("time limit"), std::string::npos) << text;
    run_well("verify t.json");
    const Outcome outcome = run(much + "-o c.json", "timeout -s TERM 3");
    EXPECT_NE(outcome.out.find("interrupted"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.err, "posewise: warning: interrupted; the plan is the best so far\n");
    EXPECT_EQ(plan("c.json").at("search").at("stop_reason"), "interrupted");
    run_well("verify c.json");
}

TEST_F(Select, AnotherCtrlCEndsItAndSaysThatNothingWasWritten) {
    // Nobody writes to the pipe: the first wish waits.
    const auto files = file_count();
    const Outcome outcome = run("select " + fanuc_design + " -m m.fifo -k 8 -o c.json",
                                "mkfifo m.fifo && sh -c '\"$0\" \"$@\" & "
                                "while sleep 1 && kill -INT $! 2> /dev/null; do :; done; wait $!'");
    EXPECT_NE(outcome.code, 0);
    EXPECT_EQ(outcome.err, "posewise: interrupted twice; nothing was written\n");
    EXPECT_EQ(file_count(), files + 1);  // the pipe
}

TEST_F(Select, NamesTheDirectionThatNoCandidateSees) {
    expect_input_error("select " + seed_design + " -m s.csv -k 12",
                       "(0.61 Tx2 - 0.56 dq2 + 0.56 dq3)");
    write_text("flat.csv", "1,2,2\n3,5,5\n-1,4,4\n2,2,2\n");
    expect_input_error("select --blocks flat.csv --rows 1 -k 3", "(0.71 column 2 - 0.71 column 3)");
}

TEST_F(Select, RefusesCandidatesBeyondTheLimits) {
    write_text("q.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\na,10,20,-30,40,50,60\n"
               "far,-20,5,10,80,-60,2000\n");
    const std::string words =
        "q.csv: configuration 'far' is beyond the joint limits: q6 is 2000 deg, must be from -";
    expect_input_error("select " + fanuc_design + " --candidates q.csv -k 5", words);
    expect_input_error("select " + input_ + "-k 8 -c v --test-poses q.csv", words);
    expect_input_error("simulate " + fanuc_design + " --configurations q.csv -o x.csv", words);
    expect_input_error("plan " + fanuc_design + " -k 12 --workspace q.csv", words);
}

TEST_F(Select, WarnsAboutMeasuredPosesBeyondTheLimits) {
    const std::string design =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    std::string text = design;
    const auto limits = text.find("q1: {limits_deg: [");
    text.replace(limits, text.find('}', limits) - limits, "q1: {limits_deg: [-20, 20]");
    write_text("narrow.yaml", text);
    const Outcome outcome = run("select narrow.yaml -m s.csv -k 8");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("posewise: warning: s.csv: "), 0U) << outcome.err;
    EXPECT_NE(outcome.err.find("of 24 configurations are beyond"), std::string::npos);
    EXPECT_NE(outcome.err.find("must be from -20 to 20 deg\n"), std::string::npos) << outcome.err;
}

TEST_F(Select, RefusesMeasurementsOfAnotherRobot) {
    std::string other = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const std::string length = "Tz 1075 mm";
    write_text("other.yaml", other.replace(other.find(length), length.size(), "Tz 600 mm"));
    run_well("simulate other.yaml -k 16 -o other.csv");
    const std::string words = "other.csv: are these of another robot? The nominal robot misses";
    expect_input_error("select " + fanuc_design + " -m other.csv -k 8", words);
    expect_input_error("select " + fanuc_design + " -m s.csv --augment other.csv -k 8", words);
    expect_input_error("study " + fanuc_design + " -m other.csv", words);
    const Outcome calibrated = run("calibrate " + fanuc_design + " -m other.csv");
    EXPECT_EQ(calibrated.code, 3);
    EXPECT_EQ(calibrated.err.find("posewise: warning: " + words), 0U) << calibrated.err;
    // A robot that may be far from nominal, as its campaign says, is no other.
    write_text("rough.yaml", other.replace(other.find("length_mm: 1,"), 13, "length_mm: 300,"));
    const Outcome outcome = run("select rough.yaml -m s.csv -k 8");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.err.find("another robot"), std::string::npos) << outcome.err;
}

TEST_F(Select, SuspectsTheUnitOfMeasurements) {
    const auto renamed = [&](const std::string& from, const std::string& to) {
        std::string text = text_of("s.csv");
        for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at)) {
            text.replace(at, from.size(), to);
        }
        write_text("wrong.csv", text);
        return "select " + fanuc_design + " -m wrong.csv -k 8";
    };
    expect_input_error(renamed("_mm", "_m"), "with points in mm where the file says m (");
    expect_input_error(renamed("_rad", "_deg"),
                       "with joint values in rad where the file says degrees (");
}

TEST_F(Select, RefusesMoreCandidatesThanMemoryHolds) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer itself needs more address space";
#endif
    const Outcome outcome =
        run("select " + fanuc_design + " --random 10000000 -k 8 -o x.json", "ulimit -v 8000000 &&");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find(" GB; lower --random\n"), std::string::npos) << outcome.err;
    EXPECT_FALSE(has_file("x.json"));
}

TEST_F(Select, StopsDrawingWhenTimeIsUp) {
    const Outcome outcome =
        run("select " + fanuc_design + " --random 300000 -k 20 --time 0.1 -o t.json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.err.find(" of the 300000 random candidates were drawn"), std::string::npos)
        << outcome.err;
    EXPECT_LT(plan("t.json").at("candidates").at("count"), 300000);
    run_well("verify t.json");
}

TEST_F(Select, RefusesUnusableBlocks) {
    write_blocks("odd.csv", 5, "1,2,3\n");
    for (const std::string relax : {"", " --relax"}) {
        write_text("huge.csv", "1e160\n2\n3\n");
        expect_input_error(
            "select --blocks huge.csv --rows 1 -k 2" + relax,
            "huge.csv: row 1, column 1 of the matrix is 1e+160; must be finite, at most "
            "1e+50 in magnitude");
        write_text("tiny.csv", "1,1e-160\n2,2e-160\n3,-3e-160\n");
        expect_input_error("select --blocks tiny.csv --rows 1 -k 2" + relax,
                           "tiny.csv: column 2 of the matrix is at most 3e-160 in magnitude");
    }
    expect_input_error("select " + input_ + "-k 8 --exclude 99",
                       "s.csv: excluded candidate '99' is not among the candidates; must be the "
                       "id of one");
    expect_input_error("select --blocks odd.csv --rows 2 -k 3",
                       "odd.csv: matrix has 11 rows, not a multiple of 2");
    write_blocks("nan.csv", 5, "1,nan,3\n1,2,3\n");
    expect_input_error("select --blocks nan.csv --rows 2 -k 3", "nan.csv:12:3: 'nan'");
    write_blocks("text.csv", 5, "1,2,three\n1,2,3\n");
    expect_input_error("select --blocks text.csv --rows 2 -k 3", "text.csv:12:5: 'three'");
    expect_input_error("select " + plain_ + "-k 21", "must be from 1 to 20");
    expect_input_error("select " + plain_ + "-k 1", "state a prior");
    expect_input_error("select --blocks absent.csv --rows 2 -k 1", "absent.csv");
}

}  // namespace
}  // namespace posewise::testing
