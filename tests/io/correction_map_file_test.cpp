#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <sstream>

#include "io/format/atomic_file.hpp"
#include "posewise/io/robot_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaigns.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace testing;

CorrectionMap map_of_a_robot_that_bends() {
    Campaign campaign = tracked_campaign(fanuc());
    campaign.robot = with_harmonics(with_torque_shapes(campaign.robot), {1, 2});
    campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
    return correction_map(campaign, draw_truth(campaign, 3));
}

TEST(CorrectionMapFile, IsACFunctionThatSaysTheSame) {
    if (std::system("cc --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "no C compiler";
    const TemporaryFolder folder;
    const CorrectionMap map = map_of_a_robot_that_bends();
    const std::string path = folder.path("map.c");
    write_correction_map(path, "a cell */ with a name", map);
    detail::write_file(folder.path("main.c"),
                       "#include <stdio.h>\n#include \"map.c\"\nint main(void) {\n    double "
                       "q[POSEWISE_JOINTS] = {0.3, -0.2, 0.5, 1.1, -0.7, 2.2}, "
                       "sent[POSEWISE_JOINTS];\n    int j;\n    posewise_joints_to_send(q, sent);\n"
                       "    for (j = 0; j < POSEWISE_JOINTS; ++j) printf(\"%.15g\\n\", sent[j]);\n"
                       "    return 0;\n}\n");
    const std::string build = fmt::format(
        "cd '{}' && cc -std=c99 -Wall -Wextra -Werror -pedantic main.c -lm -o main && ./main > out",
        std::string(folder.path("")));
    ASSERT_EQ(std::system(build.c_str()), 0);
    VectorXd q(6);
    q << 0.3, -0.2, 0.5, 1.1, -0.7, 2.2;
    const VectorXd wanted = joints_to_send(map, q);
    EXPECT_GT((wanted - q).cwiseAbs().maxCoeff(), 1e-5);
    std::istringstream out(detail::read_file(folder.path("out")));
    for (const double value : wanted) {
        double sent = 0;
        ASSERT_TRUE(out >> sent);
        EXPECT_NEAR(sent, value, 1e-12);
    }
}

TEST(CorrectionMapFile, SaysHowItIsUsedAndHowFarItIsOff) {
    const TemporaryFolder folder;
    const CorrectionMap map = map_of_a_robot_that_bends();
    for (const char* const name : {"map.c", "map.csv"}) {
        const std::string path = folder.path(name);
        write_correction_map(path, "cell", map);
        const std::string text = detail::read_file(path);
        EXPECT_NE(text.find("with --geometry estimate"), std::string::npos) << text;
        EXPECT_NE(text.find(fmt::format("{:.4f} mm RMS", 1e3 * map.geometry_alone.rms)),
                  std::string::npos);
        EXPECT_NE(text.find(fmt::format("{:.4f} mm RMS", 1e3 * map.with_map.rms)),
                  std::string::npos);
    }
    const std::string table = detail::read_file(folder.path("map.csv"));
    EXPECT_NE(table.find("\nfactors,q1_rad,q2_rad,"), std::string::npos);
    EXPECT_NE(table.find("\ncos(2 q1),"), std::string::npos) << table;
    EXPECT_NE(input_error_of([&] {
                  write_correction_map(folder.path("map.txt"), "cell", map);
              }).find("must end in .c"),
              std::string::npos);
}

}  // namespace
}  // namespace posewise::io
