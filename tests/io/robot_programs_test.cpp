#include "posewise/io/robot_programs.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <set>

#include "io/format/atomic_file.hpp"
#include "support/places.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

// Programs for each controller: what stands in them, and what comes back.

namespace posewise::io {
namespace {

using namespace testing;

constexpr double degree = std::numbers::pi / 180;
constexpr ProgramFormat all_formats[] = {
    ProgramFormat::Fanuc,   ProgramFormat::Kuka,    ProgramFormat::Abb,  ProgramFormat::Ur,
    ProgramFormat::Yaskawa, ProgramFormat::Staubli, ProgramFormat::Ros2, ProgramFormat::Csv};

std::string file_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return "CELL.LS";
        case ProgramFormat::Kuka:
            return "cell.src";
        case ProgramFormat::Abb:
            return "cell.mod";
        case ProgramFormat::Ur:
            return "cell.script";
        case ProgramFormat::Yaskawa:
            return "CELL.JBI";
        case ProgramFormat::Staubli:
            return "cell";
        case ProgramFormat::Ros2:
            return "cell.yaml";
        case ProgramFormat::Csv:
            break;
    }
    return "cell.csv";
}

bool has_handshake(ProgramFormat format) {
    return format != ProgramFormat::Ros2 && format != ProgramFormat::Csv;
}

/// The FANUC cell's campaign with a controller.
CampaignFile cell_with(const std::string& controller) {
    const std::string path = source_folder() + "/designs/cell_demo/campaign.yaml";
    return parse_campaign(detail::read_file(path) + "\ncontroller: " + controller + '\n', path);
}

const std::string example_pulses =
    "pulses_per_deg: [1341.38, 1907.67, 1592.89, 1022.86, 980.24, 454.75]";
const std::string reversed_joints =
    "{joints: [-q1, q2 - 90 deg, q3 - q2 + 90 deg, -q4, q5, -q6], " + example_pulses + "}";

std::string controller_of(ProgramFormat format) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return "{maker: fanuc, j23_factor: 1}";
        case ProgramFormat::Kuka:
            return "{joints: [-q1, q2 - 90 deg, 90 deg - q3, q4, -q5, q6]}";
        case ProgramFormat::Yaskawa:
            return "{" + example_pulses + "}";
        case ProgramFormat::Ros2:
            return "{joints: {joint_1: q1, joint_2: q2, joint_3: q3, joint_4: q4, joint_5: q5, "
                   "joint_6: q6}}";
        default:
            return "{}";
    }
}

ProgramStop stop_at(const ControllerJoints& joints, const std::string& label,
                    const std::vector<double>& q_deg, Index samples = 1) {
    const VectorXd q = Eigen::Map<const VectorXd>(q_deg.data(), std::ssize(q_deg)) * degree;
    return {label, joints.to_controller(q), label != "home" && label != "via", samples};
}

/// Home, three poses and a via, home.
RobotProgram cell_program(const ControllerJoints& joints) {
    RobotProgram program;
    program.title = "posewise, FANUC R-2000iC/165F in a cell";
    program.date = "2026/01/31 12:00";
    program.joints = joints;
    program.stops = {
        stop_at(joints, "home", {0, -30, 0, 0, 0, 0}),
        stop_at(joints, "p1",
                {78.7863738, 16.9178212, -61.6481882, 101.9217523, -63.5325953, 28.3155305}),
        stop_at(joints, "via", {50, 0, -20, 95, -70, 60}),
        stop_at(joints, "p2",
                {32.7248523, -31.2371082, -17.7869347, 91.8262611, -81.6135222, 92.633084}, 2),
        stop_at(joints, "v1",
                {-10.9420508, 55.8516709, 42.5794502, 85.3322467, -40.4908827, 148.2132266}),
        stop_at(joints, "home", {0, -30, 0, 0, 0, 0})};
    program.dwell = 2;
    program.joint_speed = VectorXd::Constant(joints.count(), 2);
    return program;
}

TEST(RobotPrograms, AreWhatStandsInTheGoldenFiles) {
    // Reviewed line by line; POSEWISE_WRITE_GOLDEN writes them anew.
    const bool is_written = std::getenv("POSEWISE_WRITE_GOLDEN") != nullptr;
    const std::string golden = source_folder() + "/tests/golden/programs/";
    const TemporaryFolder folder;
    for (const ProgramFormat format : all_formats) {
        const CampaignFile campaign = cell_with(controller_of(format));
        RobotProgram program = cell_program(campaign.controller);
        if (has_handshake(format)) program.handshake = Handshake::Pause;
        const std::string path = (is_written ? golden : folder.path("")) + file_of(format);
        write_robot_program(path, format, program, "", campaign, {});
        for (const std::string& file : program_files(path, format, program)) {
            const std::string name = file.substr(path.size() - file_of(format).size());
            EXPECT_EQ(detail::read_file(file), detail::read_file(golden + name)) << name;
        }
    }
}

TEST(RobotPrograms, ComeBackToHalfOfTheLastDigit) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    const Index programs =
        std::max<Index>(sweep_count() / 10, 10);  // 1000 a format in all with 10 stops
    for (const ProgramFormat format : all_formats) {
        const VectorXd steps = joint_steps(format, campaign.controller);
        for (Index i = 0; i < programs; ++i) {
            RandomStream stream(3, static_cast<std::uint64_t>(i));
            RobotProgram program = cell_program(campaign.controller);
            program.stops.clear();
            for (int k = 1; k <= 10; ++k) {
                const bool is_via = stream.uniform(0, 1) < 0.2;
                program.stops.push_back({is_via ? "via" : fmt::format("p{}", k),
                                         random_vector(stream, 6, 4), !is_via, 1});
            }
            if (has_handshake(format) && i % 2 == 0) program.handshake = Handshake::Pause;
            if (format != ProgramFormat::Staubli && has_handshake(format) && i % 3 == 0) {
                program.handshake = Handshake::Io;
            }
            const std::string path = folder.path(file_of(format));
            write_robot_program(path, format, program, "", campaign, {});
            const auto stops = read_robot_program(path, format, campaign.controller);
            ASSERT_EQ(stops.size(), program.stops.size());
            for (std::size_t k = 0; k < stops.size(); ++k) {
                EXPECT_EQ(stops[k].label, program.stops[k].label);
                EXPECT_EQ(stops[k].is_measured, program.stops[k].is_measured);
                const VectorXd difference = stops[k].joints - program.stops[k].joints;
                EXPECT_LE(difference.cwiseQuotient(steps).cwiseAbs().maxCoeff(), 0.5 + 1e-6)
                    << program_format_name(format);
            }
        }
    }
}

TEST(RobotPrograms, MoveTheFlangeWhereThePlanHasIt) {
    // Couplings, reversed axes and other zeros of several families: what is read back is the
    // model's, to the rounding.
    const TemporaryFolder folder;
    const std::pair<ProgramFormat, std::string> families[] = {
        {ProgramFormat::Fanuc, "{maker: fanuc, j23_factor: -1}"},
        {ProgramFormat::Fanuc, "{maker: fanuc, j23_factor: 0}"},
        {ProgramFormat::Fanuc, "{maker: fanuc, j23_factor: 1}"},
        {ProgramFormat::Kuka, "{joints: [-q1, q2 - 90 deg, 90 deg - q3, -q4, q5, -q6]}"},
        {ProgramFormat::Abb, "{joints: {J3: q2 - q3}}"},
        {ProgramFormat::Ur, "{joints: {J2: q2 - 90 deg, J3: -q3, J4: q4 + q3}}"},
        {ProgramFormat::Yaskawa, reversed_joints},
        {ProgramFormat::Staubli, "{joints: {J5: -q5, J6: q6 - 0.5*q5}}"},
        {ProgramFormat::Ros2, "{joints: {J3: -q3}}"},
    };
    for (const auto& [format, controller] : families) {
        const CampaignFile campaign = cell_with(controller);
        const RobotProgram program = cell_program(campaign.controller);
        const std::string path = folder.path(file_of(format));
        write_robot_program(path, format, program, "", campaign, {});
        const VectorXd steps = joint_steps(format, campaign.controller);
        const ProgramContent content =
            program_content(path, read_robot_program(path, format, campaign.controller),
                            campaign.controller, steps, std::nullopt);
        ASSERT_EQ(content.ids, (std::vector<std::string>{"p1", "p2.via", "p2", "v1"}));
        VectorXd p1(6);
        p1 << 78.7863738, 16.9178212, -61.6481882, 101.9217523, -63.5325953, 28.3155305;
        const auto flange = [&](const VectorXd& q) {
            return campaign.robot.base_from_flange(
                q, VectorXd::Zero(campaign.robot.parameter_count()));
        };
        const Isometry3d planned = flange(p1 * degree);
        const Isometry3d back = flange(content.joints.row(0).transpose());
        constexpr double reach = 3;  // m
        EXPECT_LT((planned.translation() - back.translation()).norm(), 2 * reach * steps.sum())
            << controller;
    }
}

TEST(RobotPrograms, StateTheFanucsThirdJointAgainstTheGround) {
    const TemporaryFolder folder;
    for (const int factor : {-1, 0, 1}) {
        const CampaignFile campaign =
            cell_with(fmt::format("{{maker: fanuc, j23_factor: {}}}", factor));
        write_robot_program(folder.path("A.ls"), ProgramFormat::Fanuc,
                            cell_program(campaign.controller), "", campaign, {});
        const std::string text = detail::read_file(folder.path("A.ls"));
        // q2 = -30, q3 = 0 at home.
        EXPECT_NE(text.find(fmt::format("\tJ3= {:>9.3f} deg", 30.0 * factor)), std::string::npos)
            << text;
    }
}

// ---- Names ----

std::string hostile_name(RandomStream& stream) {
    static const std::vector<std::string> parts{
        "p",   "1",     "_",  " ",    ".",  "-", "\"",   "'",   "\n",
        "\t",  ";",     "]]", "<!--", "&",  "ä", "\xff", "END", "home",
        "via", "movej", "/",  "\\",   "{}", "0", "A",    "aa",  "verylongnameofapose",
        "%s",  "$(x)",  "#",  "P1",   "p1"};
    std::string name;
    const auto count = static_cast<int>(stream.uniform(0, 6));
    for (int k = 0; k < count; ++k) {
        name += parts[static_cast<std::size_t>(stream.uniform(0, 1) *
                                               static_cast<double>(parts.size()))];
    }
    return name;
}

std::string lower(std::string text) {
    for (char& letter : text)
        letter = static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
    return text;
}

bool is_plain(const std::string& name) {
    return std::ranges::all_of(name, [](char letter) {
        return letter == '_' || (letter >= '0' && letter <= '9') ||
               (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
    });
}

TEST(PoseLabels, AreLegalAndDistinctForHostileNames) {
    std::vector<std::string> ids;
    for (Index i = 0; i < 10000; ++i) {
        RandomStream stream(8, static_cast<std::uint64_t>(i));
        ids.push_back(hostile_name(stream));
    }
    const std::vector<std::string> labels = pose_labels(ids);
    std::set<std::string> seen;
    for (const std::string& label : labels) {
        EXPECT_TRUE(!label.empty() && label.size() <= 16 && is_plain(label)) << label;
        EXPECT_TRUE(label != "home" && label != "via");
        EXPECT_TRUE(seen.insert(lower(label)).second) << label;
    }
    EXPECT_EQ(pose_labels({"p1", "v1", "17", "P1", "home"}),
              (std::vector<std::string>{"p1", "v1", "17", "P1_2", "p_home"}));
}

TEST(ProgramNames, AreLegalForHostileFiles) {
    for (const ProgramFormat format : all_formats) {
        for (Index i = 0; i < 10000; ++i) {
            RandomStream stream(9, static_cast<std::uint64_t>(i));
            const std::string name = legal_program_name(format, hostile_name(stream));
            ASSERT_TRUE(!name.empty() && name.size() <= 32 && is_plain(name)) << name;
            ASSERT_TRUE(std::isalpha(static_cast<unsigned char>(name[0])) != 0) << name;
            ASSERT_EQ(legal_program_name(format, name), name);
        }
    }
    EXPECT_EQ(legal_program_name(ProgramFormat::Fanuc, "my cell"), "MY_CELL");
    EXPECT_EQ(legal_program_name(ProgramFormat::Kuka, "end"), "p_end");
    EXPECT_EQ(legal_program_name(ProgramFormat::Staubli, "a_name_of_over_15"), "a_name_of_over_");
}

// ---- Programs that people edited ----

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
    const auto expect = [](const Edited& edited, const std::string& words) {
        EXPECT_NE(edited.error().find(words), std::string::npos) << edited.error();
    };
    expect(Edited(ProgramFormat::Kuka).replace("\nEND\n", "\n"), "has no END; must be the whole");
    expect(Edited(ProgramFormat::Abb).replace("ENDMODULE", ""), "has no ENDMODULE");
    expect(Edited(ProgramFormat::Yaskawa).replace("\nEND", "\n"), "has no END");
    expect(Edited(ProgramFormat::Fanuc).replace("J P[2] 20% FINE", "J P[2] 20% FINE Offset,PR[1]"),
           "must have none but ACC");
    expect(Edited(ProgramFormat::Fanuc).replace("J P[2] 20% FINE", "J P[2] 20% CNT50"),
           "CELL.LS:12:6: does not stop");
    expect(Edited(ProgramFormat::Fanuc).replace("J P[2]", "L P[2]"), "is no joint move");
    expect(Edited(ProgramFormat::Fanuc).replace("J P[2]", "J P[22]"), "without joints");
    expect(Edited(ProgramFormat::Fanuc).replace("/POS", "/NOPOS"), "has no /POS");
    expect(Edited(ProgramFormat::Fanuc).replace("J1= ", "J1= x"), "is not a number");
    expect(Edited(ProgramFormat::Kuka).replace("}\nWAIT", "} C_PTP\nWAIT"), "does not stop");
    expect(Edited(ProgramFormat::Kuka).replace("PTP {A1", "LIN {A1"), "is no joint move");
    expect(Edited(ProgramFormat::Kuka).replace("PTP {A1", "PTP {A2"), "where A1 must be");
    expect(Edited(ProgramFormat::Abb).replace("fine", "z10"), "does not stop");
    expect(Edited(ProgramFormat::Abb).replace("MoveAbsJ", "MoveJ"), "is no move to joints");
    expect(Edited(ProgramFormat::Ur).replace("r=0)", "r=0.05)"), "does not stop");
    expect(Edited(ProgramFormat::Ur).replace("movej([", "movej(p["), "is no joint move to numbers");
    expect(Edited(ProgramFormat::Yaskawa).replace("PL=0", "PL=3"), "does not stop");
    expect(Edited(ProgramFormat::Yaskawa).replace("POSTYPE PULSE", "POSTYPE ROBOT"), "PULSE");
    expect(Edited(ProgramFormat::Yaskawa).replace("MOVJ C00001", "MOVJ C00099"), "does not state");
    expect(Edited(ProgramFormat::Staubli).replace("joints[1]", "joints[9]", "/start.pgx"),
           "data have none of");
    expect(Edited(ProgramFormat::Staubli).replace("j6=\"", "j7=\"", "/cell.dtx"), "5 joints");
    expect(Edited(ProgramFormat::Ros2).replace("J1", "J9"), "no joint of the controller");
    expect(Edited(ProgramFormat::Ros2).replace("positions: [", "positions: [.nan, "), "positions");
    expect(Edited(ProgramFormat::Csv).replace("J1_deg", "J9_deg"), "'J1_deg' is missing");
    expect(Edited(ProgramFormat::Csv).replace("home,", "home,nan"), "not a number");
}

TEST(EditedPrograms, NameWhatIsMissingMovedAndNew) {
    Edited edited(ProgramFormat::Csv);
    const ControllerJoints& joints = edited.campaign().controller;
    const VectorXd steps = joint_steps(ProgramFormat::Csv, joints);
    Plan plan;
    for (const ProgramStop& stop : cell_program(joints).stops) {
        if (!stop.is_measured) continue;
        PlannedPose& pose = plan.poses.emplace_back();
        pose.id = stop.label;
        pose.configuration = joints.to_model(stop.joints);
    }
    plan.verification.push_back(plan.poses.back());
    plan.poses.pop_back();
    const auto content = [&] {
        return program_content(edited.path(),
                               read_robot_program(edited.path(), ProgramFormat::Csv, joints),
                               joints, steps, plan);
    };
    const ProgramContent same = content();
    EXPECT_TRUE(same.dropped.empty() && same.moved.empty() && same.added.empty());
    EXPECT_EQ(same.purposes, (std::vector<std::string>{"calibrate", "via", "calibrate", "verify"}));
    edited.replace("\np1,", "\nnew,").replace("\nv1,", "\nv1,1");
    const ProgramContent other = content();
    EXPECT_EQ(other.dropped, std::vector<std::string>{"p1"});
    EXPECT_EQ(other.added, std::vector<std::string>{"new"});
    EXPECT_EQ(other.moved, std::vector<std::string>{"v1"});
    edited.replace("\nv1,", "\np2,");
    EXPECT_NE(input_error_of(content).find("visits 'p2' at other joints than before"),
              std::string::npos);
}

// ---- What is not written ----

TEST(RobotPrograms, AreSplitWhereAControllerNeedsIt) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with(reversed_joints);
    RobotProgram program = cell_program(campaign.controller);
    const ProgramStop pose = program.stops[1];
    while (program.stops.size() < 1000) program.stops.push_back(pose);
    const std::string path = folder.path("long.src");
    write_robot_program(path, ProgramFormat::Kuka, program, "", campaign, {});
    const auto files = program_files(path, ProgramFormat::Kuka, program);
    EXPECT_EQ(files.size(), 8U);
    for (const std::string& file : files) {
        const std::string text = detail::read_file(file);
        EXPECT_LE(std::ranges::count(text, '\n'), 1400) << file;
    }
    EXPECT_EQ(read_robot_program(path, ProgramFormat::Kuka, campaign.controller).size(), 1000U);
    // 9999 lines at most.
    while (program.stops.size() < 4000) program.stops.push_back(pose);
    EXPECT_NE(input_error_of([&] {
                  write_robot_program(folder.path("LONG.ls"), ProgramFormat::Fanuc, program, "",
                                      campaign, {});
              }).find("must be at most 9999"),
              std::string::npos);
    EXPECT_EQ(folder.file_count(), 8U);
}

TEST(RobotPrograms, AreRefusedWhereSomethingIsMissing) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with("{}");
    const RobotProgram program = cell_program(campaign.controller);
    const auto error = [&](const std::string& name, ProgramFormat format, const RobotProgram& one) {
        const std::string message = input_error_of([&] {
            write_robot_program(folder.path(name), format, one, folder.path("sent.csv"), campaign,
                                {});
        });
        EXPECT_EQ(folder.file_count(), 0U) << message;
        return message;
    };
    EXPECT_NE(error("A.jbi", ProgramFormat::Yaskawa, program).find("controller.pulses_per_deg"),
              std::string::npos);
    EXPECT_NE(error("my cell.ls", ProgramFormat::Fanuc, program).find("MY_CELL.ls"),
              std::string::npos);
    EXPECT_NE(error("cell.txt", ProgramFormat::Fanuc, program).find("must end in .ls"),
              std::string::npos);
    EXPECT_NE(error("cell.d", ProgramFormat::Staubli, program).find("is a folder"),
              std::string::npos);
    RobotProgram other = program;
    other.handshake = Handshake::Io;
    EXPECT_NE(error("cell", ProgramFormat::Staubli, other).find("must be none or pause"),
              std::string::npos);
    EXPECT_NE(error("a.yaml", ProgramFormat::Ros2, other).find("must be none"), std::string::npos);
    other = program;
    other.stops[2].joints[1] = std::numeric_limits<double>::quiet_NaN();
    for (const ProgramFormat format : all_formats) {
        if (format == ProgramFormat::Yaskawa) continue;
        EXPECT_NE(error(file_of(format), format, other).find("not finite"), std::string::npos);
    }
    EXPECT_THROW(parse_program_format("kawasaki"), InputError);
}

TEST(RobotPrograms, NeedSixJointsButForRosAndCsv) {
    const CampaignFile crane = parse_campaign(
        "name: crane\nrobot:\n  joints: {q1: {limits_deg: [-90, 90]}, lift: {limits_mm: [0, "
        "500]}}\n"
        "  elements: [Rz q1, Tz lift, Tx 1 m]\n"
        "sensor: {kind: points, sigma_mm: 0.1, targets: {count: 3}}\n"
        "controller: {joints: {yaw: -q1, z: lift + 100 mm}}\n",
        "crane.yaml");
    const TemporaryFolder folder;
    RobotProgram program;
    program.joints = crane.controller;
    VectorXd q(2);
    q << 0.5, 0.2;
    program.settle = 0.5;
    program.stops = {{"p1", crane.controller.to_controller(q), true, 3}};
    write_robot_program(folder.path("a.csv"), ProgramFormat::Csv, program, "", crane, {});
    EXPECT_EQ(detail::read_file(folder.path("a.csv")),
              "name,yaw_deg,z_mm,dwell_s\np1,-28.647890,300.000000,6.5\n");
    for (const ProgramFormat format : {ProgramFormat::Csv, ProgramFormat::Ros2}) {
        const std::string path = folder.path(file_of(format));
        write_robot_program(path, format, program, "", crane, {});
        const auto stops = read_robot_program(path, format, crane.controller);
        EXPECT_LT((crane.controller.to_model(stops[0].joints) - q).norm(), 1e-8);
    }
    EXPECT_THROW(joint_steps(ProgramFormat::Fanuc, crane.controller), InputError);
}

}  // namespace
}  // namespace posewise::io
