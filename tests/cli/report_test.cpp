#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "page_document.hpp"
#include "program.hpp"

/// Pages that commands write with --report, and report from what they have written.
namespace posewise::testing {
namespace {

using nlohmann::json;

const std::string cell_design = "'" + source_folder() + "/designs/cell_demo/campaign.yaml'";

class Report : public Program {
  protected:
    /// The document in a page.
    json shown_in(const std::string& page) const { return document_in_page(text_of(page)); }
    json part_in(const std::string& page) const { return shown_in(page)["parts"][0]; }

    void simulate() const {
        run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 16 -o s.csv");
    }

    /// The same, numbers to rounding that a few poses with a prior enlarge.
    static void expect_alike(const json& found, const json& expected, const std::string& name) {
        const json flat = found.flatten();
        const json wanted = expected.flatten();
        ASSERT_EQ(flat.size(), wanted.size()) << name;
        for (auto item = wanted.begin(); item != wanted.end(); ++item) {
            ASSERT_TRUE(flat.contains(item.key())) << name << item.key();
            const json& other = flat[item.key()];
            if (!item->is_number()) {
                EXPECT_EQ(other, *item) << name << item.key();
                continue;
            }
            const double number = item->get<double>();
            EXPECT_NEAR(other.get<double>(), number, 1e-6 * std::abs(number)) << name << item.key();
        }
    }

    static double rms_of_map(const json& part) {
        double squares = 0;
        const json& errors = part["error_map"]["predicted_mm"];
        for (const json& error : errors) squares += std::pow(error.get<double>(), 2);
        return std::sqrt(squares / static_cast<double>(errors.size()));
    }
};

TEST_F(Report, OfAPlanHasWhatItPrintsAndWhatItsFileAndCampaignTell) {
    const std::string plan = "plan " + cell_design +
                             " -k 4 --prior --pool 120 --starts 1 --workspace-poses 20 "
                             "--criterion d -o p.json";
    const bool has_gnuplot = std::system("gnuplot --version > /dev/null 2>&1") == 0;
    const std::string text =
        run_well(plan + (has_gnuplot ? " --plot p.svg" : "") + " --report 'my page.html'");
    EXPECT_EQ(has_gnuplot, text_of("p.svg").find("from above") != std::string::npos);
    const json part = part_in("my page.html");
    EXPECT_EQ(part["printed"], text);
    EXPECT_EQ(part["title"], "FANUC R-2000iC/165F in a cell");
    const std::string command = part["command"].get<std::string>();
    EXPECT_EQ(command.rfind("posewise plan ", 0), 0U) << command;
    EXPECT_TRUE(command.ends_with(" --report 'my page.html'")) << command;
    EXPECT_EQ(part["document"]["poses"].size(), 4U);
    const double rms = part["document"]["accuracy"]["rms_mm"];
    EXPECT_NEAR(rms_of_map(part), rms, 1e-6);  // rounded to the nm
    EXPECT_EQ(part["error_map"]["position"].size(), 20U);
    EXPECT_EQ(part["scene"]["floor_z"], -1.27);

    run_well("report p.json -o again.html");
    const json again = part_in("again.html");
    const json file = json::parse(text_of("p.json"));
    for (const auto& [key, value] : file.items()) EXPECT_EQ(again["document"][key], value) << key;
    for (const char* const key : {"accuracy", "budget", "pose_values", "drop_outs", "duration_s",
                                  "new_pose_count", "workspace_count", "value_rms_mm"}) {
        expect_alike(again["document"][key], part["document"][key], key);
    }
    EXPECT_EQ(again["scene"], part["scene"]);
    EXPECT_EQ(again["error_map"], part["error_map"]);
    EXPECT_TRUE(again["command"].is_null() && again["printed"].is_null());
}

TEST_F(Report, LeavesOutWhatAChangedCampaignSaysOfAPlan) {
    const std::string design =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    write_text("c.yaml", design);
    run_well("plan c.yaml -k 9 --pool 40 --starts 1 --workspace-poses 10 --criterion d -o p.json");
    run_well("report p.json -o r.html");
    EXPECT_TRUE(part_in("r.html").contains("error_map"));
    std::string longer = design;
    const auto at = longer.find("Tz 1075");
    ASSERT_NE(at, std::string::npos);
    write_text("c.yaml", longer.replace(at, 7, "Tz 1175"));
    const Outcome changed = run("report p.json -o r.html");
    EXPECT_EQ(changed.code, 0);
    EXPECT_NE(changed.err.find("must be as it was when the plan was made"), std::string::npos)
        << changed.err;
    EXPECT_FALSE(part_in("r.html").contains("error_map"));
}

TEST_F(Report, OfACalibrationIsTheSameFromItsFile) {
    simulate();
    const std::string text = run_well("calibrate " + fanuc_design +
                                      " -m s.csv --exclude 3 --folds 4 --loss huber -o e.json "
                                      "--report c.html");
    const json part = part_in("c.html");
    EXPECT_EQ(part["printed"], text);
    EXPECT_EQ(part["document"], json::parse(text_of("e.json")));
    EXPECT_EQ(part["configurations"]["id"].size(), 15U);
    const json& readings = part["residuals"]["readings"];
    double squares = 0;
    for (const json& axis : readings["held_out"]) {
        ASSERT_EQ(axis.size(), 45U);
        for (const json& one : axis) squares += std::pow(1e-6 * one.get<double>(), 2);
    }
    EXPECT_NEAR(std::sqrt(squares / 45),
                part["document"]["accuracy"]["held_out"]["samples"]["distance_rms_mm"], 1e-6);

    const json printed = json::parse(run_well("calibrate " + fanuc_design +
                                              " -m s.csv --exclude 3 --folds 4 --loss huber "
                                              "--json --report j.html"));
    EXPECT_EQ(part_in("j.html")["document"], printed);
    EXPECT_EQ(part_in("j.html")["printed"], text);

    run_well("report e.json -o again.html");
    const json again = part_in("again.html");
    EXPECT_EQ(again["document"], part["document"]);
    const json& others = again["residuals"]["readings"];
    EXPECT_EQ(others["configuration"], readings["configuration"]);
    for (const auto& [name, tolerance] : {std::pair{"residual", 2.0},
                                          {"nominal", 2.0},
                                          {"held_out", 2.0},
                                          {"standardised", 2e-3}}) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            for (std::size_t k = 0; k < 45; ++k) {
                EXPECT_NEAR(others[name][axis][k].get<double>(),
                            readings[name][axis][k].get<double>(), tolerance);
            }
        }
    }
    EXPECT_NEAR(rms_of_map(again), rms_of_map(part), 1e-6);
}

TEST_F(Report, SaysWhatItLeavesOut) {
    simulate();
    write_text("c.yaml", read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml"));
    run_well("calibrate c.yaml -m s.csv --folds 0 -o e.json");
    run_well("simulate " + fanuc_design + " --truth 7 --seed 4 --poses 16 -o s.csv");
    const Outcome changed = run("report e.json -o r.html");
    EXPECT_EQ(changed.code, 0);
    EXPECT_EQ(changed.err,
              "posewise: warning: e.json: residuals are not shown: s.csv: is not what it was made "
              "from any more\n");
    EXPECT_EQ(changed.out,
              "e.json: estimate, with the robot, errors over the workspace\npage: r.html\n");
    EXPECT_FALSE(part_in("r.html").contains("residuals"));
    std::filesystem::remove(folder_ / "c.yaml");
    const Outcome gone = run("report e.json -o r.html");
    EXPECT_EQ(gone.code, 0);
    EXPECT_NE(gone.err.find("robot and errors are not shown: c.yaml: cannot be read"),
              std::string::npos)
        << gone.err;
    EXPECT_EQ(part_in("r.html")["document"], json::parse(text_of("e.json")));
    EXPECT_FALSE(part_in("r.html").contains("scene"));
    // Moved together, they are found beside the estimate.
    const std::string beside =
        "mkdir d && mv e.json d && sed 's/x/x/' > d/c.yaml " + fanuc_design + " && cp s.csv d";
    EXPECT_EQ(run_line(beside).code, 0);
    EXPECT_EQ(run("report d/e.json -o r.html").code, 0);
    EXPECT_TRUE(part_in("r.html").contains("scene"));
}

TEST_F(Report, ShowsSeveralSideBySide) {
    simulate();
    const std::string study = "study " + fanuc_design + " -m s.csv -k 6 --random 3 --splits 0 ";
    const json document = json::parse(run_well(study + "--store s.sqlite --report st.html --json"));
    EXPECT_EQ(part_in("st.html")["document"], document);
    EXPECT_EQ(part_in("st.html")["configurations"]["joints"].size(), 16U);
    write_text("st.json", document.dump());
    run_well("select " + fanuc_design + " -m s.csv -k 8 --report sel.html");
    EXPECT_NEAR(rms_of_map(part_in("sel.html")),
                part_in("sel.html")["document"]["accuracy"]["rms_mm"].get<double>(), 1e-6);
    const std::string text = run_well("report s.sqlite st.json s.plan.json -o all.html");
    EXPECT_EQ(text,
              "s.sqlite: study\nst.json: study\ns.plan.json: plan of 8 poses, with the robot, "
              "errors over the workspace\npage: all.html\n");
    const json all = shown_in("all.html");
    ASSERT_EQ(all["parts"].size(), 3U);
    EXPECT_EQ(all["parts"][0]["document"], document);
    EXPECT_EQ(all["parts"][1]["document"], document);
    EXPECT_EQ(all["parts"][2]["title"], "s.plan.json");
    for (const char* const key : {"poses", "accuracy", "bound", "value_rms_mm"}) {
        expect_alike(all["parts"][2]["document"][key], part_in("sel.html")["document"][key], key);
    }
    EXPECT_EQ(json::parse(run_well("report s.sqlite st.json s.plan.json -o all.html --json")), all);

    write_text("blocks.csv", "1,0\n0,1\n1,1\n1,2\n3,1\n");
    run_well("select --blocks blocks.csv --rows 1 -k 3 --report blocks.html");
    EXPECT_EQ(part_in("blocks.html")["title"], "blocks.csv");
    EXPECT_FALSE(part_in("blocks.html").contains("scene"));
    run_well("report blocks.plan.json -o again.html");
}

TEST_F(Report, ShowsHowFarExportedFilesAre) {
    simulate();
    run_well("calibrate " + fanuc_design + " -m s.csv --folds 0 -o e.json");
    const std::string text = run_well("export " + fanuc_design + " e.json --dh d.yaml --json");
    write_text("x.json", text);
    EXPECT_EQ(run_well("report x.json -o r.html"), "x.json: export\npage: r.html\n");
    EXPECT_EQ(part_in("r.html")["document"], json::parse(text));
}

TEST_F(Report, LeavesAHostileNameText) {
    simulate();
    std::string campaign = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    const std::string name = "name: FANUC R-2000iC/165F";
    ASSERT_NE(campaign.find(name), std::string::npos);
    campaign.replace(campaign.find(name), name.size(),
                     "name: '</script><script>alert(1)</script>'");
    write_text("c.yaml", campaign);
    run_well("calibrate c.yaml -m s.csv --folds 0 --report r.html");
    EXPECT_EQ(text_of("r.html").find("alert(1)</script>"), std::string::npos);
    EXPECT_EQ(part_in("r.html")["title"], "</script><script>alert(1)</script>");
}

TEST_F(Report, RefusesWhatItCannotReadOrWrite) {
    simulate();
    run_well("calibrate " + fanuc_design + " -m s.csv --folds 0 -o e.json");
    write_text("notes.txt", "a plan\n");
    expect_input_error("report absent.json -o r.html", "absent.json: cannot be read");
    write_text("st.json",
               R"({"kind": "posewise study", "format": 1, "campaign": "a", "simulated": true,
                              "models": [{"name": "", "rows": [{"pose_count": 8, "planned": null}]}]})");
    expect_input_error("report st.json -o r.html", "planned");
    write_text("x.json",
               R"({"kind": "posewise export", "format": 1, "campaign": "a", "geometry": "estimate",
                             "lost": {"nominal": {"rms_mm": "1"}}})");
    expect_input_error("report x.json -o r.html", "lost.nominal.rms_mm");
    expect_input_error("report notes.txt -o r.html", "must be a plan, estimate, study or export");
    expect_input_error("report e.json -o e.json", "is read and shall be written");
    expect_input_error("report e.json -o s.csv", "is read and shall be written");
    expect_input_error("report e.json -o " + fanuc_design, "is read and shall be written");
    expect_input_error("report e.json -o absent/r.html", "cannot be written");
    const std::string calibrate = "calibrate " + fanuc_design + " -m s.csv --folds 0 ";
    expect_input_error(calibrate + "--report s.csv", "is read and shall be written");
    expect_input_error(calibrate + "--out a --report ./a", "shall be written twice");
    std::filesystem::create_symlink("b.json", folder_ / "link.html");
    expect_input_error(calibrate + "--out b.json --report link.html", "shall be written twice");
    EXPECT_FALSE(has_file("b.json"));
    std::filesystem::create_symlink("absent/r.html", folder_ / "astray.html");
    expect_input_error(calibrate + "--report astray.html", "cannot be written");
    expect_input_error(calibrate + "--report absent/r.html", "cannot be written");
    expect_input_error(calibrate + "--report .", "is a folder");
    expect_input_error("study " + fanuc_design + " -m s.csv --report s.csv", "is read and shall");
    expect_input_error("study " + fanuc_design + " -m s.csv --store a --report ./a",
                       "is read and shall be written");
    expect_input_error("select " + fanuc_design + " -m s.csv -k 8 --report s.csv", "is read and");
    expect_input_error("plan " + cell_design + " -k 8 --report " + cell_design, "is read and");
    const Outcome both = run(calibrate + "--json --report /dev/stdout");
    EXPECT_EQ(both.code, 1);
    EXPECT_NE(both.err.find("is standard output"), std::string::npos);
    EXPECT_EQ(run("report -o r.html").code, 2);
    EXPECT_EQ(run("report e.json").code, 2);
    EXPECT_EQ(run("select " + fanuc_design + " -m s.csv -k 8 --relax --report r.html").code, 2);
    EXPECT_FALSE(has_file("r.html"));
}

/// The page comes last: what was found is printed and written before.
TEST_F(Report, LosesNothingWhereThePageCannotBeWritten) {
    simulate();
    const Outcome outcome =
        run("calibrate " + fanuc_design + " -m s.csv --folds 0 -o e.json --report r.html",
            "ulimit -f 200;");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.out.find("distance RMS"), std::string::npos);
    EXPECT_EQ(outcome.err, "posewise: r.html: cannot be written: File too large\n");
    EXPECT_TRUE(has_file("e.json"));
    EXPECT_FALSE(has_file("r.html"));
}

TEST_F(Report, HasPlotsBesideIt) {
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot here";
    simulate();
    run_well("calibrate " + fanuc_design + " -m s.csv --folds 0 --plot r.svg --report r.html");
    EXPECT_NE(text_of("r.svg").find("left after calibration"), std::string::npos);
    expect_input_error("plan " + cell_design + " -k 4 --plot p.pdf", "must be .svg or .png");
    expect_input_error("calibrate " + fanuc_design + " -m s.csv --plot s.csv", "must be .svg");
    expect_input_error("calibrate " + fanuc_design + " -m s.csv --plot a.svg --report a.svg",
                       "shall be written twice");
}

TEST_F(Report, IsWrittenWhenTimeIsUp) {
    const Outcome outcome = run("plan " + cell_design +
                                " -k 8 --prior --pool 300 --starts 1000 --time 1 -o p.json "
                                "--workspace-poses 20 --report r.html");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(part_in("r.html")["document"]["search"]["stop_reason"], "time limit");
    EXPECT_TRUE(part_in("r.html").contains("error_map"));
}

}  // namespace
}  // namespace posewise::testing
