#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "../../src/report/plot.hpp"
#include "../../src/report/study_table.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/report/reports.hpp"

namespace posewise {
namespace {

using namespace detail;

StudyCase identified(std::vector<Index> poses, double rms, double max) {
    StudyCase result;
    result.poses = std::move(poses);
    result.identified = true;
    result.held_out.point_count = 3;
    result.held_out.rms = rms;
    result.held_out.p95 = max / 2;
    result.held_out.max = max;
    result.expected = rms / 2;
    return result;
}

Study study_of(std::vector<StudyRow> rows) {
    return {"robot", {"a", "b,c", "d"}, {Criterion::D}, std::move(rows), Ending::Converged, {}};
}

/// Two pose counts; at the first, one of three random subsets cannot identify the model.
Study example_study() {
    StudyCase unidentified;
    unidentified.poses = {0, 2};
    return study_of(
        {{2,
          {identified({0, 1}, 3e-4, 9e-4)},
          {unidentified, identified({1, 2}, 2e-3, 4e-3), identified({1, 2}, 2e-3, 4e-3)}},
         {3, {identified({0, 1, 2}, 2e-4, 5e-4)}, {identified({0, 1, 2}, 4e-4, 8e-4)}}});
}

Study named(const std::string& campaign) {
    Study study = example_study();
    study.campaign = campaign;
    return study;
}

TEST(StudyTable, ShowsErrorsInMillimetresAndCountsTheUnidentified) {
    const Table table = study_table(example_study());
    EXPECT_EQ(table.header, (std::vector<std::string>{"poses", "d/mm", "random 10 %/mm", "50 %/mm",
                                                      "90 %/mm", "subsets", "unidentified"}));
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(table.rows[0],
              (std::vector<std::string>{"2", "0.3000", "2.0000", "2.0000", "-", "3", "1"}));
    EXPECT_EQ(table.rows[1],
              (std::vector<std::string>{"3", "0.2000", "0.4000", "0.4000", "0.4000", "1", "0"}));
}

TEST(StudyTable, ShowsADashWhereNothingWasIdentified) {
    const Table table = study_table(study_of({{2, {StudyCase{}}, {}}}));
    EXPECT_EQ(table.rows[0], (std::vector<std::string>{"2", "-", "-", "-", "-", "0", "-"}));
}

template <class Studies>
std::string csv_of(const Studies& studies) {
    std::string text;
    write_study_csv(studies, [&](std::string_view part) { text += part; });
    return text;
}

TEST(StudyTable, HasErrorsInAnImageInPixels) {
    Study study = example_study();
    study.units = &pixel_units;
    const Table table = study_table(study);
    EXPECT_EQ(table.header, (std::vector<std::string>{"poses", "d/px", "random 10 %/px", "50 %/px",
                                                      "90 %/px", "subsets", "unidentified"}));
    EXPECT_EQ(table.rows[0][1], "0.3000");
    EXPECT_NE(csv_of(study).find("held_out_rms_px,held_out_max_px,held_out_p95_px,expected_rms_px"),
              std::string::npos);
    EXPECT_NE(answer({study}).front().text.find("leave 0.2 px"), std::string::npos)
        << answer({study}).front().text;
}

TEST(StudyCsv, HoldsEveryCase) {
    EXPECT_EQ(csv_of(example_study()),
              "poses,chosen_by,subset,identified,held_out_rms_mm,held_out_max_mm,held_out_p95_mm,"
              "expected_rms_mm,configurations\n"
              "2,d,0,yes,0.3,0.9,0.45,0.15,\"a b,c\"\n"
              "2,random,0,no,,,,,a d\n"
              "2,random,1,yes,2,4,2,1,\"b,c d\"\n"
              "2,random,2,yes,2,4,2,1,\"b,c d\"\n"
              "3,d,0,yes,0.2,0.5,0.25,0.1,\"a b,c d\"\n"
              "3,random,0,yes,0.4,0.8,0.4,0.2,\"a b,c d\"\n");
}

/// Of two models, the second twice as accurate.
std::vector<Study> two_models() {
    std::vector<Study> studies;
    for (const double scale : {1.0, 0.5}) {
        Study study = study_of({{2,
                                 {identified({0, 1}, scale * 3e-4, scale * 9e-4)},
                                 {identified({1, 2}, scale * 1e-3, scale * 2e-3)}}});
        study.splits = 1;
        study.test_count = 1;
        study.model = scale == 1 ? "geometric" : "full";
        studies.push_back(std::move(study));
    }
    return studies;
}

TEST(ModelsTable, ShowsEachModelAgainstItsRandomSubsetsAndThoseOfTheFirst) {
    const Table table = models_table(two_models());
    EXPECT_EQ(table.header,
              (std::vector<std::string>{"poses", "model", "random/mm", "d/mm", "d/random", "95 %",
                                        "d/random geometric", "unidentified"}));
    ASSERT_EQ(table.rows.size(), 2u);
    EXPECT_EQ(table.rows[0], (std::vector<std::string>{"2", "geometric", "1.0000", "0.3000", "0.30",
                                                       "-", "0.30", "0"}));
    EXPECT_EQ(table.rows[1], (std::vector<std::string>{"2", "full", "0.5000", "0.1500", "0.30", "-",
                                                       "0.15", "0"}));
    EXPECT_NE(format(two_models()).find("\nfull, d, planned against random: within chance at 2\n"),
              std::string::npos);
}

/// Two splits in which the planned subset is off by so many times the random one.
StudyRow row_with_ratios(Index pose_count, double first, double second) {
    std::vector<StudyCase> optimal, random;
    for (const Index split : {0, 1}) {
        optimal.push_back(identified({0, 1}, (split == 0 ? first : second) * 1e-3, 2e-3));
        random.push_back(identified({1, 2}, 1e-3, 2e-3));
        optimal.back().split = random.back().split = split;
    }
    return {pose_count, optimal, random};
}

TEST(FormatStudy, CallsWithinChanceWhatMayBeChanceInEitherDirection) {
    Study study = study_of({row_with_ratios(2, 0.5, 0.501), row_with_ratios(3, 0.5, 1.5),
                            row_with_ratios(4, 0.9, 2.0), row_with_ratios(5, 1.5, 1.501),
                            row_with_ratios(6, 0.7, 0.9), row_with_ratios(7, 1.0, 1.0)});
    study.splits = 2;
    study.test_count = 1;
    study.rows.push_back({8, {StudyCase{}, StudyCase{}}, {StudyCase{}}});
    study.rows.push_back(row_with_ratios(9, 0.5, 0.6));
    study.rows.back().random = {StudyCase{}, study.rows.back().random[1]};
    EXPECT_NE(
        format(study).find("\nd, planned against random: better at 2; within chance at 3, 4, "
                           "6, 7, 9; loses at 5; not known at 8; splits left out, whose random "
                           "subsets do not identify the model: 1 of 2 at 9\n"),
        std::string::npos)
        << format(study);
}

TEST(DescribeFewJudged, SaysHowFewPosesTheAccuracyRestsOn) {
    Study study = example_study();
    EXPECT_EQ(describe_few_judged(study), "") << "with 3 of 3 poses nothing is judged";
    study.ids.emplace_back("e");
    EXPECT_EQ(describe_few_judged(study),
              "the accuracy with 3 poses is judged on 1 pose only, what they leave, which says "
              "little of others; the largest `pose_count` must be smaller, or more poses measured");
    study.ids.resize(7);
    EXPECT_EQ(describe_few_judged(study), "");
    study.splits = 2;
    study.test_count = 3;
    EXPECT_EQ(describe_few_judged(study),
              "each split judges on 3 poses only, which says little of others; `holdout` must be "
              "larger, or more poses measured");
    const auto sureness = [&] { return answer({study}).at(1).text; };
    EXPECT_TRUE(
        sureness().ends_with("; each split judges on 3 poses only, which says little of "
                             "others"))
        << sureness();
    study.test_count = 4;
    EXPECT_EQ(describe_few_judged(study), "");
    EXPECT_EQ(sureness().find("little"), std::string::npos);
    EXPECT_EQ(answer({study})[1].text.find("every subset"), std::string::npos);
    study.splits = 0;
    EXPECT_EQ(answer({study})[1].text, "every subset was judged on the poses it leaves, here 4");
}

TEST(FormatStudy, SaysHowManyRobotsOfEachVariationThereWereTimeFor) {
    std::vector<Study> studies = two_models();
    for (Study& study : studies) study.is_simulated = true;
    EXPECT_NE(format(studies).find("; 1 robot drawn, the same"), std::string::npos);
    studies[0].splits = 7;
    const std::string text = format(studies);
    EXPECT_NE(text.find("; 7, 1 robots drawn, the same"), std::string::npos) << text;
}

TEST(ModelsCsv, BeginsWithTheModel) {
    EXPECT_EQ(csv_of(two_models()),
              "model,poses,chosen_by,subset,identified,held_out_rms_mm,held_out_max_mm,"
              "held_out_p95_mm,expected_rms_mm,configurations\n"
              "geometric,2,d,0,yes,0.3,0.9,0.45,0.15,\"a b,c\"\n"
              "geometric,2,random,0,yes,1,2,1,0.5,\"b,c d\"\n"
              "full,2,d,0,yes,0.15,0.45,0.225,0.075,\"a b,c\"\n"
              "full,2,random,0,yes,0.5,1,0.5,0.25,\"b,c d\"\n");
}

TEST(StudyPlotScript, DrawsTheLinesOfEachModel) {
    const auto script = study_plot_script(two_models(), "out.svg");
    for (const char* const title : {"'random, median, geometric'", "'random, median, full'",
                                    "'optimal, D, geometric'", "'optimal, D, full'"}) {
        EXPECT_NE(script.find(title), std::string::npos) << script;
    }
    EXPECT_NE(script.find("$optimal1 << EOD\n2 0.15\nEOD\n"), std::string::npos);
}

TEST(StudyPlotScript, DrawsAPanelForEachOfManyModels) {
    std::vector<Study> studies = two_models();
    studies.push_back(studies[1]);
    studies[2].model = "it's full";
    const auto script = study_plot_script(studies, "out.svg");
    EXPECT_NE(script.find("set multiplot layout 2,2"), std::string::npos) << script;
    for (const char* const text :
         {"set title 'geometric' noenhanced", "set title 'it''s full' noenhanced",
          "$random_0 using 1:2:4", "$random_2 using 1:2:4", "$optimal0_1 << EOD\n2 0.15\nEOD\n",
          "'optimal, D'"}) {
        EXPECT_NE(script.find(text), std::string::npos) << text << script;
    }
    EXPECT_EQ(study_plot_script(two_models(), "out.svg").find("multiplot"), std::string::npos);
}

TEST(StudyPlotScript, DrawsBandMedianAndCriterion) {
    const auto script = study_plot_script({example_study()}, "out.svg");
    EXPECT_NE(script.find("$random << EOD\n2 2 2 3\n3 0.4 0.4 0.4\nEOD\n"), std::string::npos);
    EXPECT_NE(script.find("$optimal0 << EOD\n2 0.3\n3 0.2\nEOD\n"), std::string::npos);
    EXPECT_NE(script.find("set logscale y"), std::string::npos);
    EXPECT_NE(script.find("(mm)"), std::string::npos);
}

TEST(StudyPlotScript, QuotesTextsSoThatNothingIsExecuted) {
    const auto script = study_plot_script({named("it's\n`touch x`")}, "o'ut`.png");
    EXPECT_NE(script.find("set title 'it''s `touch x`' noenhanced\n"), std::string::npos);
    EXPECT_NE(script.find("set output './o''ut`.png'\n"), std::string::npos);
}

TEST(StudyPlotScript, RunsNoProgramWhoseNameIsThatOfTheImage) {
    const auto script = study_plot_script({example_study()}, "|touch x.svg");
    EXPECT_NE(script.find("set output './|touch x.svg'\n"), std::string::npos) << script;
}

TEST(StudyPlotScript, RefusesOtherImagesAndEmptyStudies) {
    EXPECT_THROW(study_plot_script({example_study()}, "out.pdf"), InputError);
    EXPECT_THROW(study_plot_script({example_study()}, "a\nb.svg"), InputError);
    EXPECT_THROW(study_plot_script({example_study()}, ".svg"), InputError);
    EXPECT_THROW(study_plot_script({study_of({{2, {StudyCase{}}, {}}})}, "out.svg"), InputError);
}

class RunGnuplot : public ::testing::Test {
  protected:
    void SetUp() override { std::filesystem::create_directories(folder_); }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::string write_script(const std::string& name, const std::string& text) const {
        const std::string path = (folder_ / name).string();
        std::ofstream(path) << text;
        return path;
    }

    const std::filesystem::path folder_ =
        std::filesystem::temp_directory_path() /
        ("posewise_plot_" +
         std::string(::testing::UnitTest::GetInstance()->current_test_info()->name()));
};

TEST_F(RunGnuplot, DrawsIntoFilesWithAwkwardNames) {
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot here";
    for (const std::string name : {"plain.svg", "it's `a` $(name) \"with\" \\ signs.png"}) {
        const auto image = (folder_ / name).string();
        const auto script = study_plot_script({named(name)}, image);
        run_gnuplot(write_script("script with blank.gnuplot", script));
        EXPECT_GT(std::filesystem::file_size(image), 1000u) << name;
    }
    const std::vector<Study> many{named("a"), named("b"), named("c")};
    const auto panels = (folder_ / "panels.svg").string();
    run_gnuplot(write_script("panels.gnuplot", study_plot_script(many, panels)));
    EXPECT_GT(std::filesystem::file_size(panels), 1000u);
}

TEST(StudyPlotScript, GivesASinglePoseCountARange) {
    const auto script = study_plot_script({study_of({example_study().rows[0]})}, "out.svg");
    EXPECT_NE(script.find("set xrange [1:3]\n"), std::string::npos) << script;
}

TEST_F(RunGnuplot, SaysThatItFailed) {
    const auto script = write_script("bad.gnuplot", "exit status 3\n");
    try {
        run_gnuplot(script);
        FAIL() << "no error";
    } catch (const InputError& error) {
        EXPECT_EQ(std::string(error.what()), "gnuplot failed");
    }
}

TEST_F(RunGnuplot, EndsOneThatHangs) {
    const std::string program = write_script("gnuplot", "#!/bin/sh\nexec sleep 1000\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    const std::string path = std::getenv("PATH");
    setenv("PATH", (folder_.string() + ':' + path).c_str(), 1);
    const auto error_of = [&](const std::function<bool()>& is_stopped, int seconds) {
        try {
            run_gnuplot(write_script("any.gnuplot", ""), is_stopped, std::chrono::seconds(seconds));
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const std::string ended = "gnuplot did not end by itself and was ended";
    EXPECT_EQ(error_of({}, 1), ended);
    EXPECT_EQ(error_of([] { return true; }, 1000), ended);
    setenv("PATH", path.c_str(), 1);
}

TEST_F(RunGnuplot, SaysThatGnuplotIsAbsent) {
    const std::string path = std::getenv("PATH");
    setenv("PATH", folder_.c_str(), 1);
    try {
        run_gnuplot(write_script("any.gnuplot", ""));
        ADD_FAILURE() << "no error";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("not installed"), std::string::npos);
    }
    setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace posewise
