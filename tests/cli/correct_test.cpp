#include <fmt/format.h>

#include <Eigen/Geometry>
#include <numbers>
#include <vector>

#include "program.hpp"

/// Nominal configurations corrected for the calibrated robot.
namespace posewise::testing {
namespace {

class Correct : public Program {
  protected:
    void SetUp() override {
        Program::SetUp();
        run_well("simulate " + fanuc_design + " --poses 40 --truth 5 -o m.csv");
        run_well("calibrate " + fanuc_design + " -m m.csv --folds 0 -o e.json");
    }
    /// A row of Cartesian targets: the tool's point on the design's flange at these joints (deg).
    static std::string place_row(const std::string& id, const std::vector<double>& q_deg,
                                 const Eigen::Vector3d& tool_mm) {
        using Eigen::AngleAxisd;
        using Eigen::Translation3d;
        using Eigen::Vector3d;
        const auto turn = [&](std::size_t joint, const Vector3d& axis) {
            return AngleAxisd(q_deg[joint] * std::numbers::pi / 180, axis);
        };
        const Eigen::Isometry3d flange =
            Eigen::Isometry3d::Identity() * turn(0, Vector3d::UnitZ()) * Translation3d(312, 0, 0) *
            turn(1, Vector3d::UnitY()) * Translation3d(0, 0, 1075) * turn(2, -Vector3d::UnitY()) *
            Translation3d(1280, 0, 225) * turn(3, -Vector3d::UnitX()) *
            turn(4, -Vector3d::UnitY()) * turn(5, -Vector3d::UnitX());
        const Vector3d point = flange * tool_mm;
        const Eigen::Quaterniond q(flange.linear());
        std::string row = fmt::format("{},{:.9f},{:.9f},{:.9f},{:.12f},{:.12f},{:.12f},{:.12f}", id,
                                      point.x(), point.y(), point.z(), q.w(), q.x(), q.y(), q.z());
        // Joints near those: not exactly there.
        for (const double value : q_deg) row += fmt::format(",{}", value + 3);
        return row + '\n';
    }

    /// All numbers of two tables, whose notes and ids are the same.
    void expect_same_numbers(const std::string& a, const std::string& b, double tolerance) const {
        std::istringstream first(text_of(a));
        std::istringstream second(text_of(b));
        std::string x;
        std::string y;
        while (std::getline(first, x, ',')) {
            ASSERT_TRUE(std::getline(second, y, ','));
            char* end = nullptr;
            const double value = std::strtod(x.c_str(), &end);
            if (end == x.c_str()) {
                EXPECT_EQ(x, y);
            } else {
                EXPECT_NEAR(value, std::strtod(y.c_str(), nullptr), tolerance);
            }
        }
        EXPECT_FALSE(std::getline(second, y, ','));
    }

    const std::string correct_ = "correct " + fanuc_design + " e.json --poses ";
};

TEST_F(Correct, LeavesLessThanAHundredthOfTheError) {
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "a,10,20,30,40,50,60\n"
               "\"b,c\",-80,-20,0,-40,-70,0\n");
    const std::string text = run_well(correct_ + "p.csv -o c.csv");
    for (const char* const row : {"position RMS/mm", "position max/mm", "orientation RMS/mrad"}) {
        EXPECT_GT(number_behind(text, row), 0.1) << row;
        EXPECT_LT(number_behind(text, row, 1), 0.01 * number_behind(text, row)) << row;
    }
    EXPECT_EQ(text.find("Not corrected completely"), std::string::npos) << text;
    const std::string csv = text_of("c.csv");
    EXPECT_EQ(csv.rfind("config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg,residual_mm,"
                        "residual_mrad,uncorrected_mm,uncorrected_mrad,note\na,",
                        0),
              0U)
        << csv;
    EXPECT_NE(csv.find("\n\"b,c\",-"), std::string::npos) << csv;
    EXPECT_NEAR(std::strtod(csv.c_str() + csv.find("\na,") + 3, nullptr), 10, 0.5);

    const Outcome again = run(correct_ + "c.csv -o d.csv");
    EXPECT_EQ(again.code, 1);
    EXPECT_NE(again.err.find("so is what correct wrote"), std::string::npos) << again.err;

    // Another base turns and moves every pose; the correction brings them there all the same.
    const std::string moved = run_well(correct_ + "p.csv --base campaign");
    EXPECT_NE(number_behind(moved, "position RMS/mm"), number_behind(text, "position RMS/mm"));
    EXPECT_LT(number_behind(moved, "position RMS/mm", 1), 1e-3);
}

TEST_F(Correct, TakesAProgramThatComesBackToItsPoses) {
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "home,10,20,30,40,50,60\nweld,-80,-20,0,-40,-70,0\nhome,10,20,30,40,50,60\n"
               "end,10,20,30,40,50,60\n");
    EXPECT_NE(run_well(correct_ + "p.csv -o c.csv").find("4 configurations corrected"),
              std::string::npos);
    std::istringstream lines(text_of("c.csv"));
    std::vector<std::string> rows;
    for (std::string line; std::getline(lines, line);) rows.push_back(line);
    ASSERT_EQ(rows.size(), 5U);
    EXPECT_EQ(rows[1], rows[3]);
    EXPECT_EQ(rows[1].substr(4), rows[4].substr(3));
}

TEST_F(Correct, WritesWhatIsReadAsConfigurations) {
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "a,10,20,30,40,50,60\nstretched,10,20,30,40,0.01,60\n\"b,c\",-80,-20,0,-40,-70,0\n");
    run_well(correct_ + "p.csv -o c.csv");
    EXPECT_NE(text_of("c.csv").find(",singular\n"), std::string::npos);
    run_well("simulate " + fanuc_design + " --configurations c.csv -o s.csv");
    EXPECT_NE(text_of("s.csv").find("\n\"b,c\",0,-"), std::string::npos) << text_of("s.csv");
    run_well("calibrate " + fanuc_design + " -m m.csv --folds 0 --predict c.csv");
    run_well(correct_ + "c.csv --force");
    // Measurements have no such columns; nor is one there twice.
    expect_input_error("calibrate " + fanuc_design + " -m c.csv",
                       "missing columns p1_x_mm, p1_y_mm,");
    std::string twice = text_of("c.csv");
    write_text("twice.csv", twice.replace(twice.find("residual_mrad"), 13, "residual_mm"));
    expect_input_error("simulate " + fanuc_design + " --configurations twice.csv -o s2.csv",
                       "column 'residual_mm' occurs twice; keep one");
}

TEST_F(Correct, NamesTheJointThatIsHeld) {
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "stretched,10,20,30,40,0.01,60\n");
    const std::string text = run_well(correct_ + "p.csv -o c.csv");
    EXPECT_NE(text.find("Not corrected completely: 1 of 1"), std::string::npos) << text;
    // Joints that would gain hardly anything do not turn far for it.
    EXPECT_NE(text.find(" singular\n"), std::string::npos) << text;
    EXPECT_LT(number_behind(text, "q4 "), 1) << text;
    EXPECT_NE(text_of("c.csv").find(",singular\n"), std::string::npos);
    const std::string held =
        run_well(correct_ + "p.csv --largest-change-deg 0.05 --force -o held.csv");
    EXPECT_NE(held.find("at the largest change"), std::string::npos) << held;
    EXPECT_NE(text_of("held.csv").find("at the largest change"), std::string::npos);
    const std::string placed = run_well(correct_ + "p.csv --mm-per-mrad 0 --tool-mm 100 0 50");
    EXPECT_EQ(placed.find("Not corrected completely"), std::string::npos) << placed;
    EXPECT_EQ(number_behind(placed, "position max/mm", 1), 0);
}

TEST_F(Correct, ReplacesTheJointTargetsOfAProgram) {
    const std::string program =
        "def weld():\n  # by hand\n  movej([0.1, 0.2, 0.3, 0.4, 0.5, 0.6], a=1.4, v=1.05, r=0.02)\n"
        "  movel(p[0.5, 0, 0.8, 0, 3.14, 0])\n  movej([-1.2, -0.3, 0.1, -0.7, -1.1, 0], "
        "a=1)\nend\n";
    write_text("weld.script", program);
    const Outcome outcome = run(correct_ + "weld.script --for ur -o corrected.script");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("2 targets corrected: corrected.script"), std::string::npos)
        << outcome.out;
    EXPECT_NE(outcome.err.find("weld.script: not corrected: line 4: no joint values"),
              std::string::npos)
        << outcome.err;
    EXPECT_LT(number_behind(outcome.out, "position RMS/mm", 1),
              0.01 * number_behind(outcome.out, "position RMS/mm"));
    std::istringstream before(program);
    std::istringstream after(text_of("corrected.script"));
    std::string was;
    std::string is;
    for (int line = 1; std::getline(before, was); ++line) {
        ASSERT_TRUE(std::getline(after, is));
        EXPECT_EQ(was != is, line == 3 || line == 5) << is;
    }
    EXPECT_FALSE(std::getline(after, is));
    expect_input_error(correct_ + "weld.script --for fanuc -o c.ls", "has no /POS");
    write_text("far.script", "movej([0, 3, 0, 0, 0, 0])\n");
    expect_input_error(correct_ + "far.script --for ur -o c.script",
                       "far.script: configuration '1:8' is beyond the joint limits: q2 is ");
}

TEST_F(Correct, RoundsInwardsAtALimit) {
    // q2 ends at 60 deg, which is nearer to 1.047198 than to 1.047197 rad.
    write_text("limits.script",
               "movej([0.1, 1.047197, 0.3, 0.4, 0.5, 0.6])\n"
               "movej([0.1, -1.047197, 0.3, 0.4, 0.5, 0.6])\n");
    const std::string text = run_well(correct_ + "limits.script --for ur -o corrected.script");
    EXPECT_NE(text.find("q2 at its limit"), std::string::npos) << text;
    const std::string corrected = text_of("corrected.script");
    EXPECT_NE(corrected.find("1.047197, "), std::string::npos) << corrected;
    EXPECT_EQ(corrected.find("1.047198, "), std::string::npos) << corrected;
    run_well("correct " + fanuc_design + " e.json --poses corrected.script --for ur");
}

/// Stated by the pendant's name of the joint.
TEST_F(Correct, NamesTargetsBeyondALimitOfAControllersJoint) {
    const std::string design =
        read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml") +
        "\ncontroller: {joints: {J3: q3 - q2}}\n"
        "cell: {joint_sums: {J3: {limits_deg: [-20.00002, 40.00002]}}}\n";
    write_text("sum.yaml", design);
    const std::string begin =
        "/PROG  A\n/ATTR\n/MN\n   1:J P[1] 20% FINE ;\n/POS\nP[1]{\n   GP1:\n";
    const auto program = [&](double j3) {
        write_text("A.ls", begin + fmt::format("\tJ1= 5.000 deg, J2= 10.000 deg, J3= {:.3f} "
                                               "deg,\n\tJ4= 20.000 deg, J5= -40.000 "
                                               "deg, J6= 15.000 deg\n}};\n/END\n",
                                               j3));
        return run("correct sum.yaml e.json --poses A.ls --for fanuc -o c/A.ls");
    };
    std::filesystem::create_directory(folder_ / "c");
    const Outcome inside = program(10);
    EXPECT_EQ(inside.code, 0) << inside.err;
    EXPECT_EQ(inside.err, "");
    // What is beyond it already is named, and carried no further.
    const Outcome beyond = program(45);
    EXPECT_NE(beyond.err.find("1 of 1 configuration violates the campaign's cell: P[1] "
                              "(joint_sums: 1)\n"),
              std::string::npos)
        << beyond.err;
    const auto j3 = [&] {
        const std::string corrected = text_of("c/A.ls");
        return std::stod(corrected.substr(corrected.find("J3=") + 3));
    };
    EXPECT_EQ(j3(), 45);
    // What would be once it is corrected stays at the limit.
    const Outcome at_limit = program(40);
    EXPECT_EQ(at_limit.code, 0) << at_limit.err;
    EXPECT_EQ(j3(), 40);
    EXPECT_NE(at_limit.out.find("J3 at its limit"), std::string::npos) << at_limit.out;
    EXPECT_EQ(at_limit.err, "");
}

/// 60 deg are 1.0471976 rad: what was rounded beyond that is at the limit, more is refused.
TEST_F(Correct, TakesATargetThatItsDigitsRoundBeyondALimit) {
    const auto corrected = [&](const std::string& q2) {
        write_text("rounded.script", "movej([0.1, " + q2 + ", 0.3, 0.4, 0.5, 0.6])\n");
        run_well(correct_ + "rounded.script --for ur -o corrected.script");
        return text_of("corrected.script");
    };
    for (const char* const rounded : {"1.0472", "1.04720"}) {
        EXPECT_NE(corrected(rounded).find(", 1.047197, "), std::string::npos) << rounded;
    }
    for (const char* const beyond : {"1.0473", "1.047210", "1.05", "2"}) {
        write_text("beyond.script", fmt::format("movej([0.1, {}, 0.3, 0.4, 0.5, 0.6])\n", beyond));
        expect_input_error(correct_ + "beyond.script --for ur -o c.script",
                           "beyond.script: configuration '1:8' is beyond the joint limits: q2 is ");
    }
}

TEST_F(Correct, TakesPlacesOfATool) {
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n"
               "a,10,20,-30,40,50,60\n\"b,c\",-60,-20,0,-40,-70,0\n");
    const std::string tool = " --tool-mm 100,20,50";
    const std::string joints = run_well(correct_ + "p.csv -o joints.csv" + tool);
    // Where the nominal robot's flange is there, from the definition of the design.
    write_text("t.csv",
               "config,x_mm,y_mm,z_mm,qw,qx,qy,qz,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n" +
                   place_row("a", {10, 20, -30, 40, 50, 60}, {100, 20, 50}) +
                   place_row("\"b,c\"", {-60, -20, 0, -40, -70, 0}, {100, 20, 50}));
    const std::string text = run_well(correct_ + "t.csv --cartesian -o places.csv" + tool);
    EXPECT_NE(text.find("2 targets corrected: places.csv"), std::string::npos) << text;
    expect_same_numbers("joints.csv", "places.csv", 1e-4);
    EXPECT_LT(number_behind(text, "position RMS/mm", 1), 1e-3);
    // In the instrument's frame: another base than the stated one was found.
    const std::string world = run_well(correct_ + "t.csv --cartesian --base campaign" + tool);
    EXPECT_NE(number_behind(world, "position RMS/mm"), number_behind(text, "position RMS/mm"));
    EXPECT_NE(run_well(correct_ + "t.csv --cartesian --tool-target 1 --frame-mm 0,0,30"), text);
    expect_input_error(correct_ + "t.csv --cartesian --frame-mm 5000,0,0 -o c.csv",
                       "t.csv: target 'a' is not reached by the nominal robot within its joint "
                       "limits; are frame and tool right?");
    expect_input_error(correct_ + "p.csv --cartesian -o c.csv", "missing column x");
    expect_input_error(correct_ + "t.csv --cartesian --tool-target 9 -o c.csv",
                       "--tool-target is 9");
    write_text("bare.csv", "config,x_mm,y_mm,z_mm,rx_deg,ry_deg,rz_deg\na,1500,0,900,0,0,0\n");
    expect_input_error(correct_ + "bare.csv --cartesian -o c.csv",
                       "target 'a' has no joint values to begin at; --near must state joints near "
                       "those that are meant");
    run_well(correct_ + "bare.csv --cartesian --near 0,0,0,0,-5,0 -o c.csv");
    EXPECT_EQ(run(correct_ + "bare.csv --cartesian --near 0,0 -o c.csv").code, 2);
    EXPECT_EQ(run(correct_ + "p.csv --near 0,0,0,0,0,0").code, 2);
}

TEST_F(Correct, ReplacesThePlacesOfAProgram) {
    const std::string program =
        "def weld():\n  movej([0.1, 0.2, -0.3, 0.4, 0.5, 0.6], a=1.4)\n"
        "  movel(p[1.5, 0.2, 0.9, 0, 0.3, 0], a=1) # p[1, 2]\n  q = pose_trans(p[0, 0, 0, 0, 0, "
        "0], q)\nend\n";
    write_text("weld.script", program);
    const Outcome outcome = run(correct_ +
                                "weld.script --for ur --cartesian --near 7,-5,-22,-88,7,86 "
                                "--tool-mm 0,0,0 -o corrected.script");
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("2 targets corrected"), std::string::npos) << outcome.out;
    EXPECT_NE(outcome.err.find("weld.script: not corrected: line 4: "), std::string::npos);
    const std::string corrected = text_of("corrected.script");
    EXPECT_EQ(corrected.find("movel(p[1.5, "), std::string::npos) << corrected;
    EXPECT_NE(corrected.find("  q = pose_trans(p[0, 0, 0, 0, 0, 0], q)\n"), std::string::npos);
    EXPECT_NE(corrected.find("# p[1, 2]"), std::string::npos) << corrected;
}

/// The controller's places are of the tool that the program, or the pendant, selects.
TEST_F(Correct, IsToldTheToolOfPlaces) {
    const std::string options = " --for ur --cartesian --near 7,-5,-22,-88,7,86";
    const auto program = [&](const std::string& tool) {
        write_text("weld.script",
                   "def weld():\n" + tool + "  movel(p[1.5, 0.2, 0.9, 0, 0.3, 0], a=1)\nend\n");
        return correct_ + "weld.script" + options;
    };
    const std::string none = program("");
    expect_input_error(none + " -o c.script",
                       "weld.script: has places of a tool that is not stated; state --tool-mm "
                       "(0,0,0 if they are the flange's), or --tool-target");
    run_well(none + " --tool-mm 0,0,0 -o c.script");
    const std::string torch = program("  set_tcp(p[0, 0, 0.25, 0, 0, 0])\n");
    expect_input_error(torch + " -o d.script",
                       "; the program has the tool at 0, 0, 250 mm in line 2; state");
    expect_input_error(torch + " --tool-mm 0,0,100 -o d.script",
                       "has the tool at 0, 0, 250 mm in line 2, 250 mm from the flange, --tool-mm "
                       "states one at 0, 0, 100 mm, 100 mm from it; must be the same");
    expect_input_error(torch + " --tool-target 1 -o d.script", "--tool-target states one at ");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "d.script"));
    // The model's flange may have other axes.
    EXPECT_EQ(run(torch + " --tool-mm 250,0,0").err.find("must be the same"), std::string::npos);
    EXPECT_EQ(run(torch + " --tool-mm 0,0,100 --force").err.find("must be the same"),
              std::string::npos);
    // Joint values are of no tool.
    write_text("joints.script", "movej([0.1, 0.2, -0.3, 0.4, 0.5, 0.6], a=1.4)\n");
    run_well(correct_ + "joints.script" + options + " -o c.script");
}

TEST_F(Correct, RefusesWhatItCannotUse) {
    write_text("p.csv",
               "config,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\na,10,20,30,40,50,60\n"
               "b,10,120,30,40,50,60\n");
    expect_input_error(
        correct_ + "p.csv -o c.csv",
        "p.csv: configuration 'b' is beyond the joint limits: q2 is 120 deg, must be "
        "from -60 to 60 deg");
    expect_input_error(correct_ + "p.csv -o e.json", "is read and shall be written");
    expect_input_error(correct_ + "absent.csv", "absent.csv");
    expect_input_error("correct " + fanuc_design + " m.csv --poses m.csv", "m.csv");
    std::string design = read_text(source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml");
    design.replace(design.find("\nbase:"), 6, "\n# ");
    write_text("adrift.yaml", design);
    expect_input_error("correct adrift.yaml e.json --poses m.csv --base campaign",
                       "adrift.yaml: does not state a base; --base campaign needs it");
}

}  // namespace
}  // namespace posewise::testing
