#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "program.hpp"

/// What a cell allows, as a user meets it: nothing goes to a robot that it does not allow in
/// silence.
namespace posewise::testing {
namespace {

const std::string quick = " --pool 1500 --starts 1 --workspace-poses 5 ";

class CellCommands : public Program {
  protected:
    /// The demonstration cell with some places of its text changed.
    void write_cell(const std::string& name,
                    const std::vector<std::pair<std::string, std::string>>& changes) const {
        std::string text = read_text(source_folder() + "/designs/cell_demo/campaign.yaml");
        for (const auto& [from, to] : changes) {
            const auto place = text.find(from);
            ASSERT_NE(place, std::string::npos) << from;
            text.replace(place, from.size(), to);
        }
        write_text(name, text);
    }
    /// With a pillar that the arm must go round, and none of its ways straight.
    void write_pillar(const std::string& name) const {
        write_cell(name, {{"max: [1700, 600, -100]",
                           "max: [1700, 600, -100]}}\n    - {name: pillar, box_mm: {min: [420, "
                           "-150, -670], max: [2900, 150, 3200]"},
                          {"home_deg: [0, -30, 0, 0, 0, 0]", "home_deg: [-60, -30, 0, 0, 0, 0]"},
                          {"line_of_sight: true", "line_of_sight: false"}});
    }
    /// The links taken out.
    void write_without_links(const std::string& name) const {
        std::istringstream lines(read_text(source_folder() + "/designs/cell_demo/campaign.yaml"));
        std::string text;
        bool is_link = false;
        for (std::string line; std::getline(lines, line);) {
            if (line.starts_with("  links:")) is_link = true;
            if (!is_link) text += line + '\n';
            if (line.find("name: tool") != std::string::npos) is_link = false;
        }
        write_text(name, text);
    }
};

TEST_F(CellCommands, SendTheRobotOverThePointsToPassAndSayWhereThereIsNoWay) {
    write_pillar("w.yaml");
    const Outcome made = run("plan w.yaml -k 12" + quick + "-o w.json --csv w.csv");
    ASSERT_EQ(made.code, 0) << made.err;
    const auto plan = nlohmann::json::parse(text_of("w.json"));
    std::size_t vias = 0;
    std::size_t blocked = 0;
    for (const auto& pose : plan.at("poses")) {
        if (!pose.at("via").is_null()) ++vias;
        if (pose.at("way_is_blocked")) ++blocked;
    }
    ASSERT_GT(vias + blocked, 0U);
    std::istringstream lines(text_of("w.csv"));
    std::string header;
    std::getline(lines, header);
    EXPECT_NE(header.find(",purpose,way,clearance_mm,nearest"), std::string::npos) << header;
    std::size_t via_rows = 0;
    std::size_t blocked_rows = 0;
    std::size_t rows = 0;
    for (std::string line; std::getline(lines, line); ++rows) {
        if (line.find(",via,straight") != std::string::npos) ++via_rows;
        if (line.find(",BLOCKED,") != std::string::npos) ++blocked_rows;
    }
    EXPECT_EQ(via_rows, vias);
    EXPECT_EQ(blocked_rows, blocked);
    EXPECT_EQ(rows, 12 + vias);
    EXPECT_EQ(made.err.find("no free way was found to") != std::string::npos, blocked > 0);
    const Outcome strict = run("plan w.yaml -k 12" + quick + "--strict -o s.json");
    EXPECT_EQ(strict.code, blocked > 0 ? 1 : 0);
    EXPECT_EQ(has_file("s.json"), blocked == 0);
    // Nothing is measured on the way.
    run_well("simulate w.yaml --configurations w.csv -o m.csv");
    run_well("calibrate w.yaml -m m.csv --plan w.json --folds 0");
}

/// A limit of the pendant's joint 3, checked from the files alone: at each pose, at each point that
/// is passed and at each move of the program. What it costs is printed.
TEST_F(CellCommands, KeepLimitsOfAControllersJointOnTheWholeWay) {
    const double lower = -60;  // deg
    const double upper = 35;
    write_cell("free.yaml", {{"max: [1700, 600, -100]",
                              "max: [1700, 600, -100]}}\n    - {name: beam, box_mm: {min: [900, "
                              "-700, 300], max: [2900, -500, 3200]"},
                             {"  home_deg: [0, -30, 0, 0, 0, 0]\n", ""},
                             {"line_of_sight: true", "line_of_sight: false"}});
    std::string text = text_of("free.yaml") + "\ncontroller: {joints: {J3: q3 - q2}}\n";
    write_text("free.yaml", text);
    const std::string cell = "\ncell:\n";
    text.insert(text.find(cell) + cell.size(),
                fmt::format("  joint_sums: {{J3: {{limits_deg: [{}, {}]}}}}\n", lower, upper));
    write_text("limited.yaml", text);
    const auto made = [&](const std::string& name) {
        EXPECT_EQ(run("plan " + name + ".yaml -k 12" + quick + "-o " + name + ".json").code, 0);
        return nlohmann::json::parse(text_of(name + ".json"));
    };
    const auto free = made("free");
    const auto limited = made("limited");
    const double margin = 2;  // margin_deg
    std::size_t vias = 0;
    bool is_tight = false;
    const auto third = [](const nlohmann::json& q) {
        return (q.at("q3_rad").get<double>() - q.at("q2_rad").get<double>()) * 180 /
               std::numbers::pi;
    };
    for (const auto& pose : limited.at("poses")) {
        std::vector<nlohmann::json> passed{pose.at("joints")};
        if (!pose.at("via").is_null()) passed.push_back(pose.at("via"));
        vias += passed.size() - 1;
        for (const auto& q : passed) {
            EXPECT_GE(third(q), lower + margin - 1e-6) << pose.dump();
            EXPECT_LE(third(q), upper - margin + 1e-6) << pose.dump();
        }
    }
    EXPECT_GT(vias, 0U);
    for (const auto& pose : free.at("poses")) {
        const double sum = third(pose.at("joints"));
        is_tight = is_tight || sum < lower || sum > upper;
    }
    EXPECT_TRUE(is_tight);
    // As the program has it.
    EXPECT_EQ(run("program limited.json --for csv -o limited.csv").code, 0);
    std::istringstream lines(text_of("limited.csv"));
    std::string line;
    std::getline(lines, line);
    std::size_t moves = 0;
    for (; std::getline(lines, line); ++moves) {
        std::vector<std::string> fields;
        std::istringstream row(line);
        for (std::string field; std::getline(row, field, ',');) fields.push_back(field);
        EXPECT_GE(std::stod(fields.at(3)), lower + margin - 1e-5) << line;
        EXPECT_LE(std::stod(fields.at(3)), upper - margin + 1e-5) << line;
    }
    EXPECT_EQ(moves, 12 + vias);
    // V is 1 over a mean square error, so that its loss is one of accuracy. As far as searches find
    // the best: the smaller pool is searched better.
    const auto rms = [](const nlohmann::json& plan) {
        return 1e3 * plan.at("predicted").at("position_error_rms_m").get<double>();
    };
    const double loss = 1 - limited.at("value").get<double>() / free.at("value").get<double>();
    std::cout << fmt::format(
        "limits of J3 from {} to {} deg cost {:.1f} % of V: {:.4f} instead of {:.4f} mm RMS; {} "
        "points passed, {} moves\n",
        lower, upper, 100 * loss, rms(limited), rms(free), vias, moves);
    EXPECT_LT(limited.at("value"), free.at("bounds").at("continuous").at("bound"));
    EXPECT_GT(loss, -0.2);
    EXPECT_LT(loss, 0.2);
    EXPECT_LT(rms(limited), 1.2 * rms(free));
}

TEST_F(CellCommands, WarnThatAnArmWithoutLinksIsNotChecked) {
    write_without_links("n.yaml");
    const std::string words = "warning: the arm is not kept off the cell's obstacles";
    const Outcome made = run("plan n.yaml -k 30" + quick + "-c d -o n.json");
    EXPECT_EQ(made.code, 0) << made.err;
    EXPECT_NE(made.err.find(words), std::string::npos) << made.err;
    EXPECT_NE(made.out.find("cell:        the arm is not kept off"), std::string::npos) << made.out;
    EXPECT_EQ(nlohmann::json::parse(text_of("n.json")).at("cell_doubts").size(), 1U);
    EXPECT_NE(run("select n.yaml --random 60 -k 15 -o r.json").err.find(words), std::string::npos);
    EXPECT_NE(run("simulate n.yaml --poses 5 -o m.csv").err.find(words), std::string::npos);
    // And by the cell with links some poses are refused, the bodies named.
    write_cell("cell.yaml", {});
    const Outcome checked = run("verify n.json --campaign cell.yaml");
    EXPECT_NE(checked.out.find("does not meet keep_out: "), std::string::npos) << checked.out;
    EXPECT_NE(checked.out.find(", must be 20 mm away"), std::string::npos) << checked.out;
}

TEST_F(CellCommands, StateTheLeastClearanceOfEachPoseAndCheckIt) {
    write_cell("c.yaml", {});
    const std::string text = run_well("plan c.yaml -k 12" + quick + "-o p.json --csv p.csv");
    EXPECT_NE(text.find("nearest/mm"), std::string::npos) << text;
    auto plan = nlohmann::json::parse(text_of("p.json"));
    for (const auto& pose : plan.at("poses")) {
        EXPECT_GE(pose.at("clearance_m"), 0.02 - 1e-9);
        EXPECT_EQ(pose.at("nearest").size(), 2U);
    }
    run_well("verify p.json");
    plan.at("poses")[3].at("clearance_m") = 0.9;
    write_text("p.json", plan.dump());
    EXPECT_NE(run("verify p.json").out.find("states as nearest 900.0000 mm, "), std::string::npos);
}

TEST_F(CellCommands, RefusePlacesAndLimitsInAnotherUnit) {
    const std::string fanuc =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const auto change = [&](const std::string& from, const std::string& to) {
        std::string text = fanuc;
        const auto place = text.find(from);
        ASSERT_NE(place, std::string::npos) << from;
        write_text("f.yaml", text.replace(place, from.size(), to));
    };
    change("targets: {position_mm", "targets: {position_m");
    for (const std::string& command :
         {"plan f.yaml -k 12" + quick, std::string("select f.yaml --random 50 -k 12 "),
          std::string("simulate f.yaml --poses 12 ")}) {
        expect_input_error(command + "-o x.out",
                           "m away, must be within 10 m; are its numbers in mm?");
    }
    change("q1: {limits_deg: [-90, 90]}", "q1: {limits_rad: [-30, 30]}");
    expect_input_error("plan f.yaml -k 12" + quick + "-o x.out",
                       "q1.limits_rad reaches 4.77 turns; must be within three either way: are "
                       "they degrees?");
}

TEST_F(CellCommands, VerifyWritesNoControlCharactersOfAPath) {
    write_cell("c.yaml", {});
    run_well("plan c.yaml -k 12" + quick + "-o p.json");
    std::filesystem::copy(folder_ / "p.json", folder_ / "p\033[31m.json");
    EXPECT_EQ(run("verify \"$(printf 'p\\033[31m.json')\"").out.find('\033'), std::string::npos);
}

}  // namespace
}  // namespace posewise::testing
