#include <nlohmann/json.hpp>

#include "page_document.hpp"
#include "program.hpp"

/// Every warning of standard error stands in the documents and on the pages of the same run.
namespace posewise::testing {
namespace {

using nlohmann::json;

struct Command {
    std::string line;
    std::string file{};  ///< a document that it writes
    bool has_page = false;
};

class Warnings : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        write_with("narrow.yaml", "q2: {limits_deg: [-60, 60]}", "q2: {limits_deg: [-10, 10]}");
        write_with("noisy.yaml", "sigma_mm: 0.052", "sigma_mm: 0.1");
        write_with("moved.yaml", "position_mm: [-557.6,", "position_mm: [42.4,");
        run_well("simulate " + fanuc_design + " --truth 7 --seed 3 --poses 16 -o s.csv");
        run_well("simulate moved.yaml --truth 7 --seed 4 --poses 8 -o moved.csv");
        run_well("calibrate " + fanuc_design + " -m s.csv --folds 0 -o e.json");
        run_well("plan " + fanuc_design + quick + "-k 6 -o first.json --csv p.csv");
    }

    void write_with(const std::string& name, const std::string& part, const std::string& by) const {
        std::string text = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
        ASSERT_NE(text.find(part), std::string::npos) << part;
        write_text(name, text.replace(text.find(part), part.size(), by));
    }

    /// The sentences on standard error.
    static std::vector<std::string> said(const Outcome& outcome) {
        const std::string begin = "posewise: warning: ";
        std::vector<std::string> sentences;
        std::istringstream lines(outcome.err);
        for (std::string line; std::getline(lines, line);) {
            EXPECT_EQ(line.rfind(begin, 0), 0u) << line;
            if (line.rfind(begin, 0) == 0) sentences.push_back(line.substr(begin.size()));
        }
        return sentences;
    }

    json shown_in(const std::string& page) const { return document_in_page(text_of(page)); }

    void expect_everywhere(const Command& command) const {
        const std::string page = command.has_page ? " --report page.html" : "";
        const Outcome outcome = run(command.line + page + " --json");
        EXPECT_EQ(outcome.code, 0) << command.line << outcome.err;
        const json sentences = said(outcome);
        EXPECT_FALSE(sentences.empty()) << command.line;
        EXPECT_EQ(json::parse(outcome.out).at("warnings"), sentences) << command.line;
        if (!command.file.empty()) {
            EXPECT_EQ(json::parse(text_of(command.file)).at("warnings"), sentences) << command.line;
        }
        if (!command.has_page) return;
        const json shown = shown_in("page.html");
        EXPECT_EQ(shown.at("warnings"), sentences) << command.line;
        EXPECT_EQ(shown.at("parts").at(0).at("document").at("warnings"), sentences) << command.line;
    }

    const std::string quick = " --pool 200 --starts 1 --workspace-poses 20 ";
};

TEST_F(Warnings, StandInEveryDocumentAndOnEveryPage) {
    const Command commands[] = {
        {"calibrate narrow.yaml -m s.csv --folds 0 -o found.json", "found.json", true},
        {"indices narrow.yaml -m s.csv"},
        {"select narrow.yaml -m s.csv -k 8 --starts 1 -o choice.json", "choice.json", true},
        {"select narrow.yaml -m s.csv -k 8 --relax -o weights.json", "weights.json"},
        {"verify choice.json"},
        {"study narrow.yaml -m s.csv -k 6 --random 4 --splits 2 --starts 1", "", true},
        {"study " + fanuc_design + " -m s.csv -k 8,15 --random 4 --splits 0 --starts 1", "", true},
        {"plan noisy.yaml --from e.json" + quick + "-k 6 -o plan.json", "plan.json", true},
        {"inspect noisy.yaml --from e.json"},
        {"export noisy.yaml e.json --dh dh.yaml"},
        {"correct noisy.yaml e.json --poses p.csv"},
    };
    for (const Command& command : commands) expect_everywhere(command);
    EXPECT_EQ(json::parse(run_well("inspect " + fanuc_design + " --json")).at("warnings"),
              json::array());
}

TEST_F(Warnings, OfABaseThatMovedStandOnThePage) {
    const Command command{
        "calibrate " + fanuc_design + " -m s.csv --validate moved.csv --folds 0 -o found.json",
        "found.json", true};
    expect_everywhere(command);
    const json document = shown_in("page.html").at("parts").at(0).at("document");
    EXPECT_NE(document.at("warnings").dump().find("another set-up, base 600 mm from where"),
              std::string::npos)
        << document.at("warnings");
}

TEST_F(Warnings, OfASavedEstimateAreShownAgainWithThoseOfTheReport) {
    expect_everywhere({"calibrate narrow.yaml -m s.csv --folds 0 -o found.json", "found.json"});
    const json saved = json::parse(text_of("found.json")).at("warnings");
    run_line("cd '" + folder_.string() + "' && rm s.csv");
    const Outcome outcome = run("report found.json -o page.html --json");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const json shown = shown_in("page.html");
    EXPECT_EQ(shown.at("warnings"), json(said(outcome)));
    EXPECT_EQ(json::parse(outcome.out).at("warnings"), json(said(outcome)));
    EXPECT_EQ(shown.at("parts").at(0).at("document").at("warnings"), saved);
}

TEST_F(Warnings, OfFilesWithoutThemAreNone) {
    json document = json::parse(text_of("e.json"));
    document.erase("warnings");
    write_text("old.json", document.dump());
    run_well("correct " + fanuc_design + " old.json --poses s.csv");
    run_well("report old.json -o page.html");
}

TEST_F(Warnings, NameThreadsThatAreAskedForInVain) {
    const Outcome outcome =
        run("inspect " + fanuc_design + " -m s.csv --json", "OMP_NUM_THREADS=100000");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(said(outcome).size(), 1u) << outcome.err;
    EXPECT_NE(outcome.err.find("100000 threads are asked for"), std::string::npos) << outcome.err;
}

}  // namespace
}  // namespace posewise::testing
