#include "program.hpp"

/// A ball in sockets at unknown places, through every command.
namespace posewise::testing {
namespace {

const std::string arm = "name: arm\nrobot:\n" + six_joints;

const std::string sockets = R"(sensor:
  kind: sockets
  sigma_mm: 0.1
  targets: {position_mm: [[60, 40, 90]]}
  sockets:
    - {name: s0, position_mm: [450, 100, 200]}
    - {name: s1, from: s0, distance_mm: 120, position_mm: [450, 220, 200]}
    - {name: s2, position_mm: [200, -420, 150]}
    - {name: s3, position_mm: [350, 300, 500]}
)";

const std::string panda = R"(name: Panda
robot:
  errors: ERRORS
  joints: {q1: {limits_rad: [-2.9, 2.9]}, q2: {limits_rad: [-1.77, 1.77]}, q3: {limits_rad: [-2.9, 2.9]},
    q4: {limits_rad: [-3.08, -0.06]}, q5: {limits_rad: [-2.9, 2.9]}, q6: {limits_rad: [-0.02, 3.76]},
    q7: {limits_rad: [-2.9, 2.9]}}
  elements: [Rz q1, Tz 333 mm, Rx -90 deg, Rz q2, Rx 90 deg, Rz q3, Tz 316 mm, Rx 90 deg, Tx 82.5 mm, Rz q4,
    Rx -90 deg, Tx -82.5 mm, Rz q5, Tz 384 mm, Rx 90 deg, Rz q6, Rx 90 deg, Tx 88 mm, Rz q7, Tz 107 mm]
sensor:
  kind: sockets
  sigma_mm: 0.1
  targets: {count: 1}
  sockets:
)";

class Sockets : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_text("c.yaml", arm + sockets);
    }
    void expect_refused(const std::string& part, const std::string& by, const std::string& command,
                        const std::string& words) const {
        std::string text = arm + sockets;
        ASSERT_NE(text.find(part), std::string::npos) << part;
        write_text("bad.yaml", text.replace(text.find(part), part.size(), by));
        expect_input_error(command, words);
    }
};

TEST_F(Sockets, CalibrateARobotWithoutAnInstrument) {
    run_well("simulate c.yaml --poses 80 -o m.csv");
    EXPECT_NE(text_of("m.csv").find(",q6_rad,socket\n"), std::string::npos);
    const std::string text = run_well("calibrate c.yaml -m m.csv -o e.json");
    EXPECT_EQ(text.find("missing"), std::string::npos) << text;
    EXPECT_NEAR(number_behind(text, "variance factor"), 1, 0.25);
    EXPECT_LT(number_behind(text, "distance RMS", 1), 0.4);
    EXPECT_GT(number_behind(text, "distance RMS", 0), 0.4);
    EXPECT_EQ(text_of("e.json").find("\"dq1\""), std::string::npos);  // it turns the whole only
    // Where all is may be left open.
    std::string open = arm + sockets;
    for (const char* const place :
         {", position_mm: [450, 100, 200]", ", position_mm: [450, 220, 200]",
          ", position_mm: [200, -420, 150]", ", position_mm: [350, 300, 500]"}) {
        open.erase(open.find(place), std::string(place).size());
    }
    open.replace(open.find("position_mm: [[60, 40, 90]]"), 27, "count: 1");
    write_text("open.yaml", open);
    const std::string same = run_well("calibrate open.yaml -m m.csv");
    EXPECT_NEAR(number_behind(same, "distance RMS", 1), number_behind(text, "distance RMS", 1),
                2e-4);
    expect_input_error("plan open.yaml -k 20", "position_mm of sensor.targets and of each");
    expect_input_error("simulate open.yaml --poses 5 -o no.csv", "must state where");
}

TEST_F(Sockets, ArePlannedFor) {
    const std::string text = run_well(
        "plan c.yaml -k 16 --pool 300 --workspace-poses 40 --starts 1 -o p.json --csv p.csv");
    EXPECT_NE(text.find("socket"), std::string::npos) << text;
    expect_input_error("plan c.yaml -k 16 --verify",
                       "robots that touch sockets cannot be simulated");
    EXPECT_EQ(run("verify p.json").code, 0);
    run_well("simulate c.yaml --configurations p.csv -o m.csv");
    run_well("calibrate c.yaml -m m.csv -o e.json");
    run_well("calibrate c.yaml -m m.csv --plan p.json");
    std::string hand = text_of("p.json");
    const auto begin = hand.find("\"visible_targets\": [") + 20;
    write_text("none.json", hand.erase(begin, hand.find(']', begin) - begin));
    expect_input_error("verify none.json", "visible_targets: is empty");
    write_text("off.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,socket\n0,0,80,0,0,0,0,s0\n");
    expect_input_error("simulate c.yaml --configurations off.csv -o no.csv", "does not reach s0");
    run_well(
        "plan c.yaml -k 10 --pool 300 --workspace-poses 40 --starts 1 --from e.json -o next.json");
}

TEST_F(Sockets, AreChosenAndStudied) {
    run_well("simulate c.yaml --poses 90 -o m.csv");
    run_well("select c.yaml -m m.csv -k 12 --starts 2 --proof 0.1 -o s.json");
    EXPECT_EQ(run("verify s.json").code, 0);
    run_well("indices c.yaml -m m.csv");
    run_well("inspect c.yaml -m m.csv");
    run_well("select c.yaml --random 60 -k 12 --starts 2 --proof 0.1 -o r.json");
    EXPECT_EQ(run("verify r.json").code, 0);
    EXPECT_NE(run_well("study c.yaml -m m.csv -k 30 --splits 2 --random 4").find("held out"),
              std::string::npos);
}

TEST_F(Sockets, ThatCannotBeAreNamed) {
    run_well("simulate c.yaml --poses 40 -o m.csv");
    expect_refused("sensor:", "base: {position_mm: [0, 0, 0], rpy_deg: [0, 0, 0]}\nsensor:",
                   "calibrate bad.yaml -m m.csv", "must be left out");
    expect_refused("- {name: s3", "- {name: s9, position_mm: [0, 0, 0]}\n    - {name: s3",
                   "calibrate bad.yaml -m m.csv", "'s9' is not touched in these 40 configurations");
    expect_refused("name: s3", "name: slot3", "calibrate bad.yaml -m m.csv",
                   "socket is 's3'; did you mean 's0'?");
    expect_refused("[350, 300, 500]", "[3500, 300, 500]", "simulate bad.yaml --poses 5 -o no.csv",
                   "puts the ball into s3");
    write_text("none.csv", "config,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad\n0,0,0,0,0,0,0\n");
    expect_input_error("calibrate c.yaml -m none.csv", "missing column socket");
    expect_input_error("select c.yaml --candidates none.csv -k 1", "missing column socket");
    expect_input_error("simulate c.yaml --poses 5 --repeats 2 -o no.csv", "repeats must be 1");
}

TEST_F(Sockets, WithoutALengthOrWithAWrongOneAreNamed) {
    run_well("simulate c.yaml --poses 80 -o m.csv");
    EXPECT_EQ(run("calibrate c.yaml -m m.csv --folds 0").err, "");
    const std::string distance = ", from: s0, distance_mm: 120";
    std::string text = arm + sockets;
    write_text("none.yaml", text.erase(text.find(distance), distance.size()));
    EXPECT_NE(run("calibrate none.yaml -m m.csv --folds 0").err.find("no length is stated"),
              std::string::npos);
    text = arm + sockets;
    write_text("wrong.yaml", text.replace(text.find("120,"), 3, "140"));
    const std::string err =
        run("calibrate wrong.yaml -m m.csv --folds 0 --force -o wrong.json").err;
    const auto said = err.find("socket 's1' is stated 140 mm from 's0', measured at about ");
    ASSERT_NE(said, std::string::npos) << err;
    EXPECT_NEAR(std::stod(err.substr(err.find("about ", said) + 6)), 120, 1);
    EXPECT_NE(text_of("wrong.json").find("\"measured_mm\": 1"), std::string::npos);
}

TEST_F(Sockets, AreWhereTheyAreSaidToBe) {
    run_well("simulate c.yaml --poses 80 -o m.csv");
    const std::string found = run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    const std::string at = found.substr(found.find("Sockets at a known distance"));
    EXPECT_NEAR(number_behind(at, "s1", 0), 450, 3);
    EXPECT_NEAR(number_behind(at, "s1", 1), 220, 3);
    // A calibration beside an earlier one, and a plan for it, need one pose.
    run_well(
        "plan c.yaml --from e.json --as-prior -k 1 --pool 60 --workspace-poses 20 --starts 1 "
        "-o one.json");
    std::istringstream lines(text_of("m.csv"));
    std::string one;
    int rows = 0;
    for (std::string line; std::getline(lines, line) && rows < 2;) {
        if (line[0] == '#') continue;
        one += line + '\n';
        ++rows;
    }
    write_text("one.csv", one);
    run_well("calibrate c.yaml -m one.csv --from e.json --as-prior --folds 0");
    // Sockets are named in tables of outliers.
    run_well("simulate c.yaml --poses 40 --seed 3 -o more.csv");
    const std::string robust = run_well("calibrate c.yaml -m more.csv --folds 0 --loss cauchy");
    EXPECT_EQ(robust.find("configuration  target"), std::string::npos) << robust;
}

TEST_F(Sockets, ThatArePlannedButNotTouchedAreNamed) {
    std::string far = "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,socket\n";
    for (const char* const id : {"1", "2", "3", "4", "5", "6"}) {
        far += std::string(id) + ",0,80,0,0,0," + id + ",s0\n";
    }
    write_text("far.csv", far);
    expect_input_error("select c.yaml --candidates far.csv -k 5", " mm from s0; must touch it");
    run_well("plan c.yaml -k 16 --pool 200 --workspace-poses 20 --starts 1 -o p.json");
    std::string hand = text_of("p.json");
    const auto begin = hand.find("\"visible_targets\": [") + 20;
    const auto end = hand.find(']', begin);
    const int shown = std::stoi(hand.substr(begin, end - begin));
    write_text("hand.json", hand.replace(begin, end - begin, std::to_string(shown % 4 + 1)));
    const std::string other = "does not touch s" + std::to_string(shown % 4);
    const Outcome outcome = run("verify hand.json");
    EXPECT_NE((outcome.out + outcome.err).find(other), std::string::npos) << outcome.out;
    expect_input_error("plan c.yaml --plan hand.json --drop p5 --pool 200 -o no.json",
                       other + "; find another for it");
}

TEST_F(Sockets, TwoForOneConfigurationAndWhatSeesThemAreRefused) {
    write_text("two.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,socket\n"
               "a,0,80,0,0,0,0,s0\na,0,80,0,0,0,0,s1\n");
    expect_input_error("calibrate c.yaml -m two.csv",
                       "configuration 'a' touches s1 here and s0 before (line 2); must be one");
    run_well("simulate c.yaml --poses 20 -o m.csv");
    write_text("seen.yaml", arm + sockets + "cell: {tracker: {range_mm: [1500, 8000]}}\n");
    expect_input_error("calibrate seen.yaml -m m.csv", "seen by none; must be left out");
}

TEST_F(Sockets, OfARealPandaAreFittedAsIndependently) {
    const std::string data = real_data() + "/panda_sockets/measurements.csv";
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "no real campaign at " << data;
    std::string places;
    for (int k = 0; k < 12; k += 2) {
        const std::string one = "s" + std::to_string(k);
        places += "    - {name: " + one + "}\n    - {name: s" + std::to_string(k + 1) +
                  ", from: " + one + ", distance_mm: 50}\n";
    }
    for (const auto& [errors, fit, held_out] :
         {std::tuple{"geometric", 0.205, 0.216}, std::tuple{"full", 0.151, 0.166}}) {
        std::string campaign = panda + places;
        campaign.replace(campaign.find("ERRORS"), 6, errors);
        write_text("panda.yaml", campaign);
        const Outcome outcome = run("calibrate panda.yaml -m '" + data + "'");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_NEAR(number_behind(outcome.out, "distance RMS", 0), 2.869, 0.05);
        EXPECT_NEAR(number_behind(outcome.out, "distance RMS", 1), fit, 0.001) << errors;
        EXPECT_NEAR(number_behind(outcome.out, "distance RMS", 3), held_out, 0.001) << errors;
    }
}

}  // namespace
}  // namespace posewise::testing
