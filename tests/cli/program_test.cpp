#include "program.hpp"

#include <nlohmann/json.hpp>
#include <vector>

/// `program`: from a plan to a controller, and back.
namespace posewise::testing {
namespace {

class ProgramCommand : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_cell("cell.yaml", "{maker: fanuc, j23_factor: 1}");
        run_well(
            "plan cell.yaml -k 10 --verification 2 --pool 600 --starts 1 --workspace-poses 30 "
            "-o p.json --csv p.csv");
    }

    /// The demonstration cell with this controller.
    void write_cell(const std::string& name, const std::string& controller) const {
        write_text(name, read_text(source_folder() + "/designs/cell_demo/campaign.yaml") +
                             "\ncontroller: " + controller + '\n');
    }

    std::vector<std::vector<std::string>> rows_of(const std::string& name) const {
        std::vector<std::vector<std::string>> rows;
        std::istringstream lines(text_of(name));
        for (std::string line; std::getline(lines, line);) {
            std::vector<std::string>& row = rows.emplace_back();
            std::istringstream fields(line);
            for (std::string field; std::getline(fields, field, ',');) row.push_back(field);
        }
        return rows;
    }

    /// Two CSV files have the same configurations, ids and joints to 1e-9 deg.
    void expect_same_joints(const std::string& a, const std::string& b) const {
        const auto first = rows_of(a);
        const auto second = rows_of(b);
        ASSERT_EQ(first.size(), second.size());
        for (std::size_t i = 1; i < first.size(); ++i) {
            EXPECT_EQ(first[i][0], second[i][0]);
            for (std::size_t j = 1; j <= 6; ++j) {
                EXPECT_NEAR(std::stod(first[i][j]), std::stod(second[i][j]), 1e-9) << first[i][0];
            }
        }
    }
};

TEST_F(ProgramCommand, WritesWhatIsReadBackForEveryController) {
    write_cell("other.yaml",
               "{joints: [-q1, q2 - 90 deg, 90 deg - q3 + q2, -q4, q5, -q6], pulses_per_deg: "
               "[1341.38, 1907.67, 1592.89, 1022.86, 980.24, 454.75]}");
    const std::pair<const char*, const char*> programs[] = {
        {"fanuc", "CELL.LS"},   {"kuka", "poses.src"},   {"abb", "cell.mod"},
        {"ur", "cell.script"},  {"yaskawa", "CELL.JBI"}, {"staubli", "cell"},
        {"ros2", "goals.yaml"}, {"csv", "cell.csv"}};
    for (const auto& [controller, file] : programs) {
        const std::string command =
            std::string("program p.json --campaign other.yaml --for ") + controller + ' ';
        write_text("p.as_sent.csv", "");  // instead of another controller's
        const std::string text = run_well(command + "-o " + file);
        EXPECT_NE(text.find("12 poses in "), std::string::npos) << text;
        EXPECT_NE(text.find("predicted RMS/mm: "), std::string::npos) << text;
        const std::string read = run_well(command + "--read " + file + " -o back.csv");
        EXPECT_EQ(read.find("dropped"), std::string::npos) << read;
        EXPECT_EQ(read.find("moved"), std::string::npos) << read;
        expect_same_joints("back.csv", "p.as_sent.csv");
        // Again, over what is there.
        run_well(command + "-o " + file);
    }
}

TEST_F(ProgramCommand, WritesThePlanAsItIsSent) {
    run_well("program p.json --for fanuc -o CELL.LS");
    const auto planned = rows_of("p.csv");
    const auto sent = rows_of("p.as_sent.csv");
    ASSERT_EQ(planned.size(), sent.size());
    EXPECT_EQ(planned[0], sent[0]);
    for (std::size_t i = 1; i < sent.size(); ++i) {
        const double q2 = std::stod(sent[i][2]);
        const double q3 = std::stod(sent[i][3]);
        for (const double joint : {q2, q3 - q2, std::stod(sent[i][6])}) {
            EXPECT_NEAR(1e3 * joint, std::round(1e3 * joint), 1e-6) << sent[i][0];
        }
        for (std::size_t j = 1; j <= 6; ++j) {
            EXPECT_NEAR(std::stod(sent[i][j]), std::stod(planned[i][j]), 2.1e-3);
        }
    }
    // The measurements are made there, and belong to the plan.
    run_well("simulate cell.yaml --configurations p.as_sent.csv -o m.csv");
    run_well("calibrate cell.yaml -m m.csv --plan p.json --folds 0 --prior");
    run_well("select cell.yaml --candidates p.as_sent.csv -k 6 --prior -o s.json");
    EXPECT_NE(run_well("program s.json --for csv -o s.csv").find("as sent"), std::string::npos);
}

TEST_F(ProgramCommand, SaysWhatIsDoneByHand) {
    EXPECT_EQ(run_well("program p.json --campaign cell.yaml --for fanuc -o a.ls").find("by hand"),
              std::string::npos);
    std::string text = text_of("cell.yaml");
    const std::string cell = "\ncell:\n";
    text.insert(text.find(cell) + cell.size(),
                "  target_change_s: 600\n  stations: 2\n  station_change_s: 900\n");
    write_text("hand.yaml", text);
    run_well("plan hand.yaml -k 10 --pool 600 --starts 1 --workspace-poses 30 -o hand.json");
    const auto plan = nlohmann::json::parse(text_of("hand.json"));
    EXPECT_EQ(plan.at("target_runs"), 3);
    EXPECT_GT(plan.at("duration_s"), 2 * (2 * 600 + 3 * plan.at("visiting_time_s").get<double>()));
    const std::string words = "3 runs, the reflector moved between them, all at each of 2 stations";
    EXPECT_NE(run_well("program hand.json --for fanuc -o b.ls").find("by hand: " + words + '\n'),
              std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(run_well("program hand.json --for fanuc -o b.ls --json"))
                  .at("by_hand"),
              words);
}

TEST_F(ProgramCommand, WaitsAsItIsTold) {
    const auto program = [&](const std::string& options) {
        run_well("program p.json --for fanuc -o A.ls " + options);
        return text_of("A.ls");
    };
    EXPECT_NE(program("").find("WAIT   2.00(sec)"), std::string::npos);
    const std::string io = program("--handshake io --dwell 3.5 --speed 45");
    EXPECT_NE(io.find("WAIT   3.50(sec)"), std::string::npos);
    EXPECT_NE(io.find("45% FINE"), std::string::npos);
    EXPECT_NE(io.find("DO[1]=ON ;"), std::string::npos);
    EXPECT_EQ(io.find("CNT"), std::string::npos);
    const std::string dry = program("--handshake pause --dry-run");
    EXPECT_EQ(dry.find("WAIT"), std::string::npos);
    EXPECT_EQ(dry.find("PAUSE"), std::string::npos);
    EXPECT_NE(dry.find("10% FINE"), std::string::npos);
    const std::string text = run_well("program p.json --for fanuc -o A.ls --repeats 2 --reverse");
    EXPECT_NE(text.find("24 poses in "), std::string::npos) << text;
    run_well("program p.json --for fanuc --read A.ls -o back.csv");
    expect_same_joints("back.csv", "p.as_sent.csv");
}

TEST_F(ProgramCommand, VisitsAReferencePoseAgain) {
    const std::string text = run_well("program p.json --for csv -o a.csv --reference p1 --every 4");
    const auto rows = rows_of("p.as_sent.csv");
    std::vector<std::string> ids;
    std::vector<std::string> reference;
    for (const auto& row : rows) {
        if (row[0] == "p1") reference = {row.begin() + 1, row.begin() + 7};
    }
    int others = 0;
    int visits = 0;
    for (std::size_t i = 1; i < rows.size(); ++i) {
        if (rows[i].back() == "via") continue;
        if (rows[i][0].rfind("ref", 0) == 0) {
            ++visits;
            EXPECT_EQ(rows[i][0], "ref" + std::to_string(visits));
            EXPECT_EQ((std::vector<std::string>{rows[i].begin() + 1, rows[i].begin() + 7}),
                      reference);
            EXPECT_LE(others, 4);
            others = 0;
        } else {
            others = rows[i][0] == "p1" ? 0 : others + 1;
        }
    }
    EXPECT_GE(visits, 2);
    EXPECT_NE(text.find(std::to_string(12 + visits) + " poses in "), std::string::npos) << text;
    EXPECT_NE(run_well("program p.json --for csv --read a.csv")
                  .find("poses of the plan under another name: ref1 (at p1), "),
              std::string::npos);
    const std::string read =
        run_well("program p.json --for csv --read a.csv --reference p1 --every 4");
    EXPECT_EQ(read.find("not of the plan"), std::string::npos) << read;
    // Measured there, they are configurations of their own, which drift is seen by.
    run_well("simulate cell.yaml --configurations p.as_sent.csv -o m.csv");
    const auto drift = [&](const std::string& name) {
        const Outcome outcome = run("calibrate cell.yaml -m " + name + " --folds 0 --prior --json");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        const auto document = nlohmann::json::parse(outcome.out);
        for (const auto& answer : document.at("answers")) {
            if (answer.at("key") == "drift") return answer.at("text").get<std::string>();
        }
        return std::string();
    };
    EXPECT_EQ(drift("m.csv").rfind("none ", 0), 0U) << drift("m.csv");
    // The instrument drifts by 2 mm along z.
    std::string drifting;
    std::istringstream lines(text_of("m.csv"));
    std::vector<std::string> measured;
    for (std::string line; std::getline(lines, line);) {
        if (line[0] != '#') measured.push_back(line);
    }
    const auto header = measured.front();
    std::vector<bool> is_z;
    std::istringstream names(header);
    for (std::string name; std::getline(names, name, ',');) is_z.push_back(name.ends_with("_z_mm"));
    for (std::size_t i = 0; i < measured.size(); ++i) {
        std::istringstream fields(measured[i]);
        std::size_t column = 0;
        for (std::string field; std::getline(fields, field, ','); ++column) {
            if (i > 0 && is_z[column] && !field.empty()) {
                const double part = static_cast<double>(i) / static_cast<double>(measured.size());
                field = std::to_string(std::stod(field) + 2 * part);
            }
            drifting += (column == 0 ? "" : ",") + field;
        }
        drifting += measured[i].ends_with(',') ? ",\n" : "\n";
    }
    write_text("drift.csv", drifting);
    const std::string found = drift("drift.csv");
    EXPECT_NE(found.find("yes, residuals follow the order of the measurements: z changes by "),
              std::string::npos)
        << found;
    EXPECT_NE(found.find(" mm from first to last (sigma "), std::string::npos) << found;
    expect_input_error("program p.json --for csv -o b.csv --reference p99",
                       "p.json: has no pose to calibrate with called 'p99'");
    EXPECT_EQ(run("program p.json --for csv -o b.csv --every 3").code, 2);
}

TEST_F(ProgramCommand, SaysWhichPosesAnEditedProgramHasNot) {
    run_well("program p.json --for csv -o a.csv");
    std::string text = text_of("a.csv");
    const std::size_t at = text.find("\np3,");
    text.erase(at, text.find('\n', at + 1) - at);
    write_text("edited.csv", text);
    const std::string said = run_well("program p.json --for csv --read edited.csv -o back.csv");
    EXPECT_NE(said.find("dropped: p3\n"), std::string::npos) << said;
    EXPECT_NE(said.find("--plan p.json --drop p3\n"), std::string::npos) << said;
    EXPECT_EQ(run_well("program cell.yaml --for csv --read edited.csv").find("dropped"),
              std::string::npos);
    const auto document =
        nlohmann::json::parse(run_well("program p.json --for csv --read edited.csv --json"));
    EXPECT_EQ(document.at("dropped"), std::vector<std::string>{"p3"});
}

TEST_F(ProgramCommand, SaysWhatMovedAndWhatNoLongerFits) {
    run_well("program p.json --for csv -o a.csv --campaign cell.yaml");
    const auto rows = rows_of("a.csv");
    std::size_t pose = 1;
    while (rows[pose][0] != "p3") ++pose;
    const auto edited = [&](double j1, double j6) {
        std::string text;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            for (std::size_t j = 0; j < rows[i].size(); ++j) {
                std::string field = rows[i][j];
                if (i == pose && j == 1) field = std::to_string(std::stod(field) + j1);
                if (i == pose && j == 6) field = std::to_string(std::stod(field) + j6);
                text += (j == 0 ? "" : ",") + field;
            }
            text += '\n';
        }
        write_text("edited.csv", text);
        return run("program p.json --for csv --read edited.csv");
    };
    const Outcome near = edited(0.25, -0.5);
    EXPECT_EQ(near.code, 0) << near.err;
    EXPECT_NE(near.out.find("moved: p3 (J6 by -0.5 deg at most)\n"), std::string::npos) << near.out;
    const Outcome far = edited(0.25, 1000);
    EXPECT_EQ(far.code, 0) << far.err;
    EXPECT_NE(far.err.find("pose 'p3' is beyond the joint limits"), std::string::npos) << far.err;
    EXPECT_NE(far.err.find("q6 is "), std::string::npos) << far.err;
    const auto document =
        nlohmann::json::parse(run("program p.json --for csv --read edited.csv --json").out);
    EXPECT_EQ(document.at("moved").at(0).at("joint"), "J6");
    EXPECT_NEAR(document.at("moved").at(0).at("by_deg").get<double>(), 1000, 1e-5);
    EXPECT_EQ(document.at("faults").size(), 1U);
}

TEST_F(ProgramCommand, SaysWhatItReplaces) {
    EXPECT_EQ(run("program p.json --for csv -o a.csv").err, "");
    EXPECT_EQ(run("program p.json --for csv -o a.csv --speed 30").code, 2);
    EXPECT_EQ(run("program p.json --for csv -o a.csv").err, "");
    const Outcome other = run("program p.json --for fanuc -o A.ls --speed 30%");
    EXPECT_EQ(other.code, 0) << other.err;
    EXPECT_NE(other.err.find("p.as_sent.csv: held other joint values"), std::string::npos)
        << other.err;
    EXPECT_NE(text_of("A.ls").find("30% FINE"), std::string::npos);
}

TEST_F(ProgramCommand, WarnsWhereNobodySaysHowAFanucCountsJ3) {
    const std::string warning = "most FANUCs count J3 from the ground";
    write_cell("plain.yaml", "{}");
    const Outcome unstated = run("program p.json --campaign plain.yaml --for fanuc -o A.ls");
    EXPECT_NE(unstated.err.find(warning), std::string::npos) << unstated.err;
    const Outcome read = run("program plain.yaml --for fanuc --read A.ls");
    EXPECT_NE(read.err.find(warning), std::string::npos) << read.err;
    write_cell("stated.yaml", "{maker: fanuc, j23_factor: 0}");
    for (const std::string other :
         {"plain.yaml --for abb -o a.mod", "stated.yaml --for fanuc -o B.ls"}) {
        const Outcome stated = run("program p.json --campaign " + other);
        EXPECT_EQ(stated.code, 0) << stated.err;
        EXPECT_EQ(stated.err.find(warning), std::string::npos) << stated.err;
    }
}

/// Limits between two of the program's thousandths of a degree.
TEST_F(ProgramCommand, RefusesJointsThatNoDigitsReach) {
    std::string cell = text_of("cell.yaml");
    for (const auto& [from, to] :
         {std::pair{"q6: {limits_deg: [-180, 180]}", "q6: {limits_deg: [0.0002, 0.0004]}"},
          std::pair{"margin_deg: 2", "margin_deg: 0"},
          std::pair{"home_deg: [0, -30, 0, 0, 0, 0]", "home_deg: [0, -30, 0, 0, 0, 0.0003]"}}) {
        ASSERT_NE(cell.find(from), std::string::npos) << from;
        cell.replace(cell.find(from), std::string(from).size(), to);
    }
    write_text("narrow.yaml", cell);
    EXPECT_EQ(run("plan narrow.yaml -k 10 --prior --pool 600 --starts 1 --workspace-poses 30 -o "
                  "narrow.json")
                  .code,
              0);
    expect_input_error("program narrow.json --for fanuc -o A.ls",
                       "narrow.json: pose 'p1' is right, but no joint values next to it are in the "
                       "program's digits");
}

TEST_F(ProgramCommand, RefusesWhatNoRobotShouldDo) {
    write_cell("plain.yaml", "{}");
    expect_input_error("program p.json --campaign plain.yaml --for yaskawa -o A.jbi",
                       "plain.yaml: controller.pulses_per_deg is not stated");
    expect_input_error("program p.json --for ros2 -o a.yaml",
                       "cell.yaml: controller.maker is fanuc, the program is for ros2");
    expect_input_error("program p.json --for fanuc -o 'my cell.ls'", "must be like MY_CELL.ls");
    expect_input_error("program p.json --for csv -o a.csv --handshake pause", "no handshake pause");
    expect_input_error("program p.json --campaign plain.yaml --for staubli -o none/cell",
                       "none/cell");
    expect_input_error("program p.json --for csv -o p.as_sent.csv", "p.as_sent.csv");
    expect_input_error("program p.json --for fanuc -o A.ls --campaign " + fanuc_design,
                       "p.json: campaign: is 'FANUC R-2000iC/165F in a cell'");
    expect_input_error("program p.json --for fanuc --read p.csv", "has no /POS");
    expect_input_error("program p.json --for csv --read cell.yaml", "cell.yaml");

    // Limits that were narrowed since.
    std::string cell = text_of("cell.yaml");
    const std::string limits = "q1: {limits_deg: [-90, 90]}";
    cell.replace(cell.find(limits), limits.size(), "q1: {limits_deg: [-12, 12]}");
    write_text("narrow.yaml", cell);
    expect_input_error("program p.json --for fanuc -o A.ls --campaign narrow.yaml", "must be from");

    std::string plan = text_of("p.json");
    const std::string free = "\"way_is_blocked\": false";
    ASSERT_NE(plan.find(free), std::string::npos) << plan.substr(0, 3000);
    plan.replace(plan.find(free), free.size(), "\"way_is_blocked\": true");
    write_text("blocked.json", plan);
    expect_input_error("program blocked.json --for fanuc -o A.ls",
                       "is BLOCKED; plan again with more room, or without it: --drop");

    // A joint that is no number, in a plan and in a program; a name at two places.
    std::string broken = text_of("p.json");
    const std::string joint = "\"q1_rad\": ";
    ASSERT_NE(broken.find(joint), std::string::npos) << broken.substr(0, 3000);
    broken.replace(broken.find(joint), joint.size(), joint + "NaN ");
    write_text("nan.json", broken);
    expect_input_error("program nan.json --for fanuc -o A.ls", "nan.json:");
    write_text("nan.csv", "name,J1_deg,J2_deg,J3_deg,J4_deg,J5_deg,J6_deg\np1,0,nan,0,0,0,0\n");
    expect_input_error("program p.json --for csv --read nan.csv -o back.csv", "nan.csv:2:6: ");
    write_text("twice.csv",
               "name,J1_deg,J2_deg,J3_deg,J4_deg,J5_deg,J6_deg\np1,0,0,0,0,0,0\np1,9,0,0,0,0,0\n");
    expect_input_error("program p.json --for csv --read twice.csv -o back.csv",
                       "twice.csv:3:1: visits 'p1' at other joints than before");

    write_cell("singular.yaml", "{joints: {J3: q2}}");
    expect_input_error("program p.json --for fanuc -o A.ls --campaign singular.yaml",
                       "their matrix is singular");
}

}  // namespace
}  // namespace posewise::testing
