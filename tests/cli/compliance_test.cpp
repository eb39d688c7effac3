#include "program.hpp"

/// Joints that give way under known weights and under torques that are measured.
namespace posewise::testing {
namespace {

/// A 7R arm with three targets and this section `compliance`.
std::string arm(const std::string& compliance) {
    std::string rows;
    const double limits[] = {170, 120, 170, 120, 170, 120, 175};
    const double d[] = {0.34, 0, 0.4, 0, 0.4, 0, 0.126};
    const double alpha[] = {-90, 90, 90, -90, -90, 90, 0};
    for (int j = 0; j < 7; ++j) {
        std::ostringstream row;
        row << "      - {joint: q" << j + 1 << ", a_m: 0, alpha_deg: " << alpha[j]
            << ", d_m: " << d[j] << ", theta_deg: 0, limits_deg: [-" << limits[j] << ", "
            << limits[j] << "]}\n";
        rows += row.str();
    }
    return "name: arm\nrobot:\n  errors: geometric\n  dh:\n    convention: standard\n    rows:\n" +
           rows + compliance +
           "sensor: {kind: points, sigma_mm: 0.02, targets: {position_mm: [[90, 0, 60], [-50, 80, "
           "60], [-40, -70, 90]]}}\nmodel_error_mm: 0.01\n"
           "base: {position_mm: [1500, 300, 0], rpy_deg: [0, 0, 60]}\n";
}

const std::string weights =
    "  compliance: {links: {q2: {mass_kg: 8, center_mm: [0, 0, 200]}, q4: {mass_kg: 6, center_mm: "
    "[0, 0, 150]}, q6: {mass_kg: 3, center_mm: [0, 0, 20]}}, payload: {mass_kg: 5, center_mm: [20, "
    "0, 80]}}\n";
const std::string torques =
    "  compliance: {torques_Nm: {q1: 100, q2: 200, q3: 80, q4: 80, q5: 40, q6: 20}}\n";

class Compliance : public Program {
  protected:
    /// Makes, measures and calibrates it; what calibrate prints.
    std::string calibrate(const std::string& compliance) {
        write_text("c.yaml", arm(compliance));
        run_well("simulate c.yaml --poses 60 --truth 3 -o m.csv");
        return run_well("calibrate c.yaml -m m.csv -o e.json");
    }
};

TEST_F(Compliance, UnderKnownWeightsIsIdentified) {
    const std::string text = calibrate(weights);
    EXPECT_NEAR(number_behind(text, "variance factor"), 1, 0.3);
    EXPECT_NE(text.find("\nq2 "), std::string::npos) << text;
    EXPECT_NE(text.find("urad/(N m)"), std::string::npos) << text;
    const std::string inspected = run_well("inspect c.yaml");
    EXPECT_NE(inspected.find("compliances are stated at q2 "), std::string::npos) << inspected;

    // Without them the same measurements fit many times worse.
    write_text("rigid.yaml", arm(""));
    const std::string rigid = run("calibrate rigid.yaml -m m.csv --folds 0").out;
    EXPECT_GT(number_behind(rigid, "distance RMS", 1), 3 * number_behind(text, "distance RMS", 1));

    run_well("plan c.yaml -k 12 --pool 200 --starts 1 -o p.json");
    run_well("simulate c.yaml --poses 5 --truth 4 -o poses.csv");
    const std::string corrected = run_well("correct c.yaml e.json --poses poses.csv");
    EXPECT_LT(number_behind(corrected, "position RMS/mm", 1),
              0.01 * number_behind(corrected, "position RMS/mm"));
}

TEST_F(Compliance, UnderMeasuredTorquesIsIdentified) {
    const std::string text = calibrate(torques);
    EXPECT_NE(text_of("m.csv").find(",tau_q1_Nm,tau_q2_Nm,"), std::string::npos);
    EXPECT_NEAR(number_behind(text, "variance factor"), 1, 0.3);
    EXPECT_EQ(number_behind(text, "q2 ", 4), 200) << text;
    run_well("select c.yaml --measurements m.csv -k 20 --starts 1 -o s.json");
    run_well("calibrate c.yaml -m m.csv --plan s.json --folds 0");
    run_well("simulate c.yaml --poses 5 --truth 4 -o poses.csv");
    const std::string corrected =
        run_well("correct c.yaml e.json --poses poses.csv -o corrected.csv");
    EXPECT_LT(number_behind(corrected, "position RMS/mm", 1),
              0.01 * number_behind(corrected, "position RMS/mm"));
    EXPECT_NE(text_of("corrected.csv").find(",q7_deg,tau_q1_Nm,"), std::string::npos);
}

TEST_F(Compliance, IsThatOfTheJointWhateverTheLargestTorque) {
    calibrate(torques);
    write_text(
        "pose.csv",
        "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,q7_deg,tau_q1_Nm,tau_q2_Nm,"
        "tau_q3_Nm,tau_q4_Nm,tau_q5_Nm,tau_q6_Nm\na,10,20,30,40,50,60,70,50,100,40,-20,9,5\n");
    run_well("correct c.yaml e.json --poses pose.csv -o before.csv");
    std::string wider = torques;
    wider.replace(wider.find("q2: 200"), 7, "q2: 400");
    write_text("c.yaml", arm(wider));
    run_well("correct c.yaml e.json --poses pose.csv -o after.csv");
    const auto joints = [&](const char* file) {
        const std::string text = text_of(file);
        return text.substr(text.find("\na,"), 150);
    };
    EXPECT_EQ(joints("before.csv").substr(0, 60), joints("after.csv").substr(0, 60));
}

TEST_F(Compliance, OfTheWrongSignIsSaid) {
    calibrate(torques);
    std::string turned;
    std::istringstream lines(text_of("m.csv"));
    for (std::string line; std::getline(lines, line);) {
        if (line[0] >= '0' && line[0] <= '9') {
            std::size_t begin = 0;
            for (int comma = 0; comma < 9; ++comma) begin = line.find(',', begin) + 1;
            std::string signs = line.substr(0, begin);
            for (int k = 0; k < 6; ++k) {
                const auto end = line.find(',', begin);
                const std::string value = line.substr(begin, end - begin);
                signs += (value[0] == '-' ? value.substr(1) : '-' + value) + ',';
                begin = end + 1;
            }
            line = signs + line.substr(begin);
        }
        turned += line + '\n';
    }
    write_text("turned.csv", turned);
    const std::string text = run_well("calibrate c.yaml -m turned.csv --folds 0");
    EXPECT_NE(text.find(": negative, but a joint gives way with its load"), std::string::npos)
        << text;
    EXPECT_EQ(run_well("calibrate c.yaml -m m.csv --folds 0").find("negative, but"),
              std::string::npos);
}

TEST_F(Compliance, UnderMeasuredTorquesCannotBePlannedFromNothing) {
    write_text("c.yaml", arm(torques));
    const std::string rule =
        "arm: its torques are measured with each configuration, and of poses that are drawn "
        "nobody";
    expect_input_error("plan c.yaml -k 12", rule);
    expect_input_error("select c.yaml --random 100 -k 20", rule);
    write_text("m.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,q7_deg\na,0,0,0,0,0,0,0\n");
    expect_input_error("select c.yaml --candidates m.csv -k 20", "missing columns tau_q1_Nm");
}

}  // namespace
}  // namespace posewise::testing
