#include <nlohmann/json.hpp>
#include <numeric>
#include <sstream>

#include "page_document.hpp"
#include "program.hpp"
#include "support/combined.hpp"

/// Several sensors in one campaign, through every command.
namespace posewise::testing {
namespace {

/// The text with the first `old` replaced.
std::string with(std::string text, const std::string& old, const std::string& by) {
    const auto place = text.find(old);
    EXPECT_NE(place, std::string::npos) << old;
    return text.replace(place, old.size(), by);
}

class CombinedSensors : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_text("c.yaml", tracker_and_camera);
        run_well("simulate c.yaml --poses 40 --repeats 2 -o m.csv");
    }
    nlohmann::json json_of(const std::string& name) const {
        return nlohmann::json::parse(text_of(name));
    }
    nlohmann::json residuals_in(const std::string& page) const {
        return document_in_page(text_of(page))["parts"][0]["residuals"];
    }
    std::vector<std::string> lines_of(const std::string& name) const {
        std::vector<std::string> lines;
        std::istringstream text(text_of(name));
        for (std::string line; std::getline(text, line);) {
            if (line[0] != '#') lines.push_back(line);
        }
        return lines;
    }
};

TEST_F(CombinedSensors, HaveTheirColumnsSideBySide) {
    const std::string header = lines_of("m.csv").front();
    EXPECT_NE(header.find(",p2_z_mm,p1_u_px,p1_v_px,"), std::string::npos) << header;
    EXPECT_EQ(lines_of("m.csv").size(), 1U + 40 * 2);
}

TEST_F(CombinedSensors, AreCalibratedTogetherAndJudgedEachInItsUnit) {
    const std::string found = run_well("calibrate c.yaml -m m.csv --folds 5 -o e.json");
    EXPECT_NE(found.find("Accuracy of each sensor, RMS"), std::string::npos);
    const auto by_sensor = json_of("e.json")["accuracy"]["by_sensor"];
    ASSERT_EQ(by_sensor.size(), 2U);
    EXPECT_EQ(by_sensor[0]["readings"], "points");
    EXPECT_EQ(by_sensor[0]["fit"]["point_count"], 40 * 2 * 2);
    EXPECT_LT(by_sensor[0]["fit"]["distance_rms_mm"], by_sensor[0]["nominal"]["distance_rms_mm"]);
    EXPECT_EQ(by_sensor[1]["readings"], "corners");
    EXPECT_FALSE(by_sensor[1]["fit"].contains("distance_rms_mm"));
    // As its noise, and little more by the model error.
    EXPECT_GT(by_sensor[1]["held_out"]["reprojection_rms_px"], 0.2);
    EXPECT_LT(by_sensor[1]["held_out"]["reprojection_rms_px"], 2);
    EXPECT_TRUE(json_of("e.json")["sensor"].contains("sensor2.x_m"));
    EXPECT_NE(found.find("Where in the image        corners of the board cover "),
              std::string::npos);
    EXPECT_EQ(json_of("e.json")["measured"]["images"][0]["sensor"], 2);
}

TEST_F(CombinedSensors, AreTakenByEveryCommand) {
    EXPECT_NE(run_well("inspect c.yaml -m m.csv").find("2) 24 corners of a board"),
              std::string::npos);
    run_well("calibrate c.yaml -m m.csv --folds 0 -o e.json --report e.html");
    const auto residuals = residuals_in("e.html");
    const auto corners = residuals["of_cameras"];
    EXPECT_EQ(residuals["readings"]["residual"].size(), 3U);
    EXPECT_EQ(corners["axes"], (std::vector<std::string>{"u", "v"}));
    EXPECT_EQ(corners["readings"]["camera"].size() + residuals["readings"]["target"].size(),
              json_of("e.json")["measured"]["readings_seen"]);
    EXPECT_LT(corners["images"][0]["rms_px"], 1);
    run_well("simulate c.yaml --poses 20 --seed 5 -o next.csv");
    run_well("calibrate c.yaml -m next.csv --from e.json --folds 3");
    write_text("larger.yaml", with(tracker_and_camera, "rows: 4", "rows: 5"));
    expect_input_error("plan larger.yaml -k 5 --from e.json -o p.json",
                       "must be an estimate of this campaign");
    run_well("calibrate c.yaml -m m.csv --validate next.csv --folds 0");
    // Stopped early, which is a warning: refining what many corners tell takes a minute.
    EXPECT_EQ(run("plan c.yaml -k 14 --pool 100 --workspace-poses 20 --time 5 -o p.json").code, 0);
    EXPECT_EQ(run("verify p.json").code, 0);
    run_well("select c.yaml -m m.csv -k 24 --starts 2 --proof 0.2 -o s.json");
    EXPECT_EQ(run("verify s.json").code, 0);
    run_well("study c.yaml -m m.csv -k 27 --splits 2 --random 2");
}

/// Rows of a sensor that saw nothing: its cells are empty.
TEST_F(CombinedSensors, NeedNotSeeAPoseAll) {
    std::string text = lines_of("m.csv").front() + '\n';
    const std::vector<std::string> lines = lines_of("m.csv");
    for (std::size_t k = 1; k < lines.size(); ++k) {
        std::istringstream cells(lines[k]);
        std::string row;
        std::size_t column = 0;
        for (std::string cell; std::getline(cells, cell, ','); ++column) {
            const bool is_point = column >= 8 && column < 14;
            const bool is_corner = column >= 14;
            const bool is_dropped = (k % 4 == 0 && is_point) || (k % 4 == 2 && is_corner);
            row += (column > 0 ? "," : "") + (is_dropped ? "" : cell);
        }
        text += row + std::string(lines[k].back() == ',' ? "," : "") + '\n';
    }
    write_text("some.csv", text);
    run_well("calibrate c.yaml -m some.csv --folds 4 -o e.json");
    EXPECT_EQ(json_of("e.json")["accuracy"]["by_sensor"][0]["fit"]["point_count"], 120);
}

/// Boards that one camera sees in turn: what is unknown of it is found once, from both.
TEST_F(CombinedSensors, MayBeOneCameraBeforeTwoBoards) {
    write_text("b.yaml", two_boards);
    run_well("simulate b.yaml --poses 40 -o b.csv");
    EXPECT_NE(lines_of("b.csv").front().find(",u_px,v_px,point,sensor"), std::string::npos);
    EXPECT_NE(run_well("inspect b.yaml -m b.csv").find("seen by the same camera as 1)"),
              std::string::npos);
    run_well("calibrate b.yaml -m b.csv --folds 5 -o e.json --report e.html");
    const auto residuals = residuals_in("e.html");
    ASSERT_EQ(residuals["images"].size(), 1U);  // of both boards
    const auto& counts = residuals["images"][0]["counts"];
    const auto of_cells = counts.get<std::vector<std::size_t>>();
    EXPECT_EQ(std::accumulate(of_cells.begin(), of_cells.end(), 0UL),
              residuals["readings"]["camera"].size());
    const auto accuracy = json_of("e.json")["accuracy"];
    ASSERT_EQ(accuracy["by_sensor"].size(), 2U);
    for (const auto& one : accuracy["by_sensor"]) {
        EXPECT_LT(one["held_out"]["reprojection_rms_px"], 2);
    }
    const auto sensor = json_of("e.json")["sensor"];
    run_well("export b.yaml e.json --camera camera.yaml");
    EXPECT_NE(text_of("camera.yaml").find("flange_from_camera"), std::string::npos);
    EXPECT_TRUE(sensor.contains("camera.fx_kpx") && !sensor.contains("sensor2.camera.fx_kpx"));
    EXPECT_EQ(run("plan b.yaml -k 14 --pool 1000 --workspace-poses 20 --time 5 -o p.json").code, 0);
    EXPECT_EQ(run("verify p.json").code, 0);
    run_well("select b.yaml -m b.csv -k 24 --starts 2 --proof 0.2 -o s.json");
}

TEST_F(CombinedSensors, AreRefusedWhereTheyCannotBeUsed) {
    const auto refuse = [&](const std::string& text, const std::string& words) {
        write_text("bad.yaml", text);
        write_text("bad.csv", "");
        expect_input_error("calibrate bad.yaml -m m.csv -o e.json", words);
    };
    refuse(with(tracker_and_camera, "kind: camera", "kind: camara"),
           "sensors[2].kind is 'camara'; did you mean");
    refuse(tracker_alone.substr(0, tracker_alone.find("sensor:")) + "sensors:\n" + tracker_part,
           "lists 1 sensor; must be from 2 to 8");
    refuse(tracker_and_camera + "sensor: {kind: points, sigma_mm: 1, targets: {count: 1}}\n",
           "is stated beside 'sensor'");
    refuse(with(tracker_and_camera, "    targets:", "    frame: first\n    targets:"),
           "is of the first sensor, whose frame is the world");
    refuse(tracker_and_camera + "cell: {tracker: {range_m: [1, 20]}}\n",
           "there are several sensors");
    refuse(tracker_alone.substr(0, tracker_alone.find("sensor:")) + "sensors:\n" + tracker_part +
               "  - kind: sockets\n    sigma_mm: 0.01\n    sockets: [{name: s0}]\n"
               "    targets: {position_mm: [[0, 0, 90]]}\n",
           "sockets cannot be combined");
    write_text("points.csv", "config,q1_rad,q2_rad,q3_rad,q4_rad,q5_rad,q6_rad,p1_x_mm\n");
    expect_input_error("calibrate c.yaml -m points.csv -o e.json", "missing columns");
    expect_input_error("calibrate c.yaml -m m.csv --loss cauchy -o e.json", "robust loss");
}

}  // namespace
}  // namespace posewise::testing
