#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>

#include "../../src/report/plot.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "support/cells.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::detail {
namespace {

std::size_t lines_of(const std::string& script, const std::string& data) {
    const auto begin = script.find('$' + data + " << EOD\n");
    if (begin == std::string::npos) return 0;
    const auto end = script.find("EOD\n", begin + data.size() + 9);
    return static_cast<std::size_t>(std::count(script.begin() + static_cast<std::ptrdiff_t>(begin),
                                               script.begin() + static_cast<std::ptrdiff_t>(end),
                                               '\n')) -
           1;
}

class PlanPlotScript : public ::testing::Test {
  protected:
    PlanPlotScript() {
        campaign_.cell = testing::demo_cell();
        plan_.campaign = "it's\n`touch x`";
        for (const double turn : {0.1, -0.4, 0.7}) {
            plan_.poses.push_back({"p", VectorXd::Constant(6, turn), 1, {}});
        }
    }
    Campaign campaign_ = testing::cell_campaign();
    Plan plan_;
};

TEST_F(PlanPlotScript, DrawsEachPoseTwiceWithTheCell) {
    const Scene scene = make_scene(campaign_);
    const std::string script = plan_plot_script(plan_, scene, "out.svg");
    for (const std::string from : {"side", "above"}) {
        EXPECT_EQ(lines_of(script, "arms_" + from), 3U * (9 + 1));  // base, joints, flange, targets
        EXPECT_EQ(lines_of(script, "targets_" + from), 3U);
        EXPECT_EQ(lines_of(script, "tracker_" + from), 1U);
    }
    // A sphere, a box, and a capsule that stands upright: a circle from above. Each is closed, and
    // ends with an empty line.
    EXPECT_EQ(lines_of(script, "cell_side"), 34U + 6 + 36);
    EXPECT_EQ(lines_of(script, "cell_above"), 34U + 6 + 34);
    const Vector3d end = arm_places(scene, plan_.poses[2].configuration).back();
    EXPECT_NE(script.find(fmt::format("{:.4f} {:.4f} 3\nEOD", end.x(), end.z())),
              std::string::npos);
    EXPECT_NE(script.find(fmt::format("{:.4f} {:.4f} 3\nEOD", end.x(), end.y())),
              std::string::npos);
    EXPECT_NE(script.find("set arrow from graph 0, first -0.6700"), std::string::npos) << "floor";
    EXPECT_NE(script.find("set arrow from graph 0, first 2.2000"), std::string::npos) << "wall";
    EXPECT_NE(script.find("title 'it''s `touch x`' noenhanced"), std::string::npos);
}

TEST_F(PlanPlotScript, IsOfARobot) {
    EXPECT_THROW(plan_plot_script(plan_, make_scene(campaign_), "out.pdf"), InputError);
    plan_.poses = {{"0", VectorXd(), 1, {}}};
    EXPECT_THROW(plan_plot_script(plan_, make_scene(campaign_), "out.svg"), InputError);
}

TEST(ResidualPlotScript, DrawsReadingsInOrderAndHowManyAreOff) {
    Campaign campaign = testing::cell_campaign();
    campaign.name = "a 'b'";
    const Measurements measured = simulate(campaign, {.pose_count = 12}).measurements;
    const Calibration found = calibrate(campaign, measured);
    auto readings = list_residuals(found, measured);
    const std::string script = residual_plot_script(found.campaign, readings, "out.svg");
    for (const char* const data : {"order", "nominal", "calibrated", "held_out"}) {
        EXPECT_EQ(lines_of(script, data), 36U) << data;
    }
    EXPECT_NE(script.find("residual (mm)"), std::string::npos);
    EXPECT_NE(script.find("title 'a ''b''' noenhanced"), std::string::npos);
    for (ReadingResidual& one : readings) one.held_out.reset();
    EXPECT_EQ(lines_of(residual_plot_script(found.campaign, readings, "a.svg"), "held_out"), 0U);
    EXPECT_THROW(residual_plot_script(found.campaign, {}, "a.svg"), InputError);
    EXPECT_THROW(residual_plot_script(found.campaign, readings, "a.pdf"), InputError);
}

/// gnuplot draws what the scripts say, and complains of nothing.
TEST_F(PlanPlotScript, AndResidualsAreDrawnByGnuplot) {
    if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no gnuplot here";
    const testing::TemporaryFolder folder;
    const Measurements measured = simulate(campaign_, {.pose_count = 12}).measurements;
    const Calibration found = calibrate(campaign_, measured);
    const std::string plan = folder.path("plan.svg"), left = folder.path("left.svg");
    for (const auto& [image, script] :
         {std::pair{plan, plan_plot_script(plan_, make_scene(campaign_), plan)},
          std::pair{left,
                    residual_plot_script(found.campaign, list_residuals(found, measured), left)}}) {
        const std::string path = folder.write("script", script);
        const std::string line = "gnuplot " + path + " 2> " + folder.path("said");
        EXPECT_EQ(std::system(line.c_str()), 0);
        EXPECT_EQ(std::filesystem::file_size(folder.path("said")), 0U);
        EXPECT_GT(std::filesystem::file_size(image), 5000U);
    }
}

}  // namespace
}  // namespace posewise::detail
