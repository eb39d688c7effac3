#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <string>

#include "support/places.hpp"

/// Runs the built program as a user would, in a folder of its own.
namespace posewise::testing {

struct Outcome {
    int code = -1;
    std::string out;
    std::string err;
};

inline std::string read_text(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

class Program : public ::testing::Test {
  protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  ("posewise_cli_" + std::string(test->test_suite_name()) + '_' + test->name() +
                   '_' + std::to_string(::getpid()));
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// `arguments` as typed in a shell; `before` may set environment variables, `behind` may pipe.
    Outcome run(const std::string& arguments, const std::string& before = "",
                const std::string& behind = "") const {
        return run_line(before + " '" + program_path() + "' " + arguments + " 2> .err " + behind +
                        " > .out");
    }

    /// A shell's line that writes .out and .err.
    Outcome run_line(const std::string& line) const {
        const auto out = folder_ / ".out";
        const auto err = folder_ / ".err";
        const int status = std::system(("cd '" + folder_.string() + "' && " + line).c_str());
        Outcome outcome{WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out),
                        read_text(err)};
        std::filesystem::remove(out);
        std::filesystem::remove(err);
        return outcome;
    }

    /// Runs it and expects success and a silent standard error.
    std::string run_well(const std::string& arguments, const std::string& before = "") const {
        const Outcome outcome = run(arguments, before);
        EXPECT_EQ(outcome.code, 0) << arguments;
        EXPECT_EQ(outcome.err, "") << arguments;
        return outcome.out;
    }

    /// Expects exit code 1, one line on standard error that holds `words`, and no file left.
    void expect_input_error(const std::string& arguments, const std::string& words) const {
        const auto files_before = file_count();
        const Outcome outcome = run(arguments);
        EXPECT_EQ(outcome.code, 1) << arguments;
        EXPECT_EQ(outcome.err.rfind("posewise: ", 0), 0u) << outcome.err;
        EXPECT_EQ(outcome.err.find('\n'), outcome.err.size() - 1) << outcome.err;
        EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
        EXPECT_EQ(file_count(), files_before) << arguments;
    }

    /// A pipe with a name that gives the content of a file once: a second reader waits forever.
    void write_fifo(const std::string& name, const std::string& source) const {
        const std::string line = "cd '" + folder_.string() + "' && rm -f " + name + " && mkfifo " +
                                 name + " && (cat '" + source + "' > " + name + " &)";
        EXPECT_EQ(std::system(line.c_str()), 0) << line;
    }

    std::size_t file_count() const {
        const std::filesystem::directory_iterator files(folder_);
        return static_cast<std::size_t>(std::distance(begin(files), end(files)));
    }

    bool has_file(const std::string& name) const { return std::filesystem::exists(folder_ / name); }
    std::string text_of(const std::string& name) const { return read_text(folder_ / name); }
    void write_text(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }

    std::filesystem::path folder_;
};

/// A base and what measures poses of the flange, behind a robot.
inline const std::string measured_poses =
    R"(base: {position_mm: [1000, 200, 30], rpy_deg: [0, 0, 90]}
sensor:
  kind: poses
  sigma_mm: 0.05
  sigma_orientation_mrad: 0.2
  tool: {position_mm: [10, 20, 120], rpy_deg: [10, 0, 90]}
)";

/// A robot of six joints, below "robot:".
inline const std::string six_joints = R"(  joints:
    q1: {limits_deg: [-170, 170]}
    q2: {limits_deg: [-90, 90]}
    q3: {limits_deg: [-150, 150]}
    q4: {limits_deg: [-150, 150]}
    q5: {limits_deg: [-110, 110]}
    q6: {limits_deg: [-170, 170]}
  elements: [Rz q1, Tz 290 mm, Ry q2, Tz 270 mm, Ry q3, Tz 70 mm, Tx 302 mm, Rx q4, Ry q5, Tx 72 mm, Rx q6]
)";

inline const std::string fanuc_design =
    "'" + source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml'";
inline const std::string seed_design =
    "'" + source_folder() + "/designs/fanuc_r2000ic_165f/seed_report.yaml'";

/// The number in `column` (0 is the first) of the first line that starts with `label`; blanks
/// separate columns. Fails the test and gives NaN if there is none.
inline double number_behind(const std::string& text, const std::string& label,
                            std::size_t column = 0) {
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        const auto start = line.find_first_not_of(' ');
        if (start == std::string::npos || line.compare(start, label.size(), label) != 0) continue;
        std::istringstream words(line.substr(start + label.size()));
        std::string word;
        for (std::size_t i = 0; i <= column; ++i) words >> word;
        return std::strtod(word.c_str(), nullptr);
    }
    ADD_FAILURE() << "no line '" << label << "' in\n" << text;
    return std::numeric_limits<double>::quiet_NaN();
}

}  // namespace posewise::testing
