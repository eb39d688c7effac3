#include <fmt/format.h>
#include <gtest/gtest.h>

#include "io/format/atomic_file.hpp"
#include "io/program/program_text.hpp"
#include "posewise/io/robot_programs.hpp"
#include "program_examples.hpp"
#include "support/temporary_folder.hpp"

// Programs that people edited: what is read, what is said of it, what is refused.

namespace posewise::io {
namespace {

using namespace testing;

/// Writes the example, changes it, reads it.
class Edited {
  public:
    explicit Edited(ProgramFormat format)
        : format_(format),
          campaign_(cell_with(reversed_joints)),
          path_(folder_.path(file_of(format))) {
        write_robot_program(path_, format_, cell_program(campaign_.controller), "", campaign_, {});
    }
    Edited& replace(const std::string& what, const std::string& by, const std::string& file = "") {
        const std::string path = file.empty() ? path_ : path_ + file;
        std::string text = detail::read_file(path);
        const std::size_t at = text.find(what);
        EXPECT_NE(at, std::string::npos) << what << " in\n" << text;
        if (at != std::string::npos) text.replace(at, what.size(), by);
        detail::write_file(path, text);
        return *this;
    }
    std::vector<std::string> labels() const {
        std::vector<std::string> labels;
        for (const ProgramStop& stop : read_robot_program(path_, format_, campaign_.controller)) {
            labels.push_back(stop.label);
        }
        return labels;
    }
    std::string error() const {
        return input_error_of([&] { labels(); });
    }
    const CampaignFile& campaign() const { return campaign_; }
    const std::string& path() const { return path_; }

  private:
    TemporaryFolder folder_;
    ProgramFormat format_;
    CampaignFile campaign_;
    std::string path_;
};

void expect_refused(const Edited& edited, const std::string& words) {
    EXPECT_NE(edited.error().find(words), std::string::npos) << edited.error();
}

TEST(EditedPrograms, AreReadAsTheyCameFromThePendant) {
    // A pendant names positions, a comment is added, a move dropped.
    EXPECT_EQ(Edited(ProgramFormat::Fanuc)
                  .replace("J P[2] 20% FINE", "J P[2:over table] 5% FINE ACC50")
                  .replace("P[2]{", "P[2:\"over table\"]{")
                  .replace("  !p2 ;", "  !p2 ;\n  99:  !look at the hoses ;")
                  .replace("J P[5] 20% FINE", "//J P[5] 20% FINE")
                  .labels(),
              (std::vector<std::string>{"home", "p1", "via", "p2", "home"}));
    EXPECT_EQ(Edited(ProgramFormat::Kuka)
                  .replace("; p1\nPTP {A1", ";FOLD PTP p1\n; p1\nPTP {E6AXIS: A1")
                  .labels()
                  .size(),
              6U);
    EXPECT_EQ(Edited(ProgramFormat::Kuka).replace(",A6 ", ", A6 ").labels().size(), 6U);
}

TEST(EditedPrograms, AreRefusedWhereTheyDoNotStop) {
    expect_refused(Edited(ProgramFormat::Kuka).replace("\nEND\n", "\n"),
                   "has no END; must be the whole");
    expect_refused(Edited(ProgramFormat::Abb).replace("ENDMODULE", ""), "has no ENDMODULE");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("\nEND", "\n"), "has no END");
    expect_refused(
        Edited(ProgramFormat::Fanuc).replace("J P[2] 20% FINE", "J P[2] 20% FINE Offset,PR[1]"),
        "must have none but ACC");
    expect_refused(Edited(ProgramFormat::Fanuc).replace("J P[2] 20% FINE", "J P[2] 20% CNT50"),
                   "CELL.LS:12:6: does not stop");
    expect_refused(Edited(ProgramFormat::Fanuc).replace("J P[2]", "L P[2]"), "is no joint move");
    expect_refused(Edited(ProgramFormat::Fanuc).replace("J P[2]", "J P[22]"),
                   "moves to P[22], which is not under /POS");
    expect_refused(Edited(ProgramFormat::Fanuc).replace("/POS", "/NOPOS"), "has no /POS");
    expect_refused(Edited(ProgramFormat::Fanuc).replace("J1= ", "J1= x"), "is not a number");
    expect_refused(Edited(ProgramFormat::Kuka).replace("}\nWAIT", "} C_PTP\nWAIT"),
                   "does not stop");
    expect_refused(Edited(ProgramFormat::Kuka).replace("PTP {A1", "LIN {A1"), "is no joint move");
    expect_refused(Edited(ProgramFormat::Kuka).replace("PTP {A1", "PTP {A2"), "where A1 must be");
    expect_refused(Edited(ProgramFormat::Abb).replace("fine", "z10"), "does not stop");
    expect_refused(Edited(ProgramFormat::Abb).replace("MoveAbsJ", "MoveJ"), "is no move to joints");
    expect_refused(Edited(ProgramFormat::Ur).replace("r=0)", "r=0.05)"), "does not stop");
    expect_refused(Edited(ProgramFormat::Ur).replace("movej([", "movej(p["),
                   "is no joint move to numbers");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("PL=0", "PL=3"), "does not stop");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("POSTYPE PULSE", "POSTYPE ROBOT"),
                   "PULSE");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("MOVJ C00001", "MOVJ C00099"),
                   "does not state");
    expect_refused(Edited(ProgramFormat::Staubli).replace("joints[1]", "joints[9]", "/start.pgx"),
                   "data have none of");
    expect_refused(Edited(ProgramFormat::Staubli).replace("j6=\"", "j7=\"", "/cell.dtx"),
                   "5 joints");
    expect_refused(Edited(ProgramFormat::Ros2).replace("J1", "J9"), "no joint of the controller");
    expect_refused(Edited(ProgramFormat::Ros2).replace("positions: [", "positions: [.nan, "),
                   "positions");
    expect_refused(Edited(ProgramFormat::Csv).replace("J1_deg", "J9_deg"), "'J1_deg' is missing");
    expect_refused(Edited(ProgramFormat::Csv).replace("home,", "home,nan"), "not a number");
}

TEST(EditedPrograms, AreRefusedWhereTheyAreSpoilt) {
    expect_refused(Edited(ProgramFormat::Ur).replace("r=0)", "r=0"), "has no ) at its end");
    expect_refused(Edited(ProgramFormat::Ur).replace("r=0)", "r=0, t=-5)"),
                   "has 't=-5'; must not be below");
    expect_refused(Edited(ProgramFormat::Abb).replace("tool0;", "tool0"), "has no ; at its end");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("NPOS ", "NPOS 1"),
                   "lines were lost or added");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("VJ=20.00", "VJ=0.00"),
                   "must be above 0");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("VJ=20.00", "VJ=120.00"),
                   "has 'VJ=120.00'; must be above 0 and at most 100 per cent");
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("T=2.00", "T=-2.00"),
                   "must not be below 0");
    expect_refused(Edited(ProgramFormat::Staubli).replace("vel=\"20\"", "vel=\"0\"", "/cell.dtx"),
                   "has 'vel=\"0\"'; must be above 0");
    expect_refused(Edited(ProgramFormat::Staubli).replace("delay(2.0)", "delay(-2)", "/start.pgx"),
                   "must not be below 0");
    expect_refused(Edited(ProgramFormat::Ros2).replace("dwell_s: 2.0", "dwell_s: -2"),
                   "is below 0");
    expect_refused(Edited(ProgramFormat::Ros2).replace("{sec: ", "{sec: -"), "is below 0");
    expect_refused(Edited(ProgramFormat::Csv).replace(",2.0\n", ",-2.0\n"), "must not be below 0");
    expect_refused(Edited(ProgramFormat::Ros2).replace("named_states:", "states:"), "named_states");
    const Edited cut(ProgramFormat::Ros2);
    const std::string whole = detail::read_file(cut.path());
    detail::write_file(cut.path(), whole.substr(0, whole.find("named_states:")));
    expect_refused(cut, "has no named_states at its end");
    // A slip in the word of a move.
    const std::string slip = "as a move has, but is none that is known";
    expect_refused(Edited(ProgramFormat::Fanuc).replace("J P[2]", "K P[2]"), slip);
    expect_refused(Edited(ProgramFormat::Kuka).replace("PTP {A1", "PPT {A1"), slip);
    expect_refused(Edited(ProgramFormat::Abb).replace("MoveAbsJ", "MovAbsJ"), slip);
    expect_refused(Edited(ProgramFormat::Ur).replace("movej([", "mvej(["), slip);
    expect_refused(Edited(ProgramFormat::Yaskawa).replace("MOVJ", "MOJV"), slip);
    expect_refused(
        Edited(ProgramFormat::Staubli).replace("movej(joints", "mvej(joints", "/start.pgx"), slip);
}

/// Where the joint values of one move are spoilt, no command passes it over: a correction refuses
/// the program or names the line, and reading refuses it.
TEST(EditedPrograms, HaveNoSpoiltTargetThatIsPassedOver) {
    using enum ProgramFormat;
    const std::string opens = "that nothing opens; must be opened";
    const std::string numbers = "is no joint move to numbers";
    struct Case {
        ProgramFormat format;
        std::string what, by;
        std::string words;  ///< of program --read
        long line = 0;  ///< that the correction names; 0: it refuses in these words, -1: in others
    };
    for (const auto& [format, what, by, words, line] : std::vector<Case>{
             {Abb, "MoveAbsJ [[", "MoveAbsJ [", numbers, -1},
             {Abb, "MoveAbsJ [[", "MoveAbsJ ([", numbers, -1},
             {Abb, "tool0;", "tool0);", opens},
             {Ur, "movej([", "movej[", opens},
             {Ur, "movej([", "movej(", opens},
             {Ur, "movej([0.000000, -2.094395, 2.094395, 0.000000, 0.000000, 0.000000]",
              "movej(0, -2, 2, 0, 0, 0", numbers, 4},
             {Ur, "movej([", "servoj([", "is no joint move", 4},
             {Kuka, "PTP {A1", "PTP A1", opens},
             {Kuka, "PTP {A1", "PTP {A-", "where A1 must be", 10},
             {Kuka, "PTP {A1", "PTP {A+5", "where A1 must be", 10},
             {Kuka, "PTP {A1 ", "PTP {A.5", "where A1 must be", 10},
             {Kuka, "PTP {A1", "PTP {A1 x,A1", "is not a number", 10},
             {Fanuc, "J P[2]", "J P[99]", "moves to P[99], which is not under /POS"},
             {Fanuc, "P[2]{", "P[3]{", "states a position twice"},
             {Fanuc, "20%", "-20%", "has '-20%'; must be above 0 and at most 100 per cent"},
             {Fanuc, "20%", "400%", "has '400%'; must be above 0 and at most 100 per cent"},
             {Fanuc, "20%", "0%", "must be above 0 and at most 100 per cent"},
             {Fanuc, "20%", "-2sec", "has '-2sec'; must be above 0"},
             {Fanuc, "WAIT   2.00(sec)", "WAIT  -3.00(sec)",
              "has '-3.00(sec)'; must not be below 0"},
             {Kuka, "#VEL_PTP,20", "#VEL_PTP,900", "must be above 0 and at most 100 per cent"},
             {Kuka, "#VEL_PTP,20", "#VEL_PTP,-20", "must be above 0 and at most 100 per cent"},
             {Kuka, "WAIT SEC 2.0", "WAIT SEC -1", "has 'WAIT SEC -1'; must not be below 0"},
             {Ur, "v=0.4189", "v=0", "has 'v=0'; must be above 0"},
             {Ur, "a=0.5, v=0.4189", "0, 0.4189", "has '0'; must be above 0"},
             {Ur, "sleep(2.0)", "sleep(-1)", "has 'sleep(-1)'; must not be below 0"},
             {Abb, "slow:=[200,", "slow:=[0,", "must be above 0"},
             {Abb, "slow:=[200,100", "slow:=[200,-1", "must be above 0"},
             {Abb, "\\InPos,2.0", "\\InPos,-2.0", "must not be below 0"},
             {Fanuc, "J6=", "J5=", "has J5 where J6 must be", -1},
             {Fanuc, "J2=", "J1=", "has J1 where J2 must be", -1}}) {
        Edited edited(format);
        expect_refused(edited.replace(what, by), words);
        std::vector<long> others;
        const std::string error = input_error_of([&] {
            others =
                read_program_targets(edited.path(), format, edited.campaign().controller).others;
        });
        EXPECT_EQ(others, line > 0 ? std::vector<long>{line} : std::vector<long>{}) << by;
        EXPECT_EQ(error == "no error", line > 0) << by << ' ' << error;
        EXPECT_TRUE(line != 0 || error.find(words) != std::string::npos) << by << ' ' << error;
    }
}

/// The example's poses as a plan, v1 to verify.
Plan plan_of_example(const CampaignFile& campaign) {
    const ControllerJoints& joints = campaign.controller;
    Plan plan;
    for (const ProgramStop& stop : cell_program(joints).stops) {
        if (!stop.is_measured) continue;
        PlannedPose& pose = plan.poses.emplace_back();
        pose.id = stop.label;
        pose.configuration = joints.to_model(stop.joints);
    }
    plan.verification.push_back(plan.poses.back());
    plan.poses.pop_back();
    return plan;
}

ProgramContent content_of(const Edited& edited, ProgramFormat format) {
    const CampaignFile& campaign = edited.campaign();
    return program_content(edited.path(),
                           read_robot_program(edited.path(), format, campaign.controller), campaign,
                           joint_steps(format, campaign.controller), plan_of_example(campaign));
}

TEST(EditedPrograms, NameWhatIsMissingMovedAndNew) {
    Edited edited(ProgramFormat::Csv);
    const auto content = [&] { return content_of(edited, ProgramFormat::Csv); };
    const ProgramContent same = content();
    EXPECT_TRUE(same.dropped.empty() && same.moved.empty() && same.added.empty());
    EXPECT_EQ(same.purposes, (std::vector<std::string>{"calibrate", "via", "calibrate", "verify"}));
    edited.replace("\np1,", "\nnew,").replace("\nv1,", "\nv1,1");
    const ProgramContent other = content();
    EXPECT_TRUE(other.dropped.empty());
    EXPECT_TRUE(other.added.empty());
    EXPECT_EQ(other.again, (std::vector{std::pair<std::string, std::string>("new", "p1")}));
    ASSERT_EQ(other.moved.size(), 1U);
    EXPECT_EQ(other.moved[0].id, "v1");
    EXPECT_EQ(other.moved[0].joint, 0);
    edited.replace("\nnew,-7", "\nnew,-6");
    EXPECT_EQ(content().added, std::vector<std::string>{"new"});
    edited.replace("\nv1,", "\np2,");
    EXPECT_NE(input_error_of(content).find("visits 'p2' at other joints than before"),
              std::string::npos);
}

TEST(EditedPrograms, AreRefusedWhereMovesMayBePassedOver) {
    using enum ProgramFormat;
    const std::string jumps = ": jumps, so that moves may be passed over or repeated";
    expect_refused(Edited(Fanuc).replace("  !p1 ;", "  JMP LBL[1] ;"), "CELL.LS:11:8" + jumps);
    expect_refused(Edited(Fanuc).replace("  !p1 ;", "  IF DI[1]=ON,JMP LBL[1] ;"), jumps);
    expect_refused(Edited(Fanuc).replace("WAIT   2.00(sec)", "WAIT DI[1]=ON TIMEOUT,LBL[1]"),
                   jumps);
    expect_refused(
        Edited(Fanuc).replace("  !p1 ;", "  FOR R[1]=1 TO 5 ;").replace("  !via ;", "  ENDFOR ;"),
        "CELL.LS:12:6: moves within 'FOR' of line 11, which may pass it over or repeat it");
    expect_refused(
        Edited(Fanuc).replace("  !p1 ;", "  IF (DI[1]) THEN ;").replace("  !via ;", "  ENDIF ;"),
        "moves within 'IF'");
    expect_refused(Edited(Fanuc).replace("  !p1 ;", "  END ;"),
                   "moves after line 11, 'END', which leaves");
    expect_refused(Edited(Kuka).replace("; p1", "GOTO there"), "poses.src:11:1" + jumps);
    expect_refused(Edited(Kuka).replace("; p1", "IF $IN[1] THEN").replace("; via", "ENDIF"),
                   "within 'IF'");
    expect_refused(Edited(Kuka).replace("; p1", "LOOP").replace("; via", "ENDLOOP"),
                   "within 'LOOP'");
    expect_refused(Edited(Kuka).replace("; p1", "END\nDEF other( )"), "in another routine");
    expect_refused(Edited(Abb).replace("! p1", "GOTO there;"), "cell.mod:7:5" + jumps);
    expect_refused(Edited(Abb).replace("! p1", "IF di1=1 THEN").replace("! via", "ENDIF"),
                   "within 'IF'");
    expect_refused(Edited(Abb).replace("! p1", "FOR i FROM 1 TO 3 DO").replace("! via", "ENDFOR"),
                   "'FOR'");
    expect_refused(Edited(Abb).replace("! p1\r\n    Move", "IF di1=1 Move"),
                   "moves under a condition");
    expect_refused(Edited(Abb).replace("! p1", "RETURN;"), "which leaves the routine");
    expect_refused(Edited(Ur).replace("# p1", "if get_digital_in(1):").replace("# via", "end"),
                   "'if'");
    expect_refused(Edited(Ur).replace("# p1", "while True:").replace("# via", "end"),
                   "within 'while'");
    expect_refused(Edited(Ur).replace("\nend\n", "\n"), "cell.script:1:1: does not end");
    expect_refused(Edited(Ur).replace("  movej", "  MOVEJ"), "tells capitals apart; must be movej");
    expect_refused(Edited(Yaskawa).replace("'p1", "JUMP *AGAIN"), jumps);
    expect_refused(Edited(Yaskawa).replace("'p1", "IFTHEN IN#(1)=ON").replace("'via", "ENDIF"),
                   "'IFTHEN'");
    expect_refused(Edited(Staubli)
                       .replace("// p1", "if dIn", "/start.pgx")
                       .replace("// via", "endIf", "/start.pgx"),
                   "within 'if'");
    // What encloses no move is read, as the handshake's loops are.
    for (const auto& [format, what, by] :
         {std::tuple{Fanuc, "  !p2 ;", "  IF R[1]=1,CALL LAMP ;\n  99:  !p2 ;\n  99:  LBL[3] ;"},
          std::tuple{Kuka, "; p2", "IF $IN[1] THEN\nLAMP( )\nENDIF ; GOTO\n; p2"},
          std::tuple{Abb, "! p2", "IF di1=1 THEN\nLAMP;\nENDIF\n! p2"},
          std::tuple{Ur, "# p2", "while not get_digital_in(0): # loop\nsync()\nend\n# p2"}}) {
        EXPECT_EQ(Edited(format).replace(what, by).labels(), Edited(format).labels());
    }
}

TEST(EditedPrograms, MoveNoAxisThatThePlanDoesNotKnow) {
    using enum ProgramFormat;
    expect_refused(
        Edited(Kuka).replace("}\n; p1", ",E1 120.5}\n; p1"),
        "poses.src:10:1: has 'E1 120.5', an axis that is not of the robot's joints; must be 0");
    EXPECT_EQ(Edited(Kuka).replace("}\n; p1", ",E1 0.0,E2 0}\n; p1").labels().size(), 6U);
    expect_refused(Edited(Abb).replace("[9E9,", "[35.5,"), "moves an external axis to 35.5");
    EXPECT_EQ(Edited(Abb).replace("[9E9,9E9,", "[9E+09,0,").labels().size(), 6U);
    const std::string last = "J6=     0.000 deg\n";
    expect_refused(Edited(Fanuc).replace(last, "J6=     0.000 deg,\n\tE1=    12.500 mm\n"),
                   "has E1 at 12.500, an axis");
    EXPECT_EQ(
        Edited(Fanuc).replace(last, "J6=     0.000 deg,\n\tE1=     0.000 mm\n").labels().size(),
        6U);
    expect_refused(
        Edited(Fanuc).replace(last, last + "   GP2:\n\tUF : 0, UT : 1,\n\tJ1= 5.0 deg\n"),
        "has J1 at 5.0");
    expect_refused(Edited(Yaskawa).replace("C00001 VJ", "C00001 EC00001 VJ"),
                   "must have none but VJ");
}

/// Moves that are none to joints, and what leads moves elsewhere, wherever it stands. What calls do
/// is not looked at.
TEST(EditedPrograms, AreRefusedWhereTheRobotIsMovedOtherwise) {
    using enum ProgramFormat;
    const std::string other = "moves the robot otherwise or leads moves elsewhere";
    const std::string unknown = "is not known and may move the robot";
    const std::string no_joints = "is no joint move";
    struct Case {
        ProgramFormat format;
        std::string statement, words;  ///< empty: it is read
    };
    for (const auto& [format, statement, words] : std::vector<Case>{
             {Abb, "TriggL p9,v100,trig1,fine,tool0;",
              "cell.mod:7:5: has 'TriggL', which " + other},
             {Abb, "TriggJ p9,v100,trig1,fine,tool0;", other},
             {Abb, "TriggC p8,p9,v100,trig1,fine,tool0;", other},
             {Abb, "ArcL p9,v100,seam1,weld1,fine,tool0;", other},
             {Abb, "arcCStart p8,p9,v100,seam1,weld1,fine,tool0;", other},
             {Abb, "SearchL di1,sp,p9,v100,tool0;", other},
             {Abb, "IF di1=1 SearchC di1,sp,p8,p9,v100,tool0;", other},
             {Abb, "EOffsSet eax;", other},
             {Abb, "SoftAct 1,50;", other},
             {Abb, "%\"MoveL\"% p9,v100,fine,tool0;", "whose name is calculated"},
             {Abb, "weldTo p9,v100,gun;", "has a speed or a zone as moves have"},
             {Abb, "gripTo p9, fast, Fine, gun;", "has a speed or a zone as moves have"},
             {Abb, "VelSet 50,800;", ""},
             {Abb, "PDispSet shift;", ""},  // which absolute joint moves do not follow
             {Abb, "EOffsOff;", ""},
             {Abb, "v100:=[100,500,5000,1000];", ""},
             {Abb, "TPWrite \"MoveL p9,v100,fine\";", ""},
             {Abb, "TriggIO trig1,10\\DOp:=do1,1;", ""},
             {Abb, "LAMP 1,2;", ""},
             {Kuka, "SCIRC XP1,XP2", no_joints},
             {Kuka, "ASYPTP {E1 10}", no_joints},
             {Kuka, "MOVE XP3", "poses.src:11:1: has 'MOVE', which " + unknown},
             {Kuka, "IF $IN[1] THEN PTP XP3 ENDIF", other},
             {Kuka, "GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM( )", ""},
             {Kuka, "$VEL_AXIS[1]=50", ""},
             {Kuka, "BAS (#VEL_PTP,10)", ""},
             {Kuka, "LAMP(1,2)", ""},
             {Ur, "optimovej(place)", other},
             {Ur, "x = servoc(place)", other},
             {Ur, "force_mode(p[0,0,0,0,0,0], a, b, 2, c)", other},
             {Ur, "path_offset_enable()", other},
             {Ur, "end_force_mode()", ""},
             {Ur, "set_tcp(p[0, 0, 0.1, 0, 0, 0])", ""},
             {Ur, "textmsg(\"servoj(\")", ""},
             {Ur, "lamp(1, 2)", ""},
             {Yaskawa, "SFTON P001", "CELL.JBI:22:1: has 'SFTON', which " + unknown},
             {Yaskawa, "WVON WEV#(1)", unknown},
             {Yaskawa, "SET B000 1", ""},
             {Yaskawa, "*AGAIN", ""},
             {Yaskawa, "CALL JOB:LAMP", ""},
             {Fanuc, "  99:  SOFTFLOAT[1] ;", other},
             {Fanuc, "  99:  P[2]=JPOS ;", "changes a position as the program runs"},
             {Fanuc, "  99:S PR[2] 10mm/sec FINE ;", no_joints},
             {Fanuc, "  99:  OFFSET CONDITION PR[1] ;", ""},  // of moves with Offset
             {Fanuc, "  99:  PR[1]=JPOS ;", ""}}) {
        const std::string mark = format == Fanuc     ? "   6:  !p1 ;"
                                 : format == Kuka    ? "; p1"
                                 : format == Abb     ? "! p1"
                                 : format == Yaskawa ? "'p1"
                                                     : "# p1";
        Edited edited(format);
        const std::string before = detail::read_file(edited.path());
        const std::size_t at = before.find(mark);
        ASSERT_NE(at, std::string::npos) << before;
        edited.replace(mark, statement + "\n" + mark);
        if (words.empty()) {
            EXPECT_EQ(edited.error(), "no error") << statement;
        } else {
            EXPECT_NE(edited.error().find(words), std::string::npos)
                << statement << ": " << edited.error();
        }
    }
    expect_refused(Edited(Yaskawa).replace("'p1", "IFTHENEXP IN#(1)=ON").replace("'via", "ENDIF"),
                   "within 'IFTHENEXP'");
    expect_refused(Edited(Yaskawa).replace("'p1", "WHILEEXP IN#(1)=ON").replace("'via", "ENDWHILE"),
                   "within 'WHILEEXP'");
    expect_refused(Edited(Yaskawa).replace("GROUP1 RB1", "GROUP1 RB2"),
                   "moves another group than the robot; must be ///GROUP1 RB1");
    expect_refused(Edited(Yaskawa).replace("GROUP1 RB1", "GROUP1 RB1\r\n///GROUP2 ST1"),
                   "moves another group than the robot");
    expect_refused(Edited(Yaskawa).replace("\r\nC00001", ",5\r\nC00001"),
                   "moves to a position of 7 axes; must be of 6");
    EXPECT_EQ(Edited(Yaskawa).replace("\r\nC00001", ",0\r\nC00001").error(), "no error");
    expect_refused(Edited(Fanuc).replace("1,*,*,*,*", "*,1,*,*,*"),
                   "moves another group than the first");
}

TEST(EditedPrograms, HaveOneMoveInALine) {
    using enum ProgramFormat;
    expect_refused(Edited(Kuka).replace("}\n; p1", "} PTP {A1 0}\n; p1"),
                   "has 'PTP {A1 0}' behind its target; must stand in a line of its own");
    EXPECT_EQ(Edited(Kuka).replace("}\n; p1", "} ; PTP {A1 0}\n; p1").error(), "no error");
    for (const std::string second : {" movej([0])", "; movej([0])", " sleep(1)"}) {
        expect_refused(Edited(Ur).replace("r=0)", "r=0)" + second),
                       "behind its move; must stand in a line of its own");
    }
    EXPECT_EQ(Edited(Ur).replace("r=0)", "r=0) # movej([0])").error(), "no error");
    // A move in two lines.
    expect_refused(Edited(Abb).replace("],[9E9", "],\n[9E9"),
                   "cell.mod:6:5: goes on in the next line; must stand in one");
    expect_refused(Edited(Ur).replace(", a=", ",\n  a="), "has no ) at its end; must have one, in");
}

TEST(EditedPrograms, OfUniversalRobotsAreCalledOnce) {
    using enum ProgramFormat;
    expect_refused(Edited(Ur).replace("end\ncell()", "end"),
                   "cell.script:1:1: defines 'cell', which is never called");
    expect_refused(Edited(Ur).replace("end\ncell()", "end\ncell()\ncell()"), "calls 'cell' again");
    EXPECT_EQ(Edited(Ur)
                  .replace("end\ncell()", "end\ndef lamp():\n  sync()\nend\nlamp()\ncell()\nlamp()")
                  .error(),
              "no error");
    expect_refused(Edited(Ur).replace("v=0.4189", "v=60"), "has 'v=60', over 12.6 rad/s");
}

/// What a controller takes in either case.
TEST(EditedPrograms, AreReadInSmallLetters) {
    using enum ProgramFormat;
    for (const ProgramFormat format : {Fanuc, Kuka, Abb, Yaskawa}) {
        const Edited edited(format);
        const auto wanted = edited.labels();
        detail::write_file(edited.path(), detail::lower_case(detail::read_file(edited.path())));
        EXPECT_EQ(edited.error(), "no error") << program_format_name(format);
        EXPECT_EQ(edited.labels(), wanted);
        if (format == Yaskawa) continue;
        EXPECT_EQ(read_program_targets(edited.path(), format, edited.campaign().controller)
                      .targets.size(),
                  wanted.size());
    }
    expect_refused(Edited(Kuka).replace("PTP {A1", "ppt {a1"), "is none that is known");
}

TEST(EditedPrograms, AreReadStatementByStatement) {
    using enum ProgramFormat;
    Edited abb(Abb);
    abb.replace(";\r\n    ! p1\r\n", ";").replace("! via\r\n", "WaitTime 1; ! via\r\n");
    EXPECT_EQ(abb.labels(), (std::vector<std::string>{"home", "p1", "via", "p2", "v1", "home"}));
    const auto refuses = [](const std::string& arguments) {
        return Edited(Ur)
                   .replace("a=0.5, v=0.4189, r=0", arguments)
                   .error()
                   .find("does not stop") != std::string::npos;
    };
    EXPECT_TRUE(refuses("a=0.5, v=0.4, r = 0.05"));
    EXPECT_TRUE(refuses("0.5, 0.4, 0, 0.05"));
    EXPECT_FALSE(refuses("0.5, 0.4"));
    EXPECT_FALSE(refuses("0.5, 0.4, 0, 0"));
    EXPECT_NE(Edited(Staubli)
                  .replace("blend=\"off\"", "blend=\"joint\"", "/cell.dtx")
                  .error()
                  .find("must have blend=\"off\""),
              std::string::npos);
}

TEST(EditedPrograms, AreRefusedWhereTheyWereCutOff) {
    using enum ProgramFormat;
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    for (const ProgramFormat format : {Fanuc, Kuka, Abb, Ur, Yaskawa, Staubli}) {
        const std::string path = folder.path(file_of(format));
        const RobotProgram program = cell_program(campaign.controller);
        write_robot_program(path, format, program, "", campaign, {});
        for (const std::string& file : program_files(path, format, program)) {
            if (file.ends_with(".dat")) continue;  // which is not read
            const std::string text = detail::read_file(file);
            // Of the last lines at least one word is missing.
            for (const double part : {0.2, 0.5, 0.9, 1.0}) {
                const auto size = static_cast<std::size_t>(part * static_cast<double>(text.size()));
                detail::write_file(file, text.substr(0, std::min(size, text.size() - 12)));
                EXPECT_THROW(read_robot_program(path, format, campaign.controller), InputError)
                    << file << ' ' << part;
            }
            detail::write_file(file, text);
        }
    }
}

TEST(EditedPrograms, KeepPosesWhoseNameWasLost) {
    using enum ProgramFormat;
    for (const auto& [format, comment] :
         {std::pair{Fanuc, "  !p2 ;"}, std::pair{Kuka, "; p2\n"}, std::pair{Abb, "! p2\r\n"},
          std::pair{Ur, "# p2\n"}, std::pair{Yaskawa, "'p2\r\n"}}) {
        Edited edited(format);
        edited.replace(comment, format == Fanuc ? "  UTOOL_NUM=1 ;" : "");
        const ProgramContent content = content_of(edited, format);
        EXPECT_TRUE(content.dropped.empty()) << program_format_name(format);
        EXPECT_EQ(content.ids, (std::vector<std::string>{"p1", "p2.via", "p2", "v1"}));
        // ABB and UR show the name, too.
        const bool is_shown = format == Abb || format == Ur;
        EXPECT_EQ(content.recognised,
                  is_shown ? std::vector<std::string>{} : std::vector<std::string>{"p2"})
            << program_format_name(format);
    }
    // Waits elsewhere: not a via.
    Edited moved(Kuka);
    moved.replace("; p2\nPTP {A1 -32", "PTP {A1 -31");
    const ProgramContent content = content_of(moved, Kuka);
    EXPECT_EQ(content.dropped, std::vector<std::string>{"p2"});
    EXPECT_EQ(content.unnamed, std::vector<std::string>{"stop4"});
    EXPECT_EQ(content.purposes,
              (std::vector<std::string>{"calibrate", "via", "calibrate", "verify"}));
}

TEST(EditedPrograms, SayWhatIsVisitedTwice) {
    Edited edited(ProgramFormat::Csv);
    const std::string text = detail::read_file(edited.path());
    const std::string row =
        text.substr(text.find("\np1,"), text.find("\nvia,") - text.find("\np1,"));
    edited.replace("\nvia,", row + "\nvia,");
    const ProgramContent content = content_of(edited, ProgramFormat::Csv);
    EXPECT_EQ(content.visits, 1);
    ASSERT_EQ(content.other_visits.size(), 1U);
    EXPECT_EQ(content.other_visits[0], (std::pair<std::string, Index>{"p1", 2}));
    EXPECT_TRUE(content_of(Edited(ProgramFormat::Csv), ProgramFormat::Csv).other_visits.empty());
}

TEST(EditedPrograms, AreHeldToLimitsSumsAndTheCell) {
    const auto faults = [](const std::string& pose) {
        const TemporaryFolder folder;
        CampaignFile campaign = cell_with("{}");
        VectorXd coefficients = VectorXd::Zero(6);
        coefficients << 0, -1, 1, 0, 0, 0;
        campaign.cell.joint_sums = {{"q3 - q2", coefficients, {to_radians(-80), to_radians(90)}}};
        campaign.cell.sight.reset();
        const std::string path = folder.path("a.csv");
        detail::write_file(path, "name,q1_deg,q2_deg,q3_deg,q4_deg,q5_deg,q6_deg\n" + pose + '\n');
        const auto format = ProgramFormat::Csv;
        const ProgramContent content =
            program_content(path, read_robot_program(path, format, campaign.controller), campaign,
                            joint_steps(format, campaign.controller), std::nullopt);
        return content.faults.empty() ? std::string() : content.faults[0];
    };
    EXPECT_EQ(faults("p1,0,-30,0,0,0,0"), "");
    EXPECT_NE(faults("p1,0,-30,0,0,0,9999").find("pose 'p1' is beyond the joint limits"),
              std::string::npos);
    EXPECT_NE(faults("p1,0,-30,0,0,0,9999").find("q6 is 9999 deg, must be from"),
              std::string::npos);
    EXPECT_NE(faults("p1,0,-47,57,0,0,0").find("joint_sums: q3 - q2 is 104 deg, must be from -7"),
              std::string::npos)
        << faults("p1,0,-47,57,0,0,0");
    EXPECT_NE(faults("via,0,58,-20,0,0,0").find("a via does not meet"), std::string::npos)
        << faults("via,0,58,-20,0,0,0");
}

}  // namespace
}  // namespace posewise::io
