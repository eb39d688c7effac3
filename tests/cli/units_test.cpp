#include "program.hpp"

/// Units that cannot be, and places that are not where they are stated: each with the unit that
/// would fit.
namespace posewise::testing {
namespace {

const std::string arm = "name: arm\nrobot:\n  errors: geometric\n" + six_joints;
const std::string rest = R"(base: {position_mm: [1500, 200, -300], rpy_deg: [0, 0, 90]}
sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[90, 0, 60], [90, 80, -30], [150, -70, 20]]}}
)";

class Units : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_text("c.yaml", arm + rest);
        run_well("simulate c.yaml --poses 30 --repeats 3 -o s.csv");
    }
    /// A campaign with one part replaced by another.
    void write_with(const std::string& part, const std::string& by) const {
        std::string text = arm + rest;
        ASSERT_NE(text.find(part), std::string::npos) << part;
        write_text("w.yaml", text.replace(text.find(part), part.size(), by));
    }
    std::string warnings_of(const std::string& arguments) const {
        const Outcome outcome = run("calibrate " + arguments + " --folds 0");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return outcome.err;
    }
};

TEST_F(Units, LimitsInDegreesUnderRadAreRefused) {
    write_with("limits_deg: [-90, 90]", "limits_rad: [-90, 90]");
    expect_input_error("inspect w.yaml",
                       "robot.joints.q2.limits_rad reaches 14.3 turns; must be within three either "
                       "way: are they degrees? Then the key is limits_deg");
    expect_input_error("plan w.yaml --poses 10", "are they degrees?");
    write_with("limits_deg: [-90, 90]", "limits_deg: [-90, 1900]");
    expect_input_error("inspect w.yaml", "q2.limits_deg reaches 5.28 turns; must be within three");
    write_with("limits_deg: [-90, 90]", "limits_deg: [-1000, 1000]");
    run_well("inspect w.yaml");
}

TEST_F(Units, FloorAndSpeedsThatNoCellHasAreRefused) {
    const std::string cell = read_text(source_folder() + "/designs/cell_demo/campaign.yaml");
    const auto with = [&](const std::string& part, const std::string& by) {
        std::string text = cell;
        write_text("cell.yaml", text.replace(text.find(part), part.size(), by));
    };
    with("floor_z_mm", "floor_z_m");
    expect_input_error("inspect cell.yaml", "is over 100 m from the base; is it in mm?");
    with("speed_deg_per_s", "speed_rad_per_s");
    expect_input_error("inspect cell.yaml", "is beyond 2000 deg/s, which no joint has");
}

TEST_F(Units, LimitsInRadUnderDegreesAreRefused) {
    std::string text = arm + rest;
    for (const auto& [degrees, rad] : {std::pair{"170, 170", "2.97, 2.97"},
                                       {"90, 90", "1.57, 1.57"},
                                       {"150, 150", "2.62, 2.62"},
                                       {"110, 110", "1.92, 1.92"}}) {
        for (std::size_t at = 0; (at = text.find(degrees)) != std::string::npos;) {
            text.replace(at, std::string(degrees).size(), rad);
        }
    }
    write_text("w.yaml", text);
    expect_input_error("inspect w.yaml",
                       "robot has no joint that turns beyond 2.97 deg; must have room to turn: are "
                       "the limits rad? Then their key is limits_rad");
    text.replace(text.find("2.97, 2.97"), 10, "10, 10");
    write_text("w.yaml", text);
    run_well("inspect w.yaml");
}

TEST_F(Units, TargetsAtOnePlaceAreRefused) {
    write_with("[90, 80, -30]", "[90, 0, 60.5]");
    expect_input_error("inspect w.yaml",
                       "sensor.targets.position_mm puts targets 1 and 2 at one "
                       "place, 0.5 mm apart; must be places of their own: are "
                       "they in m? Then the key is position_m");
    write_with("[[90, 0, 60], [90, 80, -30], [150, -70, 20]]",
               "[[0.09, 0, 0.06], [0.09, 0.08, -0.03], [0.15, -0.07, 0.02]]");
    expect_input_error("plan w.yaml --poses 12", "are they in m? Then the key is position_m");
}

TEST_F(Units, ABaseInMetresIsNamedAndRefusedWhereItIsUsed) {
    EXPECT_EQ(warnings_of("c.yaml -m s.csv"), "");
    write_with("[1500, 200, -300]", "[1.5, 0.2, -0.3]");
    const std::string words = "s.csv: base is stated at [1.5, 0.2, -0.3] mm, measured at [";
    const std::string unit = "] mm: are its numbers in m? Then the key is position_m\n";
    const std::string warnings = warnings_of("w.yaml -m s.csv");
    EXPECT_NE(warnings.find(words), std::string::npos) << warnings;
    EXPECT_NE(warnings.find(unit), std::string::npos) << warnings;
    expect_input_error("select w.yaml -m s.csv -k 20", words);
    expect_input_error("study w.yaml -m s.csv", words);
    EXPECT_NE(run("inspect w.yaml -m s.csv").err.find(words), std::string::npos);
    EXPECT_EQ(run("inspect c.yaml -m s.csv").err, "");
    write_with("position_mm: [1500, 200, -300]", "position_m: [1500, 200, -300]");
    EXPECT_NE(warnings_of("w.yaml -m s.csv").find("in mm? Then the key is position_mm"),
              std::string::npos);
}

TEST_F(Units, ATargetInMetresIsNamed) {
    std::string one = arm + rest;
    const std::string three = "[[90, 0, 60], [90, 80, -30], [150, -70, 20]]";
    one.replace(one.find(three), three.size(), "[[90, 0, 60]]");
    write_text("one.yaml", one);
    run_well("simulate one.yaml --poses 40 -o one.csv");
    one.replace(one.find("[[90, 0, 60]]"), 13, "[[0.09, 0, 0.06]]");
    write_text("w.yaml", one);
    const std::string warnings = warnings_of("w.yaml -m one.csv");
    EXPECT_NE(warnings.find("target1 is stated at [0.1, 0.0, 0.1] mm, measured at ["),
              std::string::npos)
        << warnings;
}

TEST_F(Units, ABaseElsewhereIsSaid) {
    write_with("[1500, 200, -300]", "[1500, 350, -300]");
    const std::string warnings = warnings_of("w.yaml -m s.csv");
    EXPECT_NE(warnings.find("base is stated at [1500.0, 350.0, -300.0] mm, measured at ["),
              std::string::npos)
        << warnings;
    EXPECT_NE(warnings.find("mm away; state them there for plans, or are these of another set-up?"),
              std::string::npos);
    const Outcome selected = run("select w.yaml -m s.csv -k 25");
    EXPECT_EQ(selected.code, 0) << selected.err;
    EXPECT_NE(selected.err.find("base is stated at [1500.0"), std::string::npos) << selected.err;
    write_with("[1500, 200, -300]", "[1500, 280, -300]");
    EXPECT_EQ(warnings_of("w.yaml -m s.csv"), "");
}

TEST_F(Units, ExchangedTargetsAreNamed) {
    write_with("[90, 0, 60], [90, 80, -30]", "[90, 80, -30], [90, 0, 60]");
    const std::string warnings = warnings_of("w.yaml -m s.csv");
    EXPECT_NE(warnings.find("s.csv: target1 is measured where target2 is stated; target2 is "
                            "measured where target1 is stated; state them in the order of the "
                            "columns\n"),
              std::string::npos)
        << warnings;
}

TEST_F(Units, AModelErrorOrSigmaInMicrometresIsNamed) {
    write_with("sigma_mm: 0.05", "sigma_mm: 50");
    EXPECT_NE(warnings_of("w.yaml -m s.csv").find("stated in um? Then sigma_um or model_error_um"),
              std::string::npos);
    write_text("w.yaml", arm + rest + "model_error_mm: 100\n");
    EXPECT_NE(warnings_of("w.yaml -m s.csv").find("Then sigma_um or model_error_um is its key"),
              std::string::npos);
    write_text("w.yaml", arm + rest + "model_error_mm: 100\nprior: true\n");
    const std::string found = warnings_of("w.yaml -m s.csv");
    EXPECT_NE(found.find("Then sigma_um or model_error_um is its key"), std::string::npos) << found;
}

}  // namespace
}  // namespace posewise::testing
