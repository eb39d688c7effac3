#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "program.hpp"

namespace posewise {
namespace {

class SimulatedStudies : public testing::Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        study_ = std::string("study '") + source_folder() +
                 "/designs/fanuc_r2000ic_165f/campaign.yaml' --simulate --poses 8,12 --pool 200 "
                 "--test-poses 50 --trials ";
    }
    std::string study_;
};

TEST_F(SimulatedStudies, AreTheSameFromStoresAndShards) {
    const std::string whole = run_well(study_ + "12 --csv whole.csv");
    EXPECT_NE(whole.find("12 robots drawn, the same for planned and random"), std::string::npos)
        << whole;
    EXPECT_EQ(run_well(study_ + "12 --threads 1 --store one.sqlite --csv one.csv"), whole);
    EXPECT_EQ(text_of("one.csv"), text_of("whole.csv"));
    for (const std::string shard : {"2", "3", "1"}) {
        run_well(study_ + "12 --store s" + shard + ".sqlite --shard " + shard + "/3");
    }
    EXPECT_EQ(
        run_well("study --merge s1.sqlite s2.sqlite s3.sqlite --store all.sqlite --csv m.csv"),
        whole);
    EXPECT_EQ(text_of("m.csv"), text_of("whole.csv"));
    EXPECT_EQ(run_well("study --from all.sqlite"), whole);
    const auto json = nlohmann::json::parse(run_well("study --from all.sqlite --json"));
    EXPECT_EQ(json["simulated"], true);
    EXPECT_EQ(json["models"][0]["trials"], 12);
    EXPECT_FALSE(has_file("all.sqlite-wal"));
}

TEST_F(SimulatedStudies, OfMoreShardsThanTrialsEndWell) {
    const std::string whole = run_well(study_ + "2");
    run_well(study_ + "2 --store s1.sqlite --shard 1/3");
    run_well(study_ + "2 --store s2.sqlite --shard 2/3");
    const testing::Outcome outcome = run(study_ + "2 --store s3.sqlite --shard 3/3");
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.out, "");
    EXPECT_NE(outcome.err.find("no split is finished by this shard"), std::string::npos);
    EXPECT_EQ(run_well("study --merge s1.sqlite s2.sqlite --store all.sqlite"), whole);
}

TEST_F(SimulatedStudies, SayWhatTooFewRobotsDoNotTell) {
    const testing::Outcome one = run(study_ + "1");
    EXPECT_NE(one.out.find("planned against random: within chance at 8, 12"), std::string::npos)
        << one.out;
    EXPECT_EQ(one.err, "");
    const testing::Outcome few = run(study_ + "4 --precision 0.1%");
    EXPECT_NE(few.err.find("not as precise as asked (--precision) after 4 robots"),
              std::string::npos)
        << few.err;
}

TEST_F(SimulatedStudies, GoOnAfterTheyWereKilled) {
    const std::string whole = run_well(study_ + "150 --csv whole.csv");
    int killed = 0;
    for (int i = 0; i < 6; ++i) {
        const std::string seconds = "0." + std::to_string(2 + i);
        const testing::Outcome outcome =
            run_line("timeout -s KILL " + seconds + " '" + program_path() + "' " + study_ +
                     "150 --threads 1 --store s.sqlite > .out 2> .err");
        if (outcome.code != 0) ++killed;
    }
    EXPECT_GT(killed, 0);
    EXPECT_EQ(run_well(study_ + "150 --store s.sqlite --csv again.csv"), whole);
    EXPECT_EQ(text_of("again.csv"), text_of("whole.csv"));
}

TEST_F(SimulatedStudies, AreOfTheRobotThatAnEarlierCalibrationFound) {
    run_well("simulate " + testing::fanuc_design + " --poses 60 --truth 3 -o m.csv");
    run_well("calibrate " + testing::fanuc_design + " -m m.csv -o e.json --folds 0");
    const auto planned_rms = [this](const std::string& options) {
        const auto json =
            nlohmann::json::parse(run_well(study_ + "20 --store s.sqlite --json " + options));
        return json["models"][0]["rows"][0]["planned"][0]["held_out_rms_mm"].get<double>();
    };
    const double population = planned_rms("");
    const double same_kind = planned_rms("--from e.json");
    const double same_robot = planned_rms("--from e.json --as-prior");
    const double only_base = planned_rms("--from e.json --only base,targets --moved base");
    EXPECT_NE(same_kind, population);
    EXPECT_LT(same_robot, 0.8 * same_kind);
    EXPECT_LT(only_base, 0.8 * same_kind);
    EXPECT_NE(only_base, same_robot);
    // Studies of different knowledge are different studies of the store.
    EXPECT_EQ(planned_rms("--from e.json --as-prior"), same_robot);
    const std::string varied =
        run_well(study_ + "3 --from e.json --as-prior --vary sensor.sigma_mm=0.01,0.2");
    EXPECT_NE(varied.find("e.json"), std::string::npos) << varied;
    expect_input_error(study_ + "3 --from e.json --vary robot.errors=geometric",
                       "--vary robot.errors=geometric: e.json");
    expect_input_error(study_ + "3 --from absent.json", "absent.json");
    EXPECT_EQ(run(study_ + "3 --from e.json --truth " + testing::fanuc_design).code, 2);
}

TEST_F(SimulatedStudies, VaryKeysOfTheCampaign) {
    const std::string text =
        run_well(study_ + "5 --vary sensor.sigma_mm=0.01,0.2 --vary seed=1 --csv r.csv");
    EXPECT_NE(text.find("sensor.sigma_mm=0.2 seed=1"), std::string::npos) << text;
    const std::string csv = text_of("r.csv");
    EXPECT_EQ(csv.rfind("variation,poses,", 0), 0u) << csv;
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 2 * 2 * 5);
    expect_input_error(study_ + "5 --vary sensor.sigma=1", "--vary sensor.sigma=1: ");
    expect_input_error(study_ + "5 --vary sensor.sigma_mm",
                       "must be like sensor.sigma_mm=0.01,0.05");
    expect_input_error(study_ + "5 --vary name.first=a", "nothing stands under 'first'");
}

TEST_F(SimulatedStudies, AreInTheOrderOfTheirVariationsInAStoreToo) {
    const std::string varied = study_ + "3 --vary sensor.sigma_mm=0.2,0.05,0.1 --store s.sqlite";
    const std::string text = run_well(varied);
    EXPECT_EQ(run_well("study --from s.sqlite"), text);
    const std::string kept = text_of("s.sqlite");
    run_well("study --merge s.sqlite --store all.sqlite");
    EXPECT_EQ(run_well("study --from all.sqlite"), text);
    for (const char* const output : {"--csv", "--plot", "--report"}) {
        const std::string to_store = std::string(output) + " ./s.svg";
        run_line("cd '" + folder_.string() + "' && cp s.sqlite s.svg");
        expect_input_error("study --from s.svg " + to_store, "is read and shall be written");
        expect_input_error("study --from s.sqlite " + to_store, "is a store of trials");
        EXPECT_EQ(text_of("s.svg"), kept);
    }
    const testing::Outcome outcome = run("study --from s.sqlite --poses 8");
    EXPECT_EQ(outcome.code, 2);
    EXPECT_NE(outcome.err.find("--poses: is not looked at"), std::string::npos) << outcome.err;
    expect_input_error("study --from absent.sqlite", "absent.sqlite: is not there");
    write_text("text.txt", "no store");
    expect_input_error("study --from text.txt", "text.txt: is no store of trials");
}

TEST_F(SimulatedStudies, AreNotReplacedByWhatIsWrittenBesideTheirStores) {
    run_well(study_ + "3 --store s.sqlite");
    for (const std::string end : {"-wal", "-shm", "-lock"}) {
        const std::string words = "s.sqlite" + end + ": belongs to a store of trials";
        expect_input_error("study --from s.sqlite --csv s.sqlite" + end, words);
        expect_input_error(study_ + "3 --store new.sqlite --csv new.sqlite" + end, "belongs to");
        expect_input_error("plan " + testing::fanuc_design + " -k 12 -o s.sqlite" + end, words);
    }
    EXPECT_FALSE(has_file("new.sqlite"));
}

TEST_F(SimulatedStudies, RefuseVariationsThatAreNone) {
    expect_input_error(study_ + "3 --vary criterion=v,d", "are the same study");
    expect_input_error(study_ + "3 --vary sensor.sigma_mm=0.1 --vary sensor.sigma_mm=0.2",
                       "is varied twice");
    expect_input_error(study_ + "3 --vary sensor.sigma_mm=0.1..0.2", "--points");
    expect_input_error(study_ + "3 --points 4", "no range is varied");
}

TEST_F(SimulatedStudies, KeepMeasuredOnesToo) {
    const std::string campaign =
        "'" + source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml' ";
    run_well("simulate " + campaign + "--poses 14 --out m.csv");
    const std::string study =
        "study " + campaign +
        "-m m.csv --poses 6,9 --random 6 --splits 2 --models stated,geometric ";
    const std::string whole = run_well(study + "--csv whole.csv");
    EXPECT_EQ(run_well(study + "--store s.sqlite"), whole);
    EXPECT_EQ(run_well(study + "--store s.sqlite --csv again.csv"), whole);
    EXPECT_EQ(text_of("again.csv"), text_of("whole.csv"));
    EXPECT_NE(run_well("study --from s.sqlite").find("geometric"), std::string::npos);
}

TEST_F(SimulatedStudies, RefuseWhatIsNoStudy) {
    const auto usage = [this](const std::string& arguments, const std::string& words) {
        const testing::Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 2) << arguments;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    };
    const std::string campaign = study_.substr(6, study_.find("' ") - 4);
    usage("study", "CAMPAIGN");
    usage("study " + campaign, "measured configurations (-m), --simulate or --blocks");
    usage("study " + campaign + "--trials 5 -m m.csv", "--simulate");
    usage(study_ + "5 -m m.csv", "leave one out");
    usage(study_ + "5 --shard 1/2", "--store");
    for (const std::string shard : {"3/2", "0/2", "1", "/", "a/b", "1/0"}) {
        usage(study_ + "5 --store s.sqlite --shard " + shard, "from 1/16 to 16/16");
    }
    for (const std::string precision : {"0", "100%", "-1", "%", "x"}) {
        usage(study_ + "5 --precision " + precision, "must be a part such as 2% or 0.02");
    }
    usage(study_ + "5 --exclude 3", "--exclude: is of measured configurations");
    usage(study_ + "5 --splits 3", "--splits: is of measured configurations");
    usage(study_ + "0", "--trials");
    usage(study_ + "5 --time 0", "--time");
    write_text("text.sqlite", "no database");
    expect_input_error(study_ + "5 --store text.sqlite", "text.sqlite");
    EXPECT_EQ(text_of("text.sqlite"), "no database");
    expect_input_error("study --merge none.sqlite --store all.sqlite", "none.sqlite");
    expect_input_error(study_ + "5 --store none/s.sqlite", "none/s.sqlite");
    expect_input_error("study " + campaign + " --simulate --poses 300 --pool 200", "200");
}

}  // namespace
}  // namespace posewise
