#include "program.hpp"

/// What must not happen whatever the user types: a file lost, a message that is not one line.
namespace posewise::testing {
namespace {

class BadInput : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        std::filesystem::copy_file(
            std::string(POSEWISE_SOURCE_DIR) + "/designs/fanuc_r2000ic_165f/campaign.yaml",
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

TEST_F(BadInput, MessagesAreOneLineWithoutControls) {
    const Outcome outcome = run("inspect \"$(printf 'a\\033[31m\\nb.yaml')\"");
    EXPECT_EQ(outcome.code, 1);
    EXPECT_EQ(outcome.err.find("posewise: a\\x1b[31m\\x0ab.yaml: cannot be read"), 0U)
        << outcome.err;
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
    EXPECT_NE(outcome.err.find("are points in mm where the file says m?"), std::string::npos)
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

TEST_F(BadInput, HelpThatCannotBePrintedIsAnError) {
    if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "needs the device /dev/full";
    for (const std::string arguments : {"--help", "--version", "study --help"}) {
        EXPECT_EQ(run(arguments, "sh -c '\"$0\" \"$@\" > /dev/full'").code, 1) << arguments;
    }
}

}  // namespace
}  // namespace posewise::testing
