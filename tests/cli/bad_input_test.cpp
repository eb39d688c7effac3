#include <algorithm>
#include <chrono>

#include "program.hpp"

/// What must not happen whatever the user types: a file lost, a message that is not one line.
namespace posewise::testing {
namespace {

class BadInput : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        std::filesystem::copy_file(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml",
                                   folder_ / "c.yaml");
        run_well("simulate c.yaml --truth 7 --seed 3 --poses 12 --repeats 2 -o s.csv");
    }

    /// A program of that name, first in the PATH that is returned for run().
    std::string with_program(const std::string& name, const std::string& script) const {
        std::filesystem::create_directory(folder_ / "bin");
        write_text("bin/" + name, "#!/bin/sh\n" + script);
        std::filesystem::permissions(folder_ / "bin" / name, std::filesystem::perms::owner_all);
        return "PATH=\"$PWD/bin:$PATH\"";
    }
};

TEST_F(BadInput, NoOutputReplacesAnInput) {
    std::filesystem::create_symlink("s.csv", folder_ / "link.csv");
    std::filesystem::create_hard_link(folder_ / "c.yaml", folder_ / "hard.yaml");
    const std::string campaign = text_of("c.yaml");
    const std::string measurements = text_of("s.csv");
    const std::string words = "is read and shall be written";
    expect_input_error("simulate c.yaml -k 5 -o c.yaml", words);
    expect_input_error("simulate c.yaml -k 5 -o ./hard.yaml", words);
    expect_input_error("calibrate c.yaml -m s.csv -o s.csv", words);
    expect_input_error("calibrate c.yaml -m s.csv -o link.csv", words);
    expect_input_error("study c.yaml -m s.csv --csv \"$PWD/s.csv\"", words);
    EXPECT_EQ(text_of("c.yaml"), campaign);
    EXPECT_EQ(text_of("s.csv"), measurements);
}

TEST_F(BadInput, TwoOutputsAreTwoFiles) {
    expect_input_error("study c.yaml -m s.csv --csv a.svg --plot ./a.svg", "written twice");
}

TEST_F(BadInput, AFolderIsNoOutput) {
    std::filesystem::create_directory(folder_ / "d");
    for (const std::string command :
         {"select c.yaml -m s.csv -k 8 --starts 1000000", "plan c.yaml -k 8 --starts 100000"}) {
        expect_input_error(command + " -o d", "d: is a folder; must be the name of a file");
    }
}

TEST_F(BadInput, AFolderThatIsNotThereIsSaidAtOnce) {
    expect_input_error("study c.yaml -m s.csv --random 1000000 --csv none/a.csv", "none/a.csv: ");
}

TEST_F(BadInput, AFailedPlotLeavesTheImageAndTheUsersFiles) {
    write_text("a.svg", "the old image");
    write_text("a.svg.gnuplot", "the user's own");
    const std::string path = with_program("gnuplot", "exit 3\n");
    const Outcome outcome = run("study c.yaml -m s.csv --poses 8 --random 2 --plot a.svg", path);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.err, "posewise: a.svg: the plot was not drawn, gnuplot failed\n");
    EXPECT_EQ(text_of("a.svg"), "the old image");
    EXPECT_EQ(text_of("a.svg.gnuplot"), "the user's own");
}

TEST_F(BadInput, APlotLeavesTheUsersFiles) {
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot here";
    write_text("a.svg", "the old image");
    write_text("a.svg.gnuplot", "the user's own");
    run_well("study c.yaml -m s.csv --poses 8 --random 2 --plot a.svg");
    EXPECT_NE(text_of("a.svg").find("<svg"), std::string::npos);
    EXPECT_EQ(text_of("a.svg.gnuplot"), "the user's own");
}

TEST_F(BadInput, AnInterruptEndsAStudyAtOnceWithoutFiles) {
    const auto files = file_count();
    const Outcome outcome = run("study c.yaml -m s.csv --random 100000 --csv a.csv",
                                "timeout --preserve-status -s INT 1");
    EXPECT_NE(outcome.code, 0);
    EXPECT_EQ(file_count(), files);
}

TEST_F(BadInput, ASignalWhileGnuplotHangsLeavesNothing) {
    std::filesystem::create_directory(folder_ / "tmp");
    std::string path = with_program("gnuplot", "");
    const auto files = file_count();
    for (const std::string signal : {"INT", "TERM"}) {
        path = with_program("gnuplot",
                            "touch reached; kill -s " + signal + " $PPID; exec sleep 1000\n");
        const Outcome outcome =
            run("study c.yaml -m s.csv --poses 8 --random 2 --plot a.svg",
                "TMPDIR=\"$PWD/tmp\" " + path + " timeout --preserve-status -k 20 60");
        EXPECT_NE(outcome.code, 0) << signal;
        EXPECT_TRUE(std::filesystem::remove(folder_ / "reached")) << signal;
        EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp")) << signal;
        EXPECT_EQ(file_count(), files) << signal;
        EXPECT_EQ(outcome.out.rfind("How many poses", 0), 0U)
            << "the table comes first: " << outcome.out;
    }
}

TEST_F(BadInput, WhatGnuplotPrintsIsNoResult) {
    const std::string path = with_program("gnuplot", "echo noise\n");
    const Outcome outcome =
        run("study c.yaml -m s.csv --poses 8 --random 2 --plot a.svg --json", path);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.out.find("noise"), std::string::npos) << outcome.out;
    EXPECT_EQ(outcome.out.front(), '{');
    EXPECT_EQ(outcome.out.substr(outcome.out.size() - 2), "}\n");
    EXPECT_EQ(outcome.err,
              "noise\nposewise: a.svg: the plot was not drawn, gnuplot wrote no image; its script "
              "is left, try: gnuplot './a.svg.gnuplot'\n");
}

TEST_F(BadInput, TheScriptOfAPlotRunsNoProgram) {
    const std::string path = with_program("gnuplot", "exit 3\n");
    const Outcome outcome =
        run("study c.yaml -m s.csv --poses 8 --random 2 --plot '|touch x;.svg'", path);
    EXPECT_EQ(outcome.code, 1);
    EXPECT_NE(outcome.err.find("; its script is left, try: gnuplot './|touch x;.svg.gnuplot'\n"),
              std::string::npos)
        << outcome.err;
    EXPECT_NE(text_of("|touch x;.svg.gnuplot").find("set output './|touch x;.svg'\n"),
              std::string::npos);
}

TEST_F(BadInput, EncodingsAreNamed) {
    const auto utf16 = [](const std::string& text) {
        std::string wide = "\xFF\xFE";
        for (const char c : text) wide += {c, '\0'};
        return wide;
    };
    const auto with_returns = [](std::string text) {
        std::replace(text.begin(), text.end(), '\n', '\r');
        return text;
    };
    write_text("wide.csv", utf16(text_of("s.csv")));
    expect_input_error("indices c.yaml -m wide.csv", "wide.csv: is UTF-16; must be UTF-8");
    const std::string returns = ": has line ends of CR only; must be of LF or CR LF";
    write_text("cr.csv", with_returns(text_of("s.csv")));
    expect_input_error("indices c.yaml -m cr.csv", "cr.csv" + returns);
    write_text("cr.yaml", with_returns(text_of("c.yaml")));
    expect_input_error("inspect cr.yaml", "cr.yaml" + returns);
    std::string decimals = text_of("s.csv");
    std::replace(decimals.begin(), decimals.end(), ',', ';');
    std::replace(decimals.begin(), decimals.end(), '.', ',');
    write_text("commas.csv", decimals);
    expect_input_error("indices c.yaml -m commas.csv",
                       "must be a finite number with a decimal point");
    std::replace(decimals.begin(), decimals.end(), ';', ',');
    write_text("commas.csv", decimals);
    expect_input_error("indices c.yaml -m commas.csv", "; are there decimal commas?");
}

TEST_F(BadInput, NamesThatAreNotUtf8AreRefusedBeforeTheSearch) {
    const auto start = std::chrono::steady_clock::now();
    std::filesystem::copy_file(folder_ / "s.csv", folder_ / "s\xff.csv");
    expect_input_error(
        "select c.yaml -m \"$(printf 's\\377.csv')\" -k 8 --starts 1000000 -o p.json",
        "s\\xff.csv: its name is not UTF-8");
    write_text("ids.csv", "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n\xff,1,2,3,4,5,6\n");
    expect_input_error("select c.yaml --candidates ids.csv -k 8 --starts 1000000 --prior -o p.json",
                       "ids.csv:2:1: is not UTF-8 text here");
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(60));
}

TEST_F(BadInput, WhatNeverEndsIsRefused) {
    expect_input_error("calibrate c.yaml -m /dev/zero", "/dev/zero: is larger than 1 MiB");
    expect_input_error("inspect /dev/zero", "/dev/zero: is larger than 1 MiB");
    std::string text = "<robot name='x'><link name='l0'/>\n";
    for (int k = 1; k <= 20000; ++k) {
        const std::string number = std::to_string(k);
        text += "<link name='l" + number + "'/><joint name='j" + number +
                "' type='revolute'><parent link='l" + std::to_string(k - 1) + "'/><child link='l" +
                number + "'/><limit lower='-1' upper='1'/></joint>\n";
    }
    write_text("many.urdf", text + "</robot>");
    expect_input_error("inspect many.urdf", "has 20000 joints between base link 'l0' and tip link");
}

TEST_F(BadInput, CountsNameTheFile) {
    expect_input_error("select c.yaml -m s.csv -k 500", "s.csv: pose count is 500, must be from 1");
    expect_input_error(
        "select c.yaml -m s.csv -k 2",
        "s.csv: pose count is 2, must be at least 4: 2 poses have 18 rows, fewer than");
    expect_input_error("select c.yaml --random 20 -k 500", "c.yaml: pose count is 500");
    expect_input_error("plan c.yaml --poses 2", "c.yaml: --poses is 2, must be at least 5");
}

TEST_F(BadInput, APlanAndItsCsvAreWrittenBothOrNot) {
    const std::string too_long(300, 'n');
    const auto files = file_count();
    const Outcome outcome =
        run("plan c.yaml --poses 8 --starts 1 --pool 200 --time 20 -o p.json --csv " + too_long);
    EXPECT_EQ(outcome.code, 1) << outcome.err;
    EXPECT_EQ(file_count(), files);
    run_well("plan c.yaml --poses 8 --starts 1 --pool 200 -o p.json --csv p.csv");
    EXPECT_TRUE(has_file("p.json") && has_file("p.csv"));
}

TEST_F(BadInput, MessagesAreOneLineWithoutControls) {
    const Outcome outcome = run("inspect \"$(printf 'a\\033[31m\\nb.yaml')\"");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.err.find("posewise: a\\x1b[31m\\x0ab.yaml: cannot be read"), 0U)
        << outcome.err;
    std::string text = text_of("s.csv");
    const std::string turned = "\u202e7\u009b";
    for (auto at = text.find("\n7,"); at != std::string::npos; at = text.find("\n7,")) {
        text.replace(at + 1, 1, turned);
    }
    write_text("turned.csv", text);
    const std::string all = run_well("select c.yaml -m turned.csv -k 12 --proof 0 -o t.json");
    EXPECT_EQ(all.find(turned), std::string::npos) << all;
    EXPECT_NE(all.find("\\xe2\\x80\\xae7\\xc2\\x9b"), std::string::npos) << all;
}

TEST_F(BadInput, APathCannotBreakTheComment) {
    std::filesystem::copy_file(folder_ / "c.yaml", folder_ / "a\nconfig,b.yaml");
    run_well("simulate \"$(printf 'a\\nconfig,b.yaml')\" -k 12 -o t.csv");
    run_well("indices c.yaml -m t.csv");
}

TEST_F(BadInput, WhatIsWrongWithTheContentNamesTheFile) {
    run_well("simulate c.yaml -k 2 -o few.csv");
    for (const std::string command : {"calibrate", "study", "indices"}) {
        const Outcome outcome = run(command + " c.yaml -m few.csv");
        if (outcome.code == 0) continue;  // indices of a singular set
        EXPECT_EQ(outcome.code, 1) << command;
        EXPECT_EQ(outcome.err.find("posewise: few.csv: "), 0U) << outcome.err;
    }
}

TEST_F(BadInput, ColumnsInTheWrongUnitAreSuspected) {
    std::string text = text_of("s.csv");
    for (auto at = text.find("_mm"); at != std::string::npos; at = text.find("_mm", at)) {
        text.replace(at, 3, "_m");
    }
    write_text("m.csv", text);
    const Outcome outcome = run("calibrate c.yaml -m m.csv --folds 0");
    EXPECT_NE(outcome.err.find("with points in mm where the file says m ("), std::string::npos)
        << outcome.err;
}

TEST_F(BadInput, TheLargestSeedIsTaken) {
    run_well("simulate c.yaml -k 5 -o a.csv --seed 18446744073709551615");
    EXPECT_NE(text_of("a.csv").find("--seed 18446744073709551615"), std::string::npos);
}

TEST_F(BadInput, AFileBeyondTheLimitOfSizeIsAnErrorAndLeavesNothing) {
    const auto files = file_count();
    const Outcome outcome =
        run("simulate c.yaml -k 1000 -o big.csv", "sh -c 'ulimit -f 16; exec \"$0\" \"$@\"'");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.err, "posewise: big.csv: cannot be written: File too large\n");
    EXPECT_EQ(file_count(), files);
}

TEST_F(BadInput, AMinusIsNoNameOfAFile) {
    expect_input_error("simulate c.yaml -k 10 -o -", "-: is no name of a file; /dev/stdout is");
}

TEST_F(BadInput, HelpThatCannotBePrintedIsAnError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs the device /dev/full";
    for (const std::string arguments : {"--help", "--version", "study --help"}) {
        EXPECT_EQ(run(arguments, "sh -c '\"$0\" \"$@\" > /dev/full'").code, 1) << arguments;
    }
}

}  // namespace
}  // namespace posewise::testing
