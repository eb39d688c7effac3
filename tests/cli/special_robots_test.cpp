#include <nlohmann/json.hpp>

#include "program.hpp"

/// Robots and places where less can be told than usual: it is said, with what to do.
namespace posewise::testing {
namespace {

/// An arm whose last axis is the tool's z; the tool's frame is turned by rounded angles.
std::string arm_urdf(const std::string& rpy) {
    const auto joint = [](const std::string& name, const std::string& parent,
                          const std::string& child, const std::string& place) {
        return "<link name='" + child + "'/><joint name='" + name +
               "' type='revolute'><parent link='" + parent + "'/><child link='" + child + "'/>" +
               place + "<limit lower='-2' upper='2' effort='1' velocity='1'/></joint>\n";
    };
    return "<?xml version='1.0'?>\n<robot name='arm'><link name='base'/>\n" +
           joint("j1", "base", "l1", "<origin xyz='0 0 0.35'/><axis xyz='0 0 1'/>") +
           joint("j2", "l1", "l2", "<origin xyz='0.1 0 0'/><axis xyz='0 1 0'/>") +
           joint("j3", "l2", "l3", "<origin xyz='0 0 0.5'/><axis xyz='0 1 0'/>") +
           joint("j4", "l3", "l4", "<origin xyz='0.1 0 0.1'/><axis xyz='1 0 0'/>") +
           joint("j5", "l4", "l5", "<origin xyz='0.5 0 0'/><axis xyz='0 1 0'/>") +
           joint("j6", "l5", "l6", "<origin xyz='0.08 0 0'/><axis xyz='1 0 0'/>") +
           "<link name='tool'/><joint name='jt' type='fixed'><parent link='l6'/><child "
           "link='tool'/><origin rpy='" +
           rpy + "'/></joint>\n</robot>\n";
}

const std::string of_arm =
    "name: arm\nrobot: {urdf: arm.urdf, base_link: base, tip_link: tool, errors: geometric}\n";
const std::string one_target =
    "sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[0, 0, 150]]}}\n";

std::string of_elements(const std::string& joints, const std::string& elements,
                        const std::string& known) {
    return "name: few\nrobot:\n  joints: {" + joints + "}\n  elements: [" + elements +
           "]\nsensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[50, 0, 0], [0, 60, "
           "10], [-40, -40, 20]]" +
           known + "}}\n";
}

class SpecialRobot : public Program {};

TEST_F(SpecialRobot, HasTheRankOfExactAnglesHoweverItsFileRoundsThem) {
    write_text("c.yaml", of_arm + one_target);
    for (const char* const rpy :
         {"3.14159265358979 1.5707963267949 0", "3.1415926535 1.570796 0", "3.1416 1.5708 0"}) {
        write_text("arm.urdf", arm_urdf(rpy));
        const std::string text = run_well("inspect c.yaml");
        EXPECT_NE(text.find("complete model: 25 of its 39 parameters"), std::string::npos) << rpy;
        EXPECT_NE(text.find("target 1 lies on the axis of j6"), std::string::npos) << text;
        EXPECT_EQ(text.find("e+"), std::string::npos) << "no relation is of rounding alone" << text;
    }
    write_text("arm.urdf", arm_urdf("3.1415926535 1.570796 0"));
    EXPECT_NE(run_well("inspect c.yaml").find("2 angles of the robot within 1e-6 rad of"),
              std::string::npos);
    const auto json = nlohmann::json::parse(run_well("inspect c.yaml --json"));
    EXPECT_EQ(json.at("rounded_angle_count"), 2);
    EXPECT_EQ(json.at("on_axis").at(0).at("joint"), "j6");
    const Outcome planned =
        run("plan c.yaml --prior -k 10 --pool 60 --starts 1 --workspace-poses 20 -o p.json");
    EXPECT_EQ(planned.code, 0) << planned.err;
    EXPECT_NE(planned.err.find("target 1 lies on the axis of j6"), std::string::npos)
        << planned.err;
}

/// SCARA, gantry, a single axis: each is refused with a statement that is enough.
TEST_F(SpecialRobot, IsPlannedWithWhatItAsksFor) {
    const std::string plan =
        "plan c.yaml -k 8 --pool 100 --starts 1 --workspace-poses 20 -o p.json --csv p.csv";
    const std::string select = "select c.yaml --random 100 -k 8 --starts 1 -o s.json";
    struct Case {
        std::string joints, elements, asked, known, base;
    };
    const std::string turned = "base: {position_mm: [1500, 200, 300], rpy_deg: [0, 0, 30]";
    for (const Case& one :
         {Case{"q1: {limits_deg: [-130, 130]}, q2: {limits_deg: [-140, 140]}, q3: {limits_mm: [0, "
               "200]}",
               "Rz q1, Tx 320 mm, Rz q2, Tx 270 mm, Tz -q3",
               "known: [z], keys base.known or sensor.targets.known", ", known: [z]", ""},
          Case{"q1: {limits_mm: [0, 900]}, q2: {limits_mm: [0, 700]}, q3: {limits_mm: [0, 500]}",
               "Tx q1, Ty q2, Tz q3", "known: [x, y, z], keys base.known or sensor.targets.known",
               ", known: [x, y, z]", ""},
          Case{"q1: {limits_deg: [-170, 170]}", "Tz 300 mm, Rz q1, Tx 200 mm",
               "known: [z, rz], key base.known", "", turned + ", known: [z, rz]}\n"}}) {
        write_text("c.yaml", of_elements(one.joints, one.elements, ""));
        expect_input_error(plan, one.asked);
        expect_input_error(select, one.asked);
        EXPECT_NE(run_well("inspect c.yaml").find("Enough is "), std::string::npos);
        write_text("c.yaml", of_elements(one.joints, one.elements, one.known) + one.base);
        run_well(plan);
        run_well(select);
        if (one.base.empty()) {
            write_text("c.yaml", of_elements(one.joints, one.elements, one.known) + turned + "}\n");
        }
        run_well("simulate c.yaml --configurations p.csv -o m.csv");
        const Outcome calibrated = run("calibrate c.yaml -m m.csv --folds 0 -o e.json");
        EXPECT_EQ(calibrated.code, 0) << calibrated.err;  // of 8 poses, which may help little
    }
}

TEST_F(SpecialRobot, ThatTouchesFacesIsToldThatNoLengthIsStated) {
    write_text("arm.urdf", arm_urdf("0 0 0"));
    const std::string planes =
        "  - {normal: [1, 0, 0], offset_mm: 800OFFSET}\n  - {normal: [0, 1, 0], offset_mm: 150}\n"
        "  - {normal: [0, 0, 1], offset_mm: 400}\n";
    const auto campaign = [&](const std::string& known) {
        std::string text = planes;
        text.replace(text.find("OFFSET"), 6, known);
        return of_arm +
               "sensor:\n  kind: planes\n  sigma_mm: 0.02\n"
               "  targets: {position_mm: [[150, 20, -30]]}\n  planes:\n" +
               text + "base: {position_mm: [0, 0, 0], rpy_deg: [0, 0, 0], known: true}\n";
    };
    write_text("c.yaml", campaign(""));
    const auto rank = [&] {
        return nlohmann::json::parse(run_well("inspect c.yaml --json")).at("rank").get<int>();
    };
    const int open = rank();
    const double least = number_behind(run_well("inspect c.yaml"), "least number of poses:");
    EXPECT_GE(least, open);
    EXPECT_LE(least, open + 3);
    write_text("c.yaml", campaign(", known: [offset]"));
    EXPECT_EQ(rank(), open) << "an unknown less, a length more";
}

TEST_F(SpecialRobot, IsCalibratedByItsJointsZerosAloneWhereThatIsAsked) {
    write_text("arm.urdf", arm_urdf("0 0 0"));
    std::string text = of_arm;
    text.replace(text.find("geometric"), 9, "offsets");
    write_text("c.yaml",
               text + one_target + "base: {position_mm: [2000, 0, 0], rpy_deg: [0, 0, 90]}\n");
    run_well("simulate c.yaml --poses 20 -o m.csv");
    const std::string found = run_well("calibrate c.yaml -m m.csv --folds 0");
    for (const char* const name : {"d_j2", "d_j3", "d_j4", "d_j5"}) {
        EXPECT_NE(found.find(name), std::string::npos) << name;
    }
    EXPECT_EQ(found.find("d_j1"), std::string::npos) << "the base takes it";
    EXPECT_EQ(found.find("Tx_j2"), std::string::npos);
}

}  // namespace
}  // namespace posewise::testing
