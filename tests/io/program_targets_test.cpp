#include <gtest/gtest.h>

#include "io/format/atomic_file.hpp"
#include "posewise/io/robot_programs.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/task/correction.hpp"
#include "program_examples.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

// Joint targets of programs that exist: found, replaced, and nothing else touched.

namespace posewise::io {
namespace {

using namespace testing;

constexpr ProgramFormat target_formats[] = {ProgramFormat::Fanuc, ProgramFormat::Kuka,
                                            ProgramFormat::Abb, ProgramFormat::Ur};

/// What is not a target's value.
std::string without_targets(const TargetProgram& program) {
    std::string text;
    std::size_t done = 0;
    for (const JointTarget& target : program.targets) {
        for (const auto& [begin, end] : target.values) {
            text.append(program.content, done, begin - done);
            while (text.ends_with(' ')) text.pop_back();  // columns that are kept
            text += '#';
            done = end;
        }
    }
    return text.append(program.content, done);
}

std::vector<VectorXd> values_of(const TargetProgram& program) {
    std::vector<VectorXd> values;
    for (const JointTarget& target : program.targets) values.push_back(target.joints);
    return values;
}

std::vector<std::string> ids_of(const TargetProgram& program) {
    std::vector<std::string> ids;
    for (const JointTarget& target : program.targets) ids.push_back(target.id);
    return ids;
}

/// A program that someone wrote for a robot that counts joints as the model.
class Written {
  public:
    Written(ProgramFormat format, const std::string& text)
        : format_(format), path_(folder_.write(file_of(format), text)) {}
    TargetProgram read() const {
        return read_program_targets(path_, format_, campaign_.controller);
    }
    std::string replaced(const std::vector<VectorXd>& values) const {
        return replace_targets(read(), format_, campaign_.controller, values);
    }
    std::string error() const {
        return input_error_of([&] { read(); });
    }

  private:
    TemporaryFolder folder_;
    ProgramFormat format_;
    std::string path_;
    CampaignFile campaign_ = cell_with("{}");
};

VectorXd degrees(const std::vector<double>& values) {
    return Eigen::Map<const VectorXd>(values.data(), std::ssize(values)) * to_radians(1);
}

TEST(ProgramTargets, AreReplacedAndNothingElse) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    const ControllerJoints& joints = campaign.controller;
    for (const ProgramFormat format : target_formats) {
        const VectorXd steps = joint_steps(format, joints);
        const std::string path = folder.path(file_of(format));
        for (Index i = 0; i < std::max<Index>(sweep_count() / 20, 5); ++i) {
            RandomStream stream(5, static_cast<std::uint64_t>(i));
            RobotProgram program = cell_program(joints);
            for (ProgramStop& stop : program.stops) stop.joints = random_vector(stream, 6, 4);
            program.handshake = i % 2 == 0 ? Handshake::Pause : Handshake::Io;
            write_robot_program(path, format, program, "", campaign, {});
            const TargetProgram read = read_program_targets(path, format, joints);
            ASSERT_EQ(read.targets.size(), program.stops.size());
            EXPECT_TRUE(read.others.empty());
            std::vector<VectorXd> values = values_of(read);
            EXPECT_EQ(replace_targets(read, format, joints, values), read.content);
            for (VectorXd& value : values) value += random_vector(stream, 6, 0.02);
            write_program_targets(path, read, format, joints, values);
            const TargetProgram back = read_program_targets(path, format, joints);
            EXPECT_EQ(without_targets(back), without_targets(read));
            for (std::size_t k = 0; k < values.size(); ++k) {
                const VectorXd rounding = back.targets[k].joints - values[k];
                EXPECT_LE(rounding.cwiseQuotient(steps).cwiseAbs().maxCoeff(), 0.5 + 1e-6);
            }
        }
    }
}

TEST(ProgramTargets, OfFanucAreItsPositionsInJoints) {
    const Written program(
        ProgramFormat::Fanuc,
        "/PROG  WELD\n/ATTR\n/MN\n   1:  LBL[1] ;\n   2:J P[1] 100% FINE    ;\n"
        "   3:L P[2] 250mm/sec CNT50    ;\n   4:J P[3] 10% FINE INC    ;\n   5:J PR[4] 10% FINE ;\n"
        "   6:  JMP LBL[1] ;\n/POS\n"
        "P[1:\"J1= home\"]{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1=     0.000 deg,\tJ2=   -30.000 deg,"
        "\tJ3=    30.000 deg,\n\tJ4=     0.000 deg,\tJ5=     0.000 deg,\tJ6=     0.000 deg,\n"
        "\tE1=   500.000  mm\n   GP2:\n\tUF : 0, UT : 1,\n\tJ1=     7.000 deg\n};\n"
        "P[2]{\n   GP1:\n\tUF : 0, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX =  1807.000  mm,\tY "
        "= "
        "    0.000  mm,\tZ =   855.000  mm,\n\tW =   180.000 deg,\tP =     0.000 deg,\tR =     "
        "0.000 "
        "deg\n};\n"
        "P[3]{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1=     5.000 deg,\tJ2=     0.000 deg,\tJ3=     "
        "0.000 "
        "deg,\n\tJ4=     0.000 deg,\tJ5=     0.000 deg,\tJ6=     0.000 deg\n};\n/END\n");
    EXPECT_EQ(ids_of(program.read()), std::vector<std::string>{"P[1]"});
    EXPECT_EQ(program.read().others, (std::vector<long>{8, 21, 27}));
    EXPECT_LT((program.read().targets[0].joints - degrees({0, -30, 30, 0, 0, 0})).norm(), 1e-12);
    const std::string text = program.replaced({degrees({0.0123, -30.5, 130.25, 0, -0.0001, 0})});
    EXPECT_NE(
        text.find("\tJ1=     0.012 deg,\tJ2=   -30.500 deg,\tJ3=   130.250 deg,\n\tJ4=     "
                  "0.000 deg,\tJ5=     0.000 deg,\tJ6=     0.000 deg,\n\tE1=   500.000  mm\n"),
        std::string::npos)
        << text;
    EXPECT_NE(Written(ProgramFormat::Fanuc, "/MN\n/POS\nP[1]{\n GP1:\n J1= 1.0 deg\n};\n/END\n")
                  .error()
                  .find("states 1 joints; must state 6"),
              std::string::npos);
    EXPECT_NE(Written(ProgramFormat::Fanuc, "/MN\n/POS\nP[1]{\n GP1:\n").error().find("no /END"),
              std::string::npos);
}

TEST(ProgramTargets, OfKukaAreAggregatesOfAxes) {
    const Written program(
        ProgramFormat::Kuka,
        "DEF weld( )\r\n; PTP {A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\r\n"
        "PTP {A1 0.0,A2 -90,A3 90.12345,A4 0,A5 0,A6 0,E1 100.0} C_PTP\r\n"
        "DECL E6AXIS XHOME={A1 1.0,A2 -90.0,A3 90.0,A4 0.0,A5 10.0,A6 0.0,E1 0.0}\r\n"
        "LIN {X 1500.0,Y 0.0,Z 800.0,A 0.0,B 90.0,C 0.0}\r\nPTP {A1 5.0}\r\n"
        "PTP_REL {A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\r\n$BASE={X 0,Y 0,Z 0,A 0,B 0,C 0}\r\nEND\r\n");
    EXPECT_EQ(ids_of(program.read()), (std::vector<std::string>{"3:9", "4:23"}));
    EXPECT_EQ(program.read().others, (std::vector<long>{5, 6, 7}));
    const std::string text = program.replaced(
        {degrees({0.5, -90, 90.1, 0, 0, 0.000001}), degrees({1, -90, 90, 0, 10.12345678, 0})});
    EXPECT_NE(
        text.find("\r\nPTP {A1 0.50000,A2 -90,A3 90.10000,A4 0,A5 0,A6 0,E1 100.0} C_PTP\r\n"),
        std::string::npos)
        << text;
    EXPECT_NE(text.find("{A1 1.0,A2 -90.0,A3 90.0,A4 0.0,A5 10.12346,A6 0.0,E1 0.0}\r\n"),
              std::string::npos)
        << text;
}

TEST(ProgramTargets, OfAbbAreJointtargets) {
    const Written program(
        ProgramFormat::Abb,
        "MODULE weld\n  CONST jointtarget home:=[[0,-30,30.5,0,0,0],\n    "
        "[9E9,9E9,9E9,9E9,9E9,9E9]];"
        "\n  PERS robtarget p1:=[[1500,0,800],[0,0,1,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"
        "  PERS tooldata torch:=[TRUE,[[0,0,100],[1,0,0,0]],[5,[0,0,50],[1,0,0,0],0,0,0]];\n"
        "  PROC main()\n    ! MoveAbsJ [[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]]\n"
        "    IF di1=1 MoveAbsJ [[ 1.0, 2.0 ,3.0,4.0,5.0,6.0 ],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,z50,"
        "tool0;\n    TPWrite \"[[1,2,3,4,5,6],[\";\n    MoveJ Offs(p1,0,0,5),v100,fine,torch;\n"
        "  ENDPROC\nENDMODULE\n");
    EXPECT_EQ(ids_of(program.read()), (std::vector<std::string>{"2:29", "8:26"}));
    EXPECT_EQ(program.read().others, (std::vector<long>{4}));
    const std::string text = program.replaced(
        {degrees({0.5, -30, 30.5, 0, 0, 0}), degrees({1, 2, 3, 4.00004, 5, -6.25})});
    EXPECT_NE(text.find("home:=[[0.5000,-30,30.5,0,0,0],\n"), std::string::npos) << text;
    EXPECT_NE(text.find("[[ 1.0, 2.0 ,3.0,4.0,5.0,-6.2500 ],["), std::string::npos) << text;
}

TEST(ProgramTargets, OfUniversalRobotsAreWhatMovesTake) {
    const Written program(
        ProgramFormat::Ur,
        "def weld():\n  # movej([0, 1, 2, 3, 4, 5])\n  global home = [0, -1.57, 0.1, 0, 0, 0]\n"
        "  weights = [1, 2, 3, 4, 5, 6]\n  while True:\n    movej(home, a=1.4, v=1.05)\n"
        "    movel([0.1234567, -1.2, 0.3, 0, 0, 0], a=0.5, v=0.25, r=0.01)\n"
        "    movel(p[0.5, 0, 0.8, 0, 3.14, 0])\n    movej([d2r(10), 0, 0, 0, 0, 0])\n  end\nend\n");
    EXPECT_EQ(ids_of(program.read()), (std::vector<std::string>{"3:18", "7:12"}));
    EXPECT_EQ(program.read().others, (std::vector<long>{8, 9}));
    VectorXd first(6);
    first << 0, -1.5712345, 0.1, 0, 0, 0;
    VectorXd second(6);
    second << 0.12345678, -1.2, 0.3, 0, 0, 0;
    const std::string text = program.replaced({first, second});
    EXPECT_NE(text.find("home = [0, -1.571235, 0.1, 0, 0, 0]"), std::string::npos) << text;
    EXPECT_NE(text.find("movel([0.1234568, -1.2, 0.3, 0, 0, 0], a"), std::string::npos) << text;
}

/// Joint values that a program takes from elsewhere: corrected where they stand, or named.
TEST(ProgramTargets, ThatOthersAreMadeOfAreNamed) {
    const Written aliases(ProgramFormat::Ur,
                          "def weld():\n  global q1 = [0, 1, 0.1, 0, 0, 0]\n  q2 = q1\n  q3 = q2\n"
                          "  movej(q3)\n  q4 = [1, 1, 1, 0, 0, 0]\n  q4[2] = 0.5\n  movej(q4)\n"
                          "  q5 = get_inverse_kin(place)\n  if q5 == q4:\n    movej(q5)\n  end\n"
                          "  q6 = [2, 2, 2, 2, 2, 2]\nend\n");
    EXPECT_EQ(ids_of(aliases.read()), (std::vector<std::string>{"2:16", "6:9"}));
    EXPECT_EQ(aliases.read().others, (std::vector<long>{7, 9}));
    const std::string external = "[9E9,9E9,9E9,9E9,9E9,9E9]";
    const Written records(
        ProgramFormat::Abb,
        "MODULE weld\n  VAR jointtarget a:=[[1,2,3,4,5,6]," + external +
            "];\n  CONST robjoint r:=[1,2,3,4,5,6];\n  PROC main()\n    a.robax:=r;\n"
            "    IF n=1 a.robax.rax_1:=10;\n    a:=CalcJointT(p,tool0);\n"
            "    IF a.robax.rax_1>5 MoveAbsJ a,v100,fine,tool0;\n    a.extax:=e;\n"
            "    n:=a.robax.rax_2;\n  ENDPROC\nENDMODULE\n");
    EXPECT_EQ(ids_of(records.read()), (std::vector<std::string>{"2:24"}));
    EXPECT_EQ(records.read().others, (std::vector<long>{3, 5, 6, 7}));
    const Written components(ProgramFormat::Kuka,
                             "DEF weld()\nDECL E6AXIS XP={A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\n"
                             "XP.A1 = 10\nXP.A2=XP.A2-5\nIF XP.A1 == 10 THEN\nPTP XP\nENDIF\n"
                             "$BASE.X = 5\nW=XP.A3\nEND\n");
    EXPECT_EQ(ids_of(components.read()), (std::vector<std::string>{"2:20"}));
    EXPECT_EQ(components.read().others, (std::vector<long>{3, 4}));
}

TEST(ProgramTargets, AreRefusedWhereTheyCannotBeUsed) {
    EXPECT_NE(Written(ProgramFormat::Ur, "def a():\nend\n").error().find("no target in joint"),
              std::string::npos);
    EXPECT_NE(Written(ProgramFormat::Kuka, "PTP {A1 1e9,A2 1,A3 1,A4 1,A5 1,A6 1}\nEND\n")
                  .error()
                  .find("poses.src:1:9: has 1e+09 for joint 1, which no robot reaches"),
              std::string::npos);
    EXPECT_NE(Written(ProgramFormat::Staubli, "").error().find("must be fanuc, kuka, abb or ur"),
              std::string::npos);
}

/// Where nothing is left to correct, the first target that stays is named, with the reason.
TEST(ProgramTargets, ThatAllStaySayWhy) {
    const auto expect = [](ProgramFormat format, const std::string& text,
                           const std::string& words) {
        const std::string error = Written(format, text).error();
        EXPECT_NE(error.find(words), std::string::npos) << text << error;
    };
    const auto fanuc = [](const std::string& moves, const std::string& joints) {
        return "/PROG A\n/MN\n   1:" + moves + " ;\n/POS\nP[1]{\n   GP1:\n\tUF : 0, UT : 1,\n" +
               joints + "\n};\n/END\n";
    };
    const std::string axes =
        "\tJ1= 0.0 deg, J2= 0.0 deg, J3= 0.0 deg,\n\tJ4= 0.0 deg, J5= 0.0 deg, J6= 0.0 deg";
    const std::string first =
        "has no target in joint values that can be corrected; must have one: "
        "the first of 1 that stay ";
    expect(ProgramFormat::Fanuc, fanuc("J P[1] 10% FINE INC", axes),
           "CELL.LS:5: " + first + "is of a move with INC");
    expect(ProgramFormat::Fanuc, fanuc("J P[1] 10% FINE Tool_Offset,PR[1]", axes),
           "is of a move with an offset");
    // Both positions of a circular move, whose end stands in the next line.
    expect(ProgramFormat::Fanuc, fanuc("C P[1]\n    :  P[1] 9mm/sec FINE Offset,PR[2]", axes),
           "is of a move with an offset");
    expect(ProgramFormat::Kuka, "DEF a()\nXP={X 1,Y 2,Z 3,A 0,B 0,C 0}\nPTP {X 1,Y 2}\nEND\n",
           "poses.src:3: " + first + "is a place of the tool, which --cartesian takes");
    expect(ProgramFormat::Kuka, "DEF a()\nPTP_REL {A1 1,A2 2,A3 3,A4 4,A5 5,A6 6}\nEND\n",
           "is relative to the position before");
    expect(ProgramFormat::Kuka, "DEF a()\nPTP {A1 1,A2 2}\nEND\n",
           "states no number for each joint");
    expect(ProgramFormat::Ur, "movel(p[0, 0, 1, 0, 0, 0])\n", "which --cartesian takes");
}

TEST(ProgramTargets, OfAnArrayAreCorrectedEach) {
    const std::string rest = ",[9E9,9E9,9E9,9E9,9E9,9E9]]";
    const auto read = [&](const std::string& blank, const std::string& second) {
        return Written(ProgramFormat::Abb, "MODULE m\nVAR jointtarget j{2}:=[" + blank +
                                               "[[1,2,3,4,5,6]" + rest + "," + blank + second +
                                               rest + "];\nENDMODULE\n")
            .read();
    };
    for (const std::string blank : {"", "\n"}) {
        const TargetProgram good = read(blank, "[[7,8,9,1,2,3]");
        EXPECT_EQ(good.targets.size(), 2U);
        EXPECT_TRUE(good.others.empty());
        const TargetProgram spoilt = read(blank, "[[7,x,9,1,2,3]");
        EXPECT_EQ(spoilt.targets.size(), 1U);
        EXPECT_EQ(spoilt.others, std::vector<long>{blank.empty() ? 2 : 4});
    }
}

TEST(ProgramTargets, OfFilesThatWereCutOffAreRefused) {
    const std::string axes = "A1 1,A2 2,A3 3,A4 4,A5 5,A6 6";
    const auto is_cut = [](ProgramFormat format, const std::string& text) {
        return Written(format, text).error().find("must be the whole program") != std::string::npos;
    };
    EXPECT_TRUE(is_cut(ProgramFormat::Kuka, "DEF a()\nPTP {" + axes + "}\n"));
    EXPECT_TRUE(
        is_cut(ProgramFormat::Abb,
               "MODULE m\nCONST jointtarget a:=[[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]];\n"));
    EXPECT_TRUE(
        is_cut(ProgramFormat::Ur, "def a():\n  while True:\n  movej([1,2,3,0,0,0])\nend\n"));
    EXPECT_FALSE(is_cut(ProgramFormat::Ur, "movej([1,2,3,0,0,0])\n"));
}

TEST(ProgramTargets, ThatAreNoNumbersAreNamed) {
    const std::string good = "A1 1,A2 2,A3 3,A4 4,A5 5,A6 6";
    const TargetProgram kuka =
        Written(ProgramFormat::Kuka, "DEF a()\nPTP {" + good + "}\nPTP {A1 nan,A2 2}\nEND\n")
            .read();
    EXPECT_EQ(kuka.targets.size(), 1U);
    EXPECT_EQ(kuka.others, std::vector<long>{3});
    const std::string end = ",[9E9,9E9,9E9,9E9,9E9,9E9]];\n";
    const TargetProgram abb =
        Written(ProgramFormat::Abb, "MODULE m\nCONST jointtarget a:=[[1,2,3,4,5,6]" + end +
                                        "CONST jointtarget b:=[[1,2,3,4,5]" + end +
                                        "PERS tooldata t:=[TRUE,[[0,0,1],[1,0,0,0]],[1,[0,0,1],"
                                        "[1,0,0,0],0,0,0]];\nENDMODULE\n")
            .read();
    EXPECT_EQ(abb.targets.size(), 1U);
    EXPECT_EQ(abb.others, std::vector<long>{3});
}

/// Numbers of a target without what makes them one, in moves and declarations; and what has as many
/// numbers, but is none.
TEST(ProgramTargets, WhoseBracketsAreLostAreNamed) {
    const auto others = [](ProgramFormat format, const std::string& text) {
        return Written(format, text).read().others;
    };
    const std::string axes = "A1 1,A2 2,A3 3,A4 4,A5 5,A6 6";
    EXPECT_EQ(others(ProgramFormat::Kuka, "DEF a()\nPTP {" + axes + "}\nDECL E6AXIS X1=" + axes +
                                              "}\nptp " + axes + "\nSPTP {A1 1,A2 2}\n" +
                                              "WEIGH(1,2,3,4,5,6)\nPTP X1 C_PTP\nEND\n"),
              (std::vector<long>{3, 4, 5}));
    const std::string external = "[9E9,9E9,9E9,9E9,9E9,9E9]";
    const std::string move = "MoveAbsJ [[1,2,3,4,5,6]," + external + "],v1,fine,t;";
    EXPECT_EQ(
        others(ProgramFormat::Abb,
               "MODULE m\nCONST jointtarget a:=[1,2,3,4,5,6]," + external + "];\n" + move +
                   " MoveAbsJ [1,2,3,4,5,6]," + external + ",v1,fine,t;\nCONST jointtarget b:=\n[" +
                   "1,2,3,4,5,6];\nweigh 1,2,3,4,5,6;\nMoveJ RelTool(p1,0,0,5\\Rz:=25),v1,z1,t;" +
                   "\nENDMODULE\n"),
        (std::vector<long>{2, 3, 5}));
    EXPECT_EQ(others(ProgramFormat::Ur,
                     "a = [0, 1, 2, 0, 0, 0]\nb = 0, 1, 2, 0, 0, 0\nc = [0, 1, 2, 0, 0, 0]\n"
                     "movej(a, 1.4, 1.05, 0, 0)\nmovej(b)\nif x: movej(0, 1, 2, 0, 0, 0)\nend\n"
                     "servoj(c, 0, 0, 0.002, 0.1)\nservoj(a)\nspeedj([0, 1, 2, 0, 0, 0], 1, 1)\n"),
              (std::vector<long>{2, 3, 6}));
}

/// What program --read refuses as spoilt, in programs whose moves it would not take either.
TEST(ProgramTargets, OfSpoiltStatementsAreRefused) {
    const auto expect = [](ProgramFormat format, const std::string& text,
                           const std::string& words) {
        const std::string error = Written(format, text).error();
        EXPECT_NE(error.find(words), std::string::npos) << text << error;
    };
    const std::string slip = "as a move has, but is none that is known";
    const std::string ur = "movej([1, 2, 0, 0, 0, 0])\n";
    expect(ProgramFormat::Ur, ur + "mvej([0, 1, 2, 0, 0, 0], a=1)\n", "cell.script:2:1: has '(['");
    expect(ProgramFormat::Ur, ur + "Movel(p[0, 1, 2, 0, 0, 0])\n", "must be movel");
    expect(ProgramFormat::Ur, ur + "movel([0, 1, 2, 0, 0, 0], a=1\n", "has no ) at its end");
    expect(ProgramFormat::Ur, ur + "movej([0, 1, 2, 0, 0, 0, a=1)\n", "has no ] at its end");
    expect(ProgramFormat::Ur, ur + "movel(p[0, 1, 2, 0, 0, 0], v=-1)\n",
           "has 'v=-1'; must not be below 0");
    EXPECT_EQ(Written(ProgramFormat::Ur,
                      ur + "set_gravity([0, 0, 9.82])\n"
                           "movec(p[0, 0, 1, 0, 0, 0], p[0, -1, 1, 0, 0, -1], a=1) # mvej([\n"
                           "q = f([0, 1, 2, 0, 0, 0])\nmovej(g(q, -1), a=1)\n")
                  .error(),
              "no error");
    const std::string axes = "{A1 1,A2 2,A3 3,A4 4,A5 5,A6 6";
    const std::string kuka = "PTP " + axes + "}\nEND\n";
    expect(ProgramFormat::Kuka, "PPT " + axes + "}\n" + kuka, slip);
    expect(ProgramFormat::Kuka, "PTP " + axes + "\n" + kuka, "poses.src:1:1: has no } at its end");
    expect(ProgramFormat::Kuka, "LIN {X 1,Y 2\n" + kuka, "has no } at its end");
    EXPECT_EQ(Written(ProgramFormat::Kuka, "SPTP " + axes + "} C_PTP ; {A1\n" + kuka).error(),
              "no error");
    const std::string target = "[[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9]]";
    const auto abb = [&](const std::string& text) {
        return "MODULE m\nCONST jointtarget a:=" + target + ";\n" + text + "\nENDMODULE\n";
    };
    expect(ProgramFormat::Abb, abb("MovAbsJ " + target + ",v100,z1,tool0;"), slip);
    expect(ProgramFormat::Abb, abb("MoveAbsJ " + target + ",v100,z1,tool0"), "has no ; at its end");
    expect(ProgramFormat::Abb, abb("MoveAbsJ [[1,2,3,4,5,6],[9E9,9E9,9E9,9E9,9E9,9E9],v1,fine,t;"),
           "has no ] at its end");
    EXPECT_EQ(Written(ProgramFormat::Abb,
                      abb("MoveAbsJ " + target + ",\nv100,z1,tool0;\nIF a=1 MoveAbsJ " + target +
                          ",v100,z1,tool0;\nMoveL [[1,2,3],[1,0,0,0],[0,0,0,0],[9E9]],v1,z1,t;\n"
                          "PDispSet [[1,2,3],[1,0,0,0]];"))
                  .error(),
              "no error");
    const auto fanuc = [](const std::string& move) {
        return "/PROG A\n/MN\n   1:  !see P[7] ;\n   2:" + move +
               " ;\n/POS\nP[1]{\n   GP1:\n\tUF : 0, UT : 1,\n\tJ1= 0.000 deg,\tJ2= 0.000 deg,\tJ3= "
               "0.000 deg,\n\tJ4= 0.000 deg,\tJ5= 0.000 deg,\tJ6= 0.000 deg\n};\n/END\n";
    };
    expect(ProgramFormat::Fanuc, fanuc("K P[1] 10% FINE"), "CELL.LS:4:6: has ' P['");
    expect(ProgramFormat::Fanuc, fanuc("L P[x] 10% FINE"), "names no position");
    expect(ProgramFormat::Fanuc, fanuc("C P[1]\n    :  P[2] 9mm/sec FINE"), "moves to P[2], which");
    expect(ProgramFormat::Fanuc, fanuc("L P[1:a] -9mm/sec FINE"),
           "has '-9mm/sec'; must be above 0");
    EXPECT_EQ(Written(ProgramFormat::Fanuc, fanuc("C P[1]\n    :  P[1] 9mm/sec FINE")).error(),
              "no error");
}

TEST(ProgramTargets, AreFoundOrRefusedInSpoiltFiles) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    const ControllerJoints& joints = campaign.controller;
    const std::string alphabet = "{}[](),;:=\"'!#./-0123456789 \n\rPJA";
    for (const ProgramFormat format : all_formats) {
        if (format == ProgramFormat::Staubli) continue;
        const std::string path = folder.path(file_of(format));
        write_robot_program(path, format, cell_program(joints), "", campaign, {});
        const std::string text = detail::read_file(path);
        for (Index i = 0; i < std::max<Index>(sweep_count() / 10, 50); ++i) {
            RandomStream stream(6, static_cast<std::uint64_t>(i));
            std::string spoilt = text;
            for (Index k = stream.index(4) + 1; k > 0; --k) {
                const auto at = static_cast<std::size_t>(stream.index(std::ssize(spoilt)));
                const char letter =
                    alphabet[static_cast<std::size_t>(stream.index(std::ssize(alphabet)))];
                if (stream.index(2) == 0) spoilt.erase(at, 1 + at % 40);
                if (at < spoilt.size()) spoilt[at] = letter;
            }
            detail::write_file(path, spoilt);
            try {
                program_content(path, read_robot_program(path, format, joints), campaign,
                                joint_steps(format, joints), std::nullopt);
            } catch (const InputError& error) {
                EXPECT_TRUE(std::string_view(error.what()).starts_with(path)) << error.what();
            }
            try {
                const TargetProgram program = read_program_targets(path, format, joints);
                const std::string same =
                    replace_targets(program, format, joints, values_of(program));
                EXPECT_EQ(same.size(), spoilt.size()) << spoilt;
            } catch (const InputError&) {
            }
        }
    }
}

/// The robot with errors, gravity's among them, is where the nominal one is, at the joints of the
/// corrected program, to what the correction claims and the digits of the file.
TEST(ProgramTargets, BringTheRobotWithErrorsHome) {
    const TemporaryFolder folder;
    for (const ProgramFormat format : target_formats) {
        const CampaignFile campaign = cell_with(controller_of(format));
        const ControllerJoints& joints = campaign.controller;
        const std::string path = folder.path(file_of(format));
        write_robot_program(path, format, cell_program(joints), "", campaign, {});
        const TargetProgram program = read_program_targets(path, format, joints);
        RandomStream stream(11);
        Parameters found = campaign.nominal;
        const VectorXd scale = parameter_scale(campaign);
        const Index first = scale.size() - found.sensor.size() - found.robot.size();
        for (Index k = 0; k < found.robot.size(); ++k) {
            found.robot[k] = stream.uniform(-1, 1) * scale[first + k];
        }
        RowMatrixXd nominal(std::ssize(program.targets), 6);
        for (Index k = 0; k < nominal.rows(); ++k) {
            nominal.row(k) =
                joints.to_model(program.targets[static_cast<std::size_t>(k)].joints).transpose();
        }
        const CorrectedPoses corrected = correct_poses(campaign, found, nominal, ids_of(program));
        std::vector<VectorXd> values;
        for (const Correction& one : corrected.corrections) {
            values.push_back(joints.to_controller(one.joints));
        }
        write_program_targets(path, program, format, joints, values);
        const TargetProgram back = read_program_targets(path, format, joints);
        const VectorXd none = VectorXd::Zero(campaign.robot.parameter_count());
        constexpr double reach = 3.5;  // m
        const double rounding = reach / 2 * joint_steps(format, joints).sum();
        for (Index k = 0; k < nominal.rows(); ++k) {
            const Correction& one = corrected.corrections[static_cast<std::size_t>(k)];
            const Vector3d wanted =
                campaign.robot.base_from_flange(nominal.row(k).transpose(), none).translation();
            const VectorXd q = joints.to_model(back.targets[static_cast<std::size_t>(k)].joints);
            const Vector3d reached = campaign.robot.base_from_flange(q, found.robot).translation();
            EXPECT_NEAR((reached - wanted).norm(), one.residual.position, rounding);
            EXPECT_GT(one.uncorrected.position, 5 * rounding) << program_format_name(format);
        }
    }
}

}  // namespace
}  // namespace posewise::io
