#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>

#include "../../src/io/format/atomic_file.hpp"
#include "campaign_text.hpp"
#include "posewise/io/measurements_file.hpp"
#include "support/slips.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;

const std::string good =
    "config,sample,q1_rad,q2_rad,lift_m,p1_x_m,p1_y_m,p1_z_m,p2_x_m,p2_y_m,p2_z_m\n"
    "a,0,0.1,0.2,0.3,1,2,3,4,5,6\n"
    "a,1,0.1,0.2,0.3,1.5,2,3,4,5,6\n"
    "b,0,0.1,0.25,0.3,7,8,9,10,11,12\n";

const Campaign& crane() {
    static const Campaign campaign = [] {
        const TemporaryFolder folder;
        return read_campaign(folder.write("c.yaml", testing::campaign_text));
    }();
    return campaign;
}

Measurements read_rows(const std::string& text) {
    const TemporaryFolder folder;
    return read_measurements_csv(folder.write("m.csv", text), crane());
}

std::string rows_error(const std::string& text) {
    return input_error_of([&] { read_rows(text); });
}

void expect_equal(const Measurements& a, const Measurements& b) {
    EXPECT_EQ(a.ids, b.ids);
    EXPECT_EQ(a.first_sample, b.first_sample);
    EXPECT_EQ(a.configurations, b.configurations);
    EXPECT_EQ(a.observations, b.observations);
    EXPECT_TRUE((a.is_seen == b.is_seen).all());
}

TEST(ReadMeasurementsCsv, GroupsSamplesByConfiguration) {
    const Measurements measurements = read_rows(good);
    EXPECT_EQ(measurements.ids, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(measurements.first_sample, (std::vector<Index>{0, 2, 3}));
    EXPECT_EQ(measurements.configurations(1, 1), 0.25);
    EXPECT_EQ(measurements.observations(1, 0), 1.5);
    EXPECT_EQ(measurements.observations(2, 5), 12);
}

TEST(ReadMeasurementsCsv, TakesConfigurationsInTurns) {
    const auto text = good + "a,2,0.1,0.2,0.3,1.25,2,3,4,5,6\n";
    const Measurements measurements = read_rows(text);
    EXPECT_EQ(measurements.first_sample, (std::vector<Index>{0, 3, 4}));
    EXPECT_EQ(measurements.observations(2, 0), 1.25);
    EXPECT_EQ(measurements.observations(3, 0), 7);
}

TEST(ReadMeasurementsCsv, EmptyCellsAreATargetThatWasNotSeen) {
    EXPECT_TRUE(read_rows(good).is_seen.all());
    const Measurements measurements = read_rows(replaced(
        replaced(good, "a,1,0.1,0.2,0.3,1.5,2,3,", "a,1,0.1,0.2,0.3,, ,\"\","), "10,11,12", ",,"));
    EXPECT_TRUE((measurements.is_seen == Seen{{true, true}, {false, true}, {true, false}}).all());
    EXPECT_EQ(measurements.observations.row(1).tail(3), Eigen::RowVector3d(4, 5, 6));
    EXPECT_EQ(measurements.observations.row(2).head(3), Eigen::RowVector3d(7, 8, 9));
    EXPECT_TRUE(measurements.observations.allFinite());
    const Measurements means = mean_measurements(*crane().sensor, measurements);
    EXPECT_EQ(means.observations(0, 0), 1);
    EXPECT_EQ(means.observations(0, 3), 4);
}

TEST(ReadMeasurementsCsv, CellsOfNanAreATargetThatWasNotSeen) {
    for (const std::string nan : {"nan", "NaN", "NAN"}) {
        expect_equal(read_rows(replaced(good, "10,11,12", nan + ',' + nan + ',' + nan)),
                     read_rows(replaced(good, "10,11,12", ",,")));
    }
}

TEST(ReadMeasurementsCsv, TheRobotMayComeBackToAPose) {
    const Measurements measurements = read_rows(replaced(good, "0.25", "0.2"));
    EXPECT_EQ(measurements.ids, (std::vector<std::string>{"a", "b"}));
    EXPECT_EQ(measurements.configurations.row(0), measurements.configurations.row(1));
}

TEST(ReadMeasurementsCsv, RadiansALittleBeyondTheLimitsAreRadians) {
    EXPECT_EQ(read_rows(replaced(good, "b,0,0.1", "b,0,12.5")).configurations(1, 0), 12.5);
}

TEST(ReadMeasurementsCsv, DoesNotMindWhichTargetsWerePlannedToBeVisible) {
    std::string text = replaced(good, "config,", "visible_targets,config,");
    for (const char* row : {"\na,0", "\na,1", "\nb,0"}) {
        text = replaced(text, row, "\n1 2," + std::string(row + 1));
    }
    expect_equal(read_rows(text), read_rows(good));
    expect_equal(read_rows(replaced(text, "1 2,b", "2,b")), read_rows(good));
}

TEST(ReadMeasurementsCsv, ConvertsDegreesAndMillimetres) {
    const auto text =
        "lift_mm,config,q2_deg,q1_mrad,p2_z_mm,p1_x_um,p1_y_m,p1_z_m,p2_x_m,p2_y_m\n"
        "312,a,90,100,1.5,2,0,0,0,0\n";
    const Measurements measurements = read_rows(text);
    EXPECT_EQ(measurements.configurations(0, 0), 0.1);
    EXPECT_DOUBLE_EQ(measurements.configurations(0, 1), std::numbers::pi / 2);
    EXPECT_EQ(measurements.configurations(0, 2), 0.312);
    EXPECT_EQ(measurements.observations(0, 0), 2e-6);
    EXPECT_EQ(measurements.observations(0, 5), 1.5e-3);
}

TEST(ReadMeasurementsCsv, DoesNotMindHowTheFileWasSaved) {
    const Measurements plain = read_rows(good);
    const auto with = [](char from, const std::string& to) {
        std::string text;
        for (const char c : good) text += c == from ? to : std::string(1, c);
        return text;
    };
    expect_equal(read_rows("\xEF\xBB\xBF" + good), plain);
    expect_equal(read_rows(with('\n', "\r\n")), plain);
    expect_equal(read_rows(with(',', ";")), plain);
    expect_equal(read_rows(with(',', "\t")), plain);
    expect_equal(read_rows(with(',', " , ")), plain);
    expect_equal(read_rows("# made by hand\n\n# more, of it\n" + with('\n', "\n\n")), plain);
    expect_equal(read_rows(good.substr(0, good.size() - 1)), plain);
    expect_equal(read_rows(replaced(replaced(good, "config", "\"config\""), "b,0", "\"b\",\"0\"")),
                 plain);
}

TEST(ReadMeasurementsCsv, DoubledQuotationMarksInQuotesAreOne) {
    const Measurements measurements = read_rows(replaced(good, "b,0", "\"b \"\"2\"\"\" ,\"0\""));
    EXPECT_EQ(measurements.ids, (std::vector<std::string>{"a", "b \"2\""}));
    EXPECT_EQ(measurements.configurations(1, 1), 0.25);
}

TEST(ReadMeasurementsCsv, IsFastEnoughForAHundredThousandRows) {
    std::string text = good.substr(0, good.find('\n') + 1);
    for (int i = 0; i < 100000; ++i) {
        text += std::to_string(i) + ",0,0.123456789,0." + std::to_string(100000 + i) +
                ",0.3,1107.234,1279.674,1325.723,1191.728,1224.966,1292.864\n";
    }
    const TemporaryFolder folder;
    const std::string path = folder.write("m.csv", text);
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(read_measurements_csv(path, crane()).configuration_count(), 100000);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10));
}

TEST(WriteMeasurementsCsv, IsReadBackExactly) {
    Measurements measurements = read_rows(good);
    measurements.ids = {"a \"1\", \"left\"", "#2"};
    measurements.configurations(0, 0) = 1.0 / 3;
    measurements.observations(0, 3) = 0.1 + 0.2;
    const TemporaryFolder folder;
    write_measurements_csv(folder.path("m.csv"), crane(), measurements, {"seed 1", "by hand"});
    const Measurements again = read_measurements_csv(folder.path("m.csv"), crane());
    EXPECT_EQ(again.ids, measurements.ids);
    EXPECT_EQ(again.first_sample, measurements.first_sample);
    EXPECT_EQ(again.configurations.leftCols(2), measurements.configurations.leftCols(2));
    EXPECT_LT((again.observations - measurements.observations).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(WriteMeasurementsCsv, LeavesTargetsThatWereNotSeenEmpty) {
    Measurements measurements = read_rows(good);
    measurements.is_seen(1, 0) = measurements.is_seen(2, 1) = false;
    measurements.observations.row(1).head(3).setConstant(std::nan(""));
    const TemporaryFolder folder;
    const std::string path = folder.path("m.csv");
    write_measurements_csv(path, crane(), measurements);
    const std::string text = read_file(path);
    EXPECT_NE(text.find("\na,1,0.1,0.2,300,,,,4000,5000,6000\n"), std::string::npos) << text;
    EXPECT_NE(text.find("\nb,0,0.1,0.25,300,7000,8000,9000,,,\n"), std::string::npos) << text;
    const Measurements again = read_measurements_csv(path, crane());
    EXPECT_TRUE((again.is_seen == measurements.is_seen).all());
    EXPECT_EQ(again.observations.row(1).tail(3), measurements.observations.row(1).tail(3));
}

TEST(WriteMeasurementsCsv, KeepsACommentInItsLine) {
    const TemporaryFolder folder;
    write_measurements_csv(folder.path("m.csv"), crane(), read_rows(good), {"two\nlines"});
    EXPECT_EQ(read_measurements_csv(folder.path("m.csv"), crane()).ids, read_rows(good).ids);
}

TEST(WriteMeasurementsCsv, RefusesNumbersThatAreNotFinite) {
    Measurements measurements = read_rows(good);
    measurements.observations(0, 0) = std::numeric_limits<double>::infinity();
    const TemporaryFolder folder;
    const std::string message = input_error_of(
        [&] { write_measurements_csv(folder.path("m.csv"), crane(), measurements); });
    EXPECT_EQ(message.rfind("m.csv: is not written", 0), 0U) << message;
    EXPECT_EQ(folder.file_count(), 0U);
}

TEST(BadMeasurementsCsv, MissingFile) {
    const TemporaryFolder folder;
    EXPECT_EQ(input_error_of([&] { read_measurements_csv(folder.path("m.csv"), crane()); }),
              "m.csv: cannot be read: No such file or directory");
}

void expect_rows_messages(const std::vector<testing::Slip>& slips) {
    testing::expect_messages(good, slips, rows_error, "m.csv:");
}

TEST(BadMeasurementsCsv, Headers) {
    expect_rows_messages({
        {good, "", " is empty; must begin with a header like config,sample,q1_rad,...,p1_x_mm,..."},
        {good, "# only a comment\n", " is empty;[...]"},
        {good, good.substr(0, good.find('\n') + 1),
         " has a header but no rows; must have at least one row"},
        {",p2_z_m\n", "\n",
         "1:70: missing column p2_z_mm; the header must have "
         "config,sample,q1_rad,q2_rad,lift_mm,p1_x_mm,p1_y_mm,p1_z_mm,p2_x_mm,p2_y_mm,p2_z_mm"},
        {"config,", "", "1:70: missing column config;[...]"},
        {"q2_rad", "q4_rad",
         "1:22: column 'q4_rad' is unknown, the campaign's robot has 3 joints; did you mean "
         "'q1_rad'?"},
        {"p2_x_m", "p3_x_m",
         "1:57: column 'p3_x_m' is unknown, the campaign states 2 targets; did you mean "
         "'p1_x_mm'?"},
        {"q2_rad", "q1_deg", "1:22: column 'q1_deg' occurs twice; keep one"},
        {"q2_rad", "q2", "1:22: column 'q2' has no unit; must be like q2_rad"},
        {"p2_x_m", "p2_x", "1:57: column 'p2_x' has no unit; must be like p2_x_mm"},
        {"lift_m", "lift_deg",
         "1:29: column 'lift_deg' has the wrong kind of unit; must be like lift_mm"},
    });
}

TEST(ReadMeasurementsCsv, PassesOverColumnsThatNobodyAskedFor) {
    std::string text;
    std::istringstream lines(good);
    for (std::string line; std::getline(lines, line);) {
        text += text.empty() ? "clock," + line + ",operator,p1_rms_mm,\n"
                             : "12:00," + line + ",me,x,\n";
    }
    const TemporaryFolder folder;
    const MeasurementsFile file = read_measurements_csv(folder.write("m.csv", text), crane());
    EXPECT_EQ(file.unused_columns,
              (std::vector<std::string>{"clock", "operator", "p1_rms_mm", ""}));
    expect_equal(file, read_rows(good));
    EXPECT_TRUE(read_measurements_csv(folder.write("m.csv", good), crane()).unused_columns.empty());
}

/// Nor is one passed over that was meant for something else.
TEST(BadMeasurementsCsv, Misspelt) {
    expect_rows_messages({
        {"sample", "sampel", "1:8: column 'sampel' is unknown; did you mean 'sample'?"},
        {"config", "pose",
         "1:75: missing column config; the header must have [...]p2_z_mm, and does "
         "not "
         "need 'pose'"},
        {"config,sample", "confg,time", "1:1: column 'confg' is unknown; did you mean 'config'?"},
        {"sample,q1_rad", "clock,elbow",
         "1:75: missing column q1_rad; the header must have [...]p2_z_mm, and does not need "
         "'clock' "
         "or 'elbow'"},
        {"sample", "q4_rad",
         "1:8: column 'q4_rad' is unknown, the campaign's robot has 3 joints; [...]"},
        {"sample", "p3_x_m",
         "1:8: column 'p3_x_m' is unknown, the campaign states 2 targets; [...]"},
        {"sample", "visible_target",
         "1:8: column 'visible_target' is unknown; did you mean "
         "'visible_targets'?"},
        {"sample", "purposes", "1:8: column 'purposes' is unknown; did you mean 'purpose'?"},
    });
}

TEST(BadMeasurementsCsv, Numbers) {
    const std::string rule = "; must be a finite number with a decimal point";
    const std::string some =
        " is empty, but not all cells of target 1 are; must be a number, or all empty if it was "
        "not seen";
    expect_rows_messages({
        {"1.5", "1.5mm", "3:17: '1.5mm' is not a number" + rule},
        {"0.25", "", "4:9: '' is not a number" + rule},
        {"1.5", "", "3:17: p1_x" + some},
        {"1.5,2,3", "1.5,,3", "3:21: p1_y" + some},
        {"1.5,2,3", ",,3", "3:17: p1_x" + some},
        {"10,11,12", "nan,11,12",
         "4:24: p2_x is not a number, but not all cells of target 2 are; must be a number, or all "
         "empty if it was not seen"},
        {"0.25", "nan", "4:9: 'nan' is not finite" + rule},
        {"1.5", "inf", "3:17: 'inf' is not finite" + rule},
        {"1.5", "-inf", "3:17: '-inf' is not finite" + rule},
        {"1.5", "1e999", "3:17: '1e999' is beyond the range of numbers; mu[...]"},
        {"b,0,0.1", "b,0,45",
         "4:5: q1 = 45 rad is more than four turns beyond its limits (-1.5708 to 1.5708 rad) and "
         "looks like degrees; state degrees as such"},
        {"0.25", "1e300", "[...]'1e300' is out of any cell; must be at most 10000 rad[...]"},
    });
}

TEST(BadMeasurementsCsv, Rows) {
    expect_rows_messages({
        {"b,0,0.1,0.25,0.3,7,8,9,10,11,12",
         "b,0,0.1,0.2,0.3,1,2,3,4,5,6\nb,1,0.1,0.2,0.3,1.5,2,3,4,5,6",
         "4:5: configuration 'b' has the same joint values and readings as 'a' (line 2), and 1 of "
         "2 "
         "are such copies; every reading must be in the file once"},
        {"4,5,6\na,1", "4,5\na,1", "2:26: row has 10 fields; must have 11 as the header"},
        {"4,5,6\na,1", "4,5,6,7\na,1",
         "2:29: row has 12 fields; must have 11 as the header; are there decimal commas?"},
        {"7,8,9,10,11,12", ",,,,,",
         "4:18: the sample shows no target; must show one at least, or be left out"},
        {"a,1,0.1,0.2,", "a,1,0.1,0.201,",
         "3:9: configuration 'a' has q2 = 0.201 here and 0.2 before (line 2); samples of one "
         "configuration must agree within 1e-6 (rad or m)"},
        {"a,1", "a,0", "3:1: sample '0' of configuration 'a' occurs twice; keep one"},
        {"b,0", ",0", "4:1: config is empty; must be an id"},
        {"b,0", "\"b,0", "4:1: a quotation mark is not closed in its line"},
        {"b,0", "\"b\"c,0",
         "4:3: a quotation mark is closed before the cell ends; must be doubled inside quotes"},
        {"b,0", "#b,0",
         "4:1: the row begins with '#', which is a comment only before the header; must be left "
         "out, or have its first cell in quotes"},
        {"b,0", "b\xE9,0", "4:2: is not UTF-8 text here; must be UTF-8 (or plain ASCII)"},
        {"b,0", "b\xED\xA0\x80,0", "4:2: is not UTF-8 text here; must be UTF-8 (or plain ASCII)"},
        {good, "config,sample\ra,0\r", " has line ends of CR only; must be of LF or CR LF"},
    });
    EXPECT_EQ(rows_error(replaced(good, "a,1,0.1,0.2,", "a,1,0.1,0.2000005,")), "no error");
}

}  // namespace
}  // namespace posewise::io
