#include <nlohmann/json.hpp>

#include "program.hpp"
#include "support/slips.hpp"

/// A robot on a rail whose pitch is stated, from the campaign file to what others read.
namespace posewise::testing {
namespace {

const std::string campaign = R"(name: rail
robot:
  joints:
    rail: {limits_mm: [0, 1500], pitch_mm: 20}
    q1: {limits_deg: [-150, 150]}
    q2: {limits_deg: [-60, 60]}
    q3: {limits_deg: [-100, 100]}
    q4: {limits_deg: [-150, 150]}
    q5: {limits_deg: [-100, 100]}
  elements: [Ty rail, Tz 300 mm, Rz q1, Tx 100 mm, Ry q2, Tz 500 mm, Ry q3, Tx 400 mm, Rx q4, Ry q5, Tx 80 mm]
sensor: {kind: points, sigma_mm: 0.002, targets: {position_mm: [[60, 0, 0], [0, 60, 10], [-40, -40, 30]]}}
base: {position_mm: [2500, 0, 0], rpy_deg: [0, 0, 180]}
model_error_mm: 0.002
)";

class Slides : public Program {};

TEST_F(Slides, KeepTheErrorsOfTheirDrivesInEveryFile) {
    write_text("c.yaml", campaign);
    run_well("simulate c.yaml --poses 40 --truth 5 -o m.csv");
    const std::string report = run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json");
    EXPECT_EQ(number_behind(report, "harmonics of joints that slide"), 4) << report;
    EXPECT_EQ(number_behind(report, "harmonics of joints that slide", 1), 0.008);
    const auto estimate = nlohmann::json::parse(text_of("e.json"));
    EXPECT_EQ(estimate.at("learned_sizes").at("slide_harmonic_m").at("stated"), 8e-6);
    const auto& found = estimate.at("robot").at("rail.cos(2rail)");
    EXPECT_LT(found.at("sigma_m"), 3e-6);

    // As an earlier estimate: what it found of the rail is kept.
    run_well("calibrate c.yaml -m m.csv --folds 0 --from e.json --only base,targets -o again.json");
    const auto again = nlohmann::json::parse(text_of("again.json"));
    EXPECT_EQ(again.at("robot").at("rail.cos(2rail)").at("value_m"), found.at("value_m"));

    const std::string exported = run_well("export c.yaml e.json --dh dh.yaml");
    EXPECT_NE(exported.find("since they depend on the configuration: rail.sin(rail) rail.cos(rail) "
                            "rail.sin(2rail) rail.cos(2rail) rail.scale "),
              std::string::npos)
        << exported;
    EXPECT_NE(text_of("dh.yaml").find("limits_mm: [0, 1500], kind: prismatic, pitch_mm: 20"),
              std::string::npos)
        << text_of("dh.yaml");

    write_text("other.yaml", replaced(campaign, "pitch_mm: 20", "pitch_mm: 25"));
    expect_input_error("export other.yaml e.json --dh other_dh.yaml",
                       "the joint limits and pitches, from which their shapes follow, were others");
}

TEST_F(Slides, HaveHarmonicsOfTheirClass) {
    write_text("h.yaml", replaced(campaign, "robot:\n", "robot:\n  errors: [class:harmonics]\n"));
    write_text("c.yaml", campaign);
    run_well("simulate h.yaml --poses 40 --truth 5 -o m.csv");
    run_well("calibrate c.yaml -m m.csv --folds 0 --free class:harmonics -o e.json");
    const auto robot = nlohmann::json::parse(text_of("e.json")).at("robot");
    EXPECT_EQ(robot.size(), 4U + 5 * 4);
    EXPECT_TRUE(robot.contains("rail.sin(2rail)"));
}

}  // namespace
}  // namespace posewise::testing
