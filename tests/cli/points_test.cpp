#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>
#include <random>

#include "program.hpp"

/// From the instrument to measurements: its list of targets, and points that it measured, joined
/// with the plan.
namespace posewise::testing {
namespace {

using Json = nlohmann::json;

const std::string arm = "name: arm\nrobot:\n  errors: geometric\n" + six_joints;
const std::string tracker =
    R"(base: {position_mm: [1500, 200, -300], rpy_deg: [0, 0, 90]}
sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[90, 0, 60], [90, 80, -30], [150, -70, 20]]}}
)";
const std::string quick = " -c d --pool 300 --starts 1 --workspace-poses 20 ";

struct Point {
    std::string name;
    std::string x, y, z;
};

class Points : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_text("c.yaml", arm + tracker);
        run_well("plan c.yaml -k 18" + quick +
                 "--verification 3 -o plan.json --csv poses.csv --targets targets.csv");
        run_well("simulate c.yaml --configurations poses.csv -o m.csv");
        std::istringstream lines(text_of("m.csv"));
        std::vector<std::string> header;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] == '#') continue;
            std::vector<std::string> cells;
            std::istringstream row(line);
            for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
            if (header.empty()) {
                header = cells;
                continue;
            }
            for (std::size_t target = 0; target < 3; ++target) {
                const std::size_t at = 8 + 3 * target;
                points_.push_back({cells[0] + "_t" + std::to_string(target + 1), cells[at],
                                   cells[at + 1], cells[at + 2]});
            }
        }
        shuffled_ = points_;
        std::shuffle(shuffled_.begin(), shuffled_.end(), std::mt19937(7));
    }

    /// P001_T1 for p1_t1.
    static std::string usual(const std::string& name) {
        const auto bar = name.find('_');
        const std::string number = name.substr(1, bar - 1);
        return std::string(1, static_cast<char>(std::toupper(name[0]))) +
               std::string(3 - number.size(), '0') + number + "_T" + name.substr(bar + 2);
    }
    void write_list(const std::string& name, const std::vector<Point>& points,
                    const std::function<std::string(const Point&)>& row,
                    const std::string& head = "") const {
        std::string text = head;
        for (const Point& point : points) text += row(point) + '\n';
        write_text(name, text);
    }
    /// The result but for what names the file.
    Json result_of(const std::string& arguments) const {
        const Outcome outcome = run("calibrate c.yaml -m " + arguments + " --json");
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        Json document = Json::parse(outcome.out);
        for (const char* const key : {"made_from", "measurements", "warnings"}) document.erase(key);
        return document;
    }

    std::vector<Point> points_;
    std::vector<Point> shuffled_;
};

TEST_F(Points, OfEachFormatGiveTheEstimateOfATable) {
    const auto blanks = [](const Point& p) { return p.name + ' ' + p.x + "  " + p.y + ' ' + p.z; };
    write_list("plain.txt", shuffled_, blanks);
    write_list(
        "analyzer.txt", shuffled_,
        [](const Point& p) {
            return "Cell::Main::" + usual(p.name) + ", " + p.x + ", " + p.y + ", " + p.z;
        },
        "// SA\n// X, Y, Z\n");
    write_list("groups.txt", shuffled_, [](const Point& p) {
        return "Cell\tMain group\t" + usual(p.name) + '\t' + p.x + '\t' + p.y + '\t' + p.z;
    });
    write_list(
        "works.csv", shuffled_,
        [](const Point& p) { return usual(p.name) + ",0.1," + p.x + ',' + p.y + ',' + p.z; },
        "Name,Dev,X [mm],Y [mm],Z [mm]\n");
    write_list("order.txt", points_, [](const Point& p) { return p.x + ';' + p.y + ';' + p.z; });
    const Json expected = result_of("m.csv --plan poses.csv");
    for (const std::string list :
         {"plain.txt --points-unit mm", "analyzer.txt --points-unit mm",
          "groups.txt --points-unit mm", "works.csv", "order.txt --points-unit mm"}) {
        EXPECT_EQ(result_of(list + " --plan poses.csv"), expected) << list;
    }
    // The table has the joints of poses.csv, which are those of the plan to twelve digits.
    const Json planned = result_of("plain.txt --plan plan.json --points-unit mm");
    const char* const rms = "/accuracy/fit/distance_rms_mm";
    EXPECT_NEAR(planned.at(Json::json_pointer(rms)).get<double>(),
                expected.at(Json::json_pointer(rms)).get<double>(), 1e-9);
    EXPECT_EQ(run("calibrate c.yaml -m works.csv --plan plan.json").err,
              "posewise: warning: works.csv: column 'Dev' is not used\n");
    EXPECT_EQ(
        run("calibrate c.yaml -m order.txt --points-unit mm --plan plan.json").err,
        "posewise: warning: order.txt: no name is one of the plan's, so they are taken in its "
        "order: 21 of 21 poses\n");
}

TEST_F(Points, MayBeMissing) {
    const auto is_missing = [](const std::string& name) {
        return name.starts_with("p4_") || name.starts_with("p9_") || name == "p5_t2" ||
               name == "v1_t3";
    };
    std::vector<Point> left = shuffled_;
    std::erase_if(left, [&](const Point& p) { return is_missing(p.name); });
    write_list("some.txt", left,
               [](const Point& p) { return p.name + ',' + p.x + ',' + p.y + ',' + p.z; });
    // The same of the table.
    std::string text;
    std::istringstream lines(text_of("m.csv"));
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("p4,") || line.starts_with("p9,")) continue;
        for (const auto& [id, target] : {std::pair("p5,", 2), std::pair("v1,", 3)}) {
            if (!line.starts_with(id)) continue;
            std::vector<std::string> cells;
            std::istringstream row(line);
            for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
            line.clear();
            const std::size_t first = 8 + 3 * (static_cast<std::size_t>(target) - 1);
            for (std::size_t k = 0; k < cells.size(); ++k) {
                line += (k > 0 ? "," : "") + (k >= first && k < first + 3 ? "" : cells[k]);
            }
        }
        text += line + '\n';
    }
    write_text("some.csv", text);
    EXPECT_EQ(result_of("some.txt --points-unit mm --plan poses.csv"),
              result_of("some.csv --plan poses.csv"));
    EXPECT_EQ(run("calibrate c.yaml -m some.txt --points-unit mm --plan plan.json").err,
              "posewise: warning: some.txt: 19 of 21 poses, without 'p4', 'p9', 2 points missing: "
              "P005_T2, V001_T3\n");
}

TEST_F(Points, ServeEveryCommandThatTakesMeasurements) {
    write_list(
        "p.csv", shuffled_,
        [](const Point& p) { return p.name + ',' + p.x + ',' + p.y + ',' + p.z; },
        "name,x_mm,y_mm,z_mm\n");
    EXPECT_EQ(run_well("inspect c.yaml -m p.csv --plan poses.csv"),
              run_well("inspect c.yaml -m m.csv"));
    EXPECT_EQ(run_well("indices c.yaml -m p.csv --plan poses.csv"),
              run_well("indices c.yaml -m m.csv --plan poses.csv"));
    const std::string study = " --splits 2 --random 2 --starts 1 -k 8 -c d --prior";
    EXPECT_EQ(run("study c.yaml -m p.csv --plan poses.csv" + study).out,
              run("study c.yaml -m m.csv" + study).out);
    run_well("calibrate c.yaml -m p.csv --plan plan.json -o e.json");
    EXPECT_NE(run_well("report e.json -o e.html").find("residuals"), std::string::npos);
    run_well("calibrate c.yaml -m m.csv --validate p.csv --plan plan.json -o e.json");
}

TEST_F(Points, AreChosenFromAndCountAsMeasured) {
    const auto row = [](const Point& p) { return p.name + ',' + p.x + ',' + p.y + ',' + p.z; };
    write_list("p.csv", shuffled_, row);
    const std::string head = "name,x_mm,y_mm,z_mm\n";
    std::vector<Point> few = shuffled_;
    std::erase_if(few, [](const Point& p) { return p.name[0] != 'v'; });
    write_list("few.csv", few, row, head);
    std::string table;
    std::istringstream lines(text_of("m.csv"));
    for (std::string line; std::getline(lines, line);) {
        if (line[0] != 'p') table += line + '\n';
    }
    write_text("few_table.csv", table);
    const auto plan_of = [&](const std::string& arguments, const std::string& out) {
        // Warned of are poses of the plan that were not measured, which is meant.
        const Outcome outcome =
            run("select c.yaml -c d --starts 1 -k 6 --prior " + arguments + " -o " + out);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        Json plan = Json::parse(text_of(out));
        return std::pair(plan.at("poses"), plan.at("value"));
    };
    const std::string joined = "-m p.csv --plan poses.csv --points-unit mm";
    EXPECT_EQ(plan_of(joined, "a.json"), plan_of("-m m.csv", "b.json"));
    EXPECT_EQ(plan_of("--candidates poses.csv --augment few.csv --plan poses.csv", "c.json"),
              plan_of("--candidates poses.csv --augment few_table.csv", "d.json"));
    EXPECT_NE(plan_of("--candidates poses.csv", "e.json"),
              plan_of("--candidates poses.csv --augment few.csv --plan poses.csv", "c.json"));
    // The unit is that of the list, beside a table that has its own.
    write_list("bare.txt", shuffled_, row);
    write_list("bare_few.txt", few, row);
    const std::string unit = " --plan poses.csv --points-unit mm";
    EXPECT_EQ(plan_of("-m m.csv --augment bare_few.txt" + unit, "f.json"),
              plan_of("-m m.csv --augment few_table.csv", "g.json"));
    EXPECT_EQ(plan_of("-m bare.txt --augment few_table.csv" + unit, "f.json"),
              plan_of("-m m.csv --augment few_table.csv", "g.json"));
    run_well(
        "calibrate c.yaml -m m.csv --validate bare.txt --points-unit mm --plan plan.json -o "
        "h.json");
    expect_input_error("select c.yaml -m m.csv --augment few_table.csv -k 6 -o i.json" + unit,
                       "m.csv: has units of its own; --points-unit must be left out");
    expect_input_error(
        "select c.yaml --candidates poses.csv --augment few_table.csv --plan poses.csv -k 6 -o "
        "i.json",
        "few_table.csv: has joint values of its own; --plan must be left out");
    const auto planned = [&](const std::string& augment, const std::string& out) {
        const Outcome outcome =
            run("plan c.yaml -k 4 --prior" + quick + "--augment " + augment + " -o " + out);
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return Json::parse(text_of(out)).at("poses");
    };
    EXPECT_EQ(planned("bare_few.txt --augment-plan poses.csv --points-unit mm", "j.json"),
              planned("few_table.csv", "k.json"));
    expect_input_error(
        "plan c.yaml -k 4 --augment few_table.csv --augment-plan poses.csv -o l.json",
        "few_table.csv: has joint values of its own; --augment-plan must be left");
    EXPECT_EQ(run("plan c.yaml -k 4 --augment-plan poses.csv").code, 2);
    expect_input_error(
        "plan c.yaml --plan plan.json --drop p2 --augment few.csv --augment-plan plan.json -o "
        "l.json",
        "would count twice; --augment must be left out");
    EXPECT_NE(run("plan c.yaml -k 4 --prior" + quick +
                  "--augment few.csv --augment-plan plan.json -o l.json")
                  .err.find("few.csv: 3 of 3 poses were set aside to verify"),
              std::string::npos);
    for (const std::string plan : {"a.json", "j.json", "c.json", "f.json"})
        EXPECT_EQ(run("verify " + plan).code, 0);
    run_well("report a.json -o a.html");
    expect_input_error("select c.yaml -m p.csv -k 6 -o f.json", "p.csv");
    expect_input_error("select c.yaml -m m.csv --plan poses.csv -k 6 -o f.json",
                       "m.csv: has joint values of its own; --plan must be left out");
    EXPECT_EQ(run("select c.yaml --random 50 --plan poses.csv -k 6 -o f.json").code, 2);
    EXPECT_EQ(run("select c.yaml -m p.csv --points-unit mm -k 6 -o f.json").code, 2);
}

/// Two plans, whose poses may have the same ids: the points of both are those of one table.
TEST_F(Points, OfSeveralPlansAreCalibratedTogether) {
    const auto row = [](const Point& p) { return p.name + ' ' + p.x + ' ' + p.y + ' ' + p.z; };
    std::vector<std::string> lines;
    std::istringstream table(text_of("m.csv"));
    for (std::string line; std::getline(table, line);) {
        if (line[0] != '#') lines.push_back(line);
    }
    // The first 13 of the 21 poses, the others called p1 to p8 again.
    std::vector<Point> first, second;
    for (std::size_t k = 0; k < points_.size(); ++k) {
        const std::size_t pose = k / 3 + 1;
        Point& point = (pose <= 13 ? first : second).emplace_back(points_[k]);
        point.name = fmt::format("p{}_t{}", pose <= 13 ? pose : pose - 13, k % 3 + 1);
    }
    write_list("old.txt", first, row);
    write_list("new.txt", second, row);
    std::string old_plan = lines[0] + '\n', new_plan = old_plan, both = old_plan;
    for (std::size_t i = 1; i < lines.size(); ++i) {
        const std::string rest = lines[i].substr(lines[i].find(','));
        const std::string id = fmt::format("p{}", i <= 13 ? i : i - 13);
        (i <= 13 ? old_plan : new_plan) += id + rest + '\n';
        both += fmt::format("{}/{}{}\n", i <= 13 ? "old" : "new", id, rest);
    }
    write_text("old.csv", old_plan);
    write_text("new.csv", new_plan);
    write_text("both.csv", both);
    const std::string unit = " --points-unit mm";
    const std::string pairs = "old.txt --plan old.csv -m new.txt --plan new.csv";
    EXPECT_EQ(result_of(pairs + unit), result_of("both.csv"));
    EXPECT_EQ(result_of(pairs + unit + " --exclude new/p2"),
              result_of("both.csv --exclude new/p2"));
    EXPECT_EQ(result_of("old.csv --plan old.csv -m new.txt --plan new.csv" + unit),
              result_of("both.csv"))
        << "a table beside a list";
    run_well("calibrate c.yaml -m " + pairs + unit + " -o e.json");
    const Outcome page = run("report e.json -o e.html");
    EXPECT_NE(page.out.find("residuals"), std::string::npos) << page.err;
    const auto refused = [&](const std::string& arguments, const std::string& words) {
        expect_input_error("calibrate c.yaml -m " + arguments + unit + " -o f.json", words);
    };
    refused("old.txt -m new.txt --plan old.csv", "--measurements is stated 2 times, --plan once");
    refused("old.txt --plan old.csv --plan new.csv",
            "--measurements is stated once, --plan 2 times");
    refused("old.txt --plan old.csv -m new.txt --plan old.csv", "old.csv: is stated twice");
    refused("old.txt --plan old.csv -m old.txt --plan new.csv", "old.txt: is stated twice");
    write_list("copy.txt", first, row);
    write_text("copy.csv", old_plan);
    refused("old.txt --plan old.csv -m copy.txt --plan copy.csv",
            "copy.txt: has the same readings as old.txt");
    // Two lists that the same points name: plan says how to go on.
    write_list(
        "p.csv", shuffled_,
        [](const Point& p) { return p.name + ',' + p.x + ',' + p.y + ',' + p.z; },
        "name,x_mm,y_mm,z_mm\n");
    const Outcome planned = run("plan c.yaml -k 4" + quick +
                                "--augment p.csv --augment-plan plan.json -o more.json --json");
    EXPECT_NE(planned.out.find("-m p.csv --plan plan.json -m POINTS --plan PLAN"),
              std::string::npos)
        << planned.out;
}

TEST_F(Points, WhatIsWrongIsSaidAndNothingWritten) {
    const auto row = [](const Point& p) { return p.name + ' ' + p.x + ' ' + p.y + ' ' + p.z; };
    write_list("p.txt", shuffled_, row);
    const std::string out = " -o e.json";
    expect_input_error("calibrate c.yaml -m p.txt" + out,
                       "p.txt: is a list of points without joint values; must come with the plan "
                       "whose poses were measured (--plan of calibrate, indices, inspect, select "
                       "and study, --augment-plan of plan), or be a table with the column "
                       "config\n");
    expect_input_error(
        "calibrate c.yaml -m p.txt --plan plan.json" + out,
        "p.txt: does not state the unit of its points; state --points-unit, or x_mm, "
        "y_mm, z_mm in a header; they are as far apart as planned if it is mm\n");
    expect_input_error("calibrate c.yaml -m m.csv --points-unit mm" + out,
                       "m.csv: has units of its own; --points-unit must be left out\n");
    expect_input_error("inspect c.yaml -m m.csv --plan plan.json",
                       "m.csv: has joint values of its own; --plan must be left out\n");
    write_list("more.txt", points_, row, "nest1 1 2 3\n");
    expect_input_error("calibrate c.yaml -m more.txt --points-unit mm --plan plan.json" + out,
                       "more.txt:1:1: 'nest1' is no point of the plan; must be one, such as "
                       "P001_T1, or be left out\n");
    const Point& first = points_.front();
    write_list("twice.txt", points_, row, first.name + " 1 2 3\n");
    expect_input_error("calibrate c.yaml -m twice.txt --points-unit mm --plan plan.json" + out,
                       "twice.txt:2:1: '" + first.name +
                           "' is point P001_T1 once more, which line 1 has; keep one");
    write_list("nan.txt", points_, row, "p99_t1 nan 2 3\n");
    expect_input_error("calibrate c.yaml -m nan.txt --points-unit mm --plan plan.json" + out,
                       "nan.txt:1:8: 'nan' is not finite; must be a finite number");
    write_list(
        "order.txt", points_, [](const Point& p) { return p.x + ' ' + p.y + ' ' + p.z; },
        "1 2 3\n");
    expect_input_error("calibrate c.yaml -m order.txt --points-unit mm --plan plan.json" + out,
                       "order.txt:1:1: no name is one of the plan's, such as P001_T1, and in order "
                       "64 points cannot be the plan's 63; name them as the plan does, or leave "
                       "none out\n");
    write_text("other.yaml", "name: other\n" + (arm + tracker).substr(arm.find('\n') + 1));
    expect_input_error("calibrate other.yaml -m p.txt --points-unit mm --plan plan.json" + out,
                       "plan.json: campaign: is 'arm'; must be a plan of 'other'\n");
    EXPECT_EQ(run("calibrate c.yaml -m p.txt --plan plan.json --points-unit ft").code, 2);
    EXPECT_EQ(run("inspect c.yaml --plan plan.json").code, 2);
}

TEST_F(Points, TargetsOfAPlanThatIsThereAlready) {
    run_well("verify plan.json --targets again.csv");
    EXPECT_EQ(text_of("again.csv"), text_of("targets.csv"));
    EXPECT_EQ(std::ranges::count(text_of("targets.csv"), '\n'), 1 + 21 * 3);
    EXPECT_TRUE(text_of("targets.csv").starts_with("name,x_mm,y_mm,z_mm,range_mm,"));
    EXPECT_NE(text_of("targets.csv").find("\nV003_T3,"), std::string::npos);
    std::filesystem::remove(folder_ / "again.csv");
    expect_input_error("verify plan.json --targets plan.json",
                       "plan.json: is read and shall be written; must be another file");
    Json plan = Json::parse(text_of("plan.json"));
    plan["value"] = plan["value"].get<double>() + 1;
    write_text("changed.json", plan.dump());
    const Outcome changed = run("verify changed.json --targets again.csv");
    EXPECT_EQ(changed.code, 1);
    EXPECT_FALSE(has_file("again.csv")) << "of a plan that is not as stated";
}

TEST_F(Points, AreForSensorsOfPointsOnly) {
    write_text("poses.yaml", arm + measured_poses);
    expect_input_error("plan poses.yaml -k 12" + quick + "--targets t.csv -o p.json",
                       "t.csv: is not written: there is a list of targets only where a sensor "
                       "measures points, as a laser tracker does (kind: points)\n");
    write_text("p.txt", "P001_T1 1 2 3\n");
    expect_input_error("calibrate poses.yaml -m p.txt",
                       "p.txt: is a list of points, which is read where the sensor measures points "
                       "and no torques are measured; must be a table with the column config\n");
}

TEST_F(Points, ATableMayHaveMoreColumns) {
    std::string text;
    std::istringstream lines(text_of("m.csv"));
    for (std::string line; std::getline(lines, line);) {
        if (line[0] != '#') text += line + (text.empty() ? ",clock,rms_um\n" : ",12:00,21\n");
    }
    write_text("more.csv", text);
    EXPECT_EQ(run("calibrate c.yaml -m more.csv").err,
              "posewise: warning: more.csv: columns 'clock', 'rms_um' are not used\n");
    EXPECT_EQ(result_of("more.csv"), result_of("m.csv"));
}

TEST_F(Points, TimesAndTemperaturesAreLookedForInTheResiduals) {
    std::string text;
    std::istringstream lines(text_of("m.csv"));
    int row = 0;
    for (std::string line; std::getline(lines, line);) {
        if (line[0] == '#') continue;
        if (text.empty()) {
            text = line + ",time,temperature_C\n";
            continue;
        }
        ++row;
        text += line + fmt::format(",2026-01-31 {:02}:{:02}:00,{}\n", 23 - row % 2, row % 60,
                                   21 + 0.1 * (row % 7));
    }
    write_text("more.csv", text);
    const Outcome outcome = run("calibrate c.yaml -m more.csv -o e.json");
    EXPECT_EQ(outcome.err, "");
    const auto document = nlohmann::json::parse(text_of("e.json"));
    const auto& trends = document.at("accuracy").at("condition_trends");
    ASSERT_EQ(trends.size(), 2U);
    EXPECT_EQ(trends[0].at("unit"), "h");
    EXPECT_NEAR(trends[1].at("range").get<double>(), 0.6, 1e-9);
    EXPECT_EQ(trends[1].at("axes").size(), 3U);
    for (const auto& answer : document.at("answers")) {
        if (answer.at("key") != "drift") continue;
        for (const char* const words :
             {"by the time (", "by the temperature (0.6 C)", " mm per C (sigma "}) {
            EXPECT_NE(answer.at("text").get<std::string>().find(words), std::string::npos)
                << answer;
        }
    }
    for (const auto& axis : trends[1].at("axes")) {
        EXPECT_GT(axis.at("sigma_mm"), 0);
        EXPECT_GT(axis.at("detectable_mm"), 1.9 * axis.at("sigma_mm").get<double>());
    }
    // One cell that is no number: the column is passed over.
    write_text("more.csv", text.replace(text.rfind(",21") + 1, 2, "warm"));
    EXPECT_NE(run("calibrate c.yaml -m more.csv").err.find("column 'temperature_C' is not used"),
              std::string::npos);
}

/// The first and the others of the poses, each with times of its own, and the same in one table.
TEST_F(Points, TimesOfSeveralPlansAreLookedForWhereTheyAreOfOneClock) {
    const auto write_parts = [&](const std::string& first_time, const std::string& second_time) {
        std::string parts[3], plans[2];
        std::istringstream lines(text_of("m.csv"));
        int row = 0;
        for (std::string line; std::getline(lines, line);) {
            if (line[0] == '#') continue;
            if (row++ == 0) {
                for (std::string& part : parts) part = line + ",time\n";
                for (std::string& plan : plans) plan = line + '\n';
                continue;
            }
            const std::size_t comma = line.find(',');
            const bool is_first = row <= 14;
            const std::string rest = line.substr(comma) + ',' +
                                     (is_first ? first_time : second_time) +
                                     fmt::format("{:02}\n", (row * 7) % 60);
            plans[is_first ? 0 : 1] += line + '\n';
            parts[is_first ? 0 : 1] += line.substr(0, comma) + rest;
            parts[2] += (is_first ? "old/" : "new/") + line.substr(0, comma) + rest;
        }
        write_text("first.csv", parts[0]);
        write_text("second.csv", parts[1]);
        write_text("old.csv", plans[0]);
        write_text("new.csv", plans[1]);
        write_text("both.csv", parts[2]);
    };
    const std::string pairs = "-m first.csv --plan old.csv -m second.csv --plan new.csv";
    write_parts("2026-01-31 12:", "2026-01-31 14:");
    const Outcome dated = run("calibrate c.yaml " + pairs + " -o dated.json");
    EXPECT_EQ(dated.err, "");
    const auto trends_of = [&](const std::string& arguments) {
        run_well("calibrate c.yaml " + arguments + " -o e.json");
        return nlohmann::json::parse(text_of("e.json")).at("accuracy").at("condition_trends");
    };
    const auto apart = trends_of(pairs);
    const auto together = trends_of("-m both.csv");
    ASSERT_EQ(apart.size(), 1U);
    ASSERT_EQ(together.size(), 1U);
    EXPECT_GT(apart[0].at("range"), 2);
    EXPECT_NEAR(apart[0].at("range"), together[0].at("range"), 1e-12);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(apart[0].at("axes")[axis].at("change_mm"),
                    together[0].at("axes")[axis].at("change_mm"), 1e-9);
    }
    write_parts("12:", "12:");
    const Outcome two_clocks = run("calibrate c.yaml " + pairs);
    EXPECT_NE(two_clocks.err.find("first.csv, second.csv: time is not shown to be of one clock"),
              std::string::npos)
        << two_clocks.err;
    EXPECT_EQ(two_clocks.out.find("by the time"), std::string::npos);
}

TEST_F(Points, WhoMeasuredStandsInTheEstimate) {
    write_text("r.yaml", text_of("c.yaml") + "record: {operator: A. Smith, temperature_C: 21.5}\n");
    const std::string text = run_well("calibrate r.yaml -m m.csv -o r.json");
    EXPECT_NE(text.find("\noperator: A. Smith, temperature_C: 21.5\n"), std::string::npos) << text;
    const auto record = nlohmann::json::parse(text_of("r.json")).at("record");
    EXPECT_EQ(record.at("operator"), "A. Smith");
    EXPECT_EQ(record.size(), 2U);
    write_text("bad.yaml", text_of("c.yaml") + "record: {operater: A. Smith}\n");
    expect_input_error("calibrate bad.yaml -m m.csv", "did you mean 'operator'?");
}

}  // namespace
}  // namespace posewise::testing
