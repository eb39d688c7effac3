#include <gtest/gtest.h>

#include <numbers>

#include "posewise/calibrator/correction.hpp"
#include "posewise/io/robot_programs.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "program_examples.hpp"
#include "support/temporary_folder.hpp"

// Targets of programs that are stated by coordinates: found, corrected, and nothing else touched.

namespace posewise::io {
namespace {

using namespace testing;

constexpr ProgramFormat place_formats[] = {ProgramFormat::Fanuc, ProgramFormat::Kuka,
                                           ProgramFormat::Abb, ProgramFormat::Ur};

VectorXd no_errors(const Chain& robot) { return VectorXd::Zero(robot.parameter_count()); }

long quadrant_of(double angle) { return std::lround(std::floor(to_degrees(angle) / 90)); }

/// A move there, written from definitions, and of FANUC the position.
std::string place_text(ProgramFormat format, const Isometry3d& place, const VectorXd& joints,
                       Index number) {
    const Vector3d mm = 1e3 * place.translation();
    const Vector3d rpy = rpy_from_rotation(place.linear()) * (180 / std::numbers::pi);
    const Vector3d vector = vector_from_rotation(place.linear());
    const Eigen::Quaterniond q(place.linear());
    int turns = 0;
    for (Index j = 0; j < 6; ++j) turns |= joints[j] < 0 ? 1 << j : 0;
    switch (format) {
        case ProgramFormat::Fanuc:
            return fmt::format(
                "P[{}]{{\n   GP1:\n\tUF : 1, UT : 2,\t\tCONFIG : 'N U T, 0, 0, 0',\n\tX = {:9.3f}  "
                "mm,\tY = {:9.3f}  mm,\tZ = {:9.3f}  mm,\n\tW = {:9.3f} deg,\tP = {:9.3f} deg,\tR "
                "= {:9.3f} deg\n}};\n",
                number, mm.x(), mm.y(), mm.z(), rpy[0], rpy[1], rpy[2]);
        case ProgramFormat::Kuka:
            return fmt::format(
                "PTP {{X {:.4f},Y {:.4f},Z {:.4f},A {:.5f},B {:.5f},C {:.5f},S 2,T {}}} ; "
                "{{X 1}}\n",
                mm.x(), mm.y(), mm.z(), rpy[2], rpy[1], rpy[0], turns);
        case ProgramFormat::Abb:
            return fmt::format(
                "    MoveL [[{:.4f},{:.4f},{:.4f}],[{:.9f},{:.9f},{:.9f},{:.9f}],[{},{},{},0],"
                "[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,torch\\WObj:=table;\r\n",
                mm.x(), mm.y(), mm.z(), q.w(), q.x(), q.y(), q.z(), quadrant_of(joints[0]),
                quadrant_of(joints[3]), quadrant_of(joints[5]));
        default:
            return fmt::format("  movel(p[{:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}, {:.6f}])\n",
                               place.translation().x(), place.translation().y(),
                               place.translation().z(), vector.x(), vector.y(), vector.z());
    }
}

std::string program_text(ProgramFormat format, const std::string& places) {
    switch (format) {
        case ProgramFormat::Fanuc:
            return "/PROG WELD\n/ATTR\n/MN\n   1:L P[1] 100mm/sec FINE ;\n/POS\n" + places +
                   "/END\n";
        case ProgramFormat::Kuka:
            return "DEF cell( )\n$TOOL=TOOL_DATA[1]\n" + places + "END\n";
        case ProgramFormat::Abb:
            return "MODULE cell\r\n  PROC weld()\r\n" + places + "  ENDPROC\r\nENDMODULE\r\n";
        default:
            return "def weld():\n  set_tcp(p[0, 0, 0.2, 0, 0, 0])\n" + places + "end\n";
    }
}

/// What is not a number of a place.
std::string without_places(const TargetProgram& program) {
    std::string text;
    std::size_t done = 0;
    for (const PlaceTarget& target : program.places) {
        std::vector<TextSpan> spans = target.values;
        spans.insert(spans.end(), target.configuration.begin(), target.configuration.end());
        for (const auto& [begin, end] : spans) {
            text.append(program.content, done, begin - done);
            while (text.ends_with(' ')) text.pop_back();
            text += '#';
            done = end;
        }
    }
    return text.append(program.content, done);
}

/// A cell whose robot bends, and its program with places.
struct Cell {
    explicit Cell(ProgramFormat of)
        : format(of), campaign(cell_with(of == ProgramFormat::Fanuc ? "{}" : controller_of(of))) {
        campaign.robot = with_torque_shapes(campaign.robot);
        campaign.nominal.robot = VectorXd::Zero(campaign.robot.parameter_count());
        truth = draw_truth(campaign, 5);
        frames.flange_from_tool.translation() << 0.2, 0.02, 0.15;
        frames.flange_from_tool.linear() = rotation_from_rpy({0.3, -0.4, 0.5});
        frames.base_from_frame.translation() << 0.7, -0.3, 0.1;
        frames.base_from_frame.linear() = rotation_from_rpy({0.02, -0.01, 0.8});
        frames.seed = campaign.cell.home;
        std::string places;
        const std::vector<std::vector<double>> poses{
            {20, -10, -10, 30, 60, 20}, {-30, 10, 5, -40, 50, 100}, {45, 20, -25, 12, -70, -15}};
        joints.resize(std::ssize(poses), 6);
        for (Index i = 0; i < joints.rows(); ++i) {
            const std::vector<double>& pose = poses[static_cast<std::size_t>(i)];
            joints.row(i) = Eigen::Map<const VectorXd>(pose.data(), 6).transpose() * to_radians(1);
            const VectorXd q = joints.row(i).transpose();
            wanted.push_back(campaign.robot.base_from_flange(q, no_errors(campaign.robot)));
            places += place_text(
                format, frames.base_from_frame.inverse() * wanted.back() * frames.flange_from_tool,
                campaign.controller.to_controller(q), i + 1);
        }
        path = folder.write(file_of(format), program_text(format, places));
    }

    TargetProgram read() const {
        return read_program_targets(path, format, campaign.controller,
                                    TargetKinds::JointsAndPlaces);
    }
    std::vector<CartesianTarget> targets(const TargetProgram& program) const {
        std::vector<CartesianTarget> targets;
        for (std::size_t k = 0; k < program.places.size(); ++k) {
            const PlaceTarget& place = program.places[k];
            CartesianTarget& target = targets.emplace_back();
            target.id = place.id;
            target.frame_from_tool = place.frame_from_tool;
            // What no configuration of the program says, its joints do.
            if (place.configuration.empty()) {
                target.seed = joints.row(static_cast<Index>(k)).transpose();
                continue;
            }
            target.is_wanted = [&](const VectorXd& q) {
                return is_of_configuration(place, format, campaign.controller.to_controller(q));
            };
        }
        return targets;
    }

    TemporaryFolder folder;
    ProgramFormat format;
    CampaignFile campaign;
    Parameters truth;
    CartesianFrames frames;
    RowMatrixXd joints;
    std::vector<Isometry3d> wanted;
    std::string path;
};

/// The place that the numbers in a file state, by the makers' definitions, typed here.
Isometry3d place_in(const std::string& text, ProgramFormat format, const PlaceTarget& target) {
    std::vector<double> n;
    for (const auto& [begin, end] : target.values) {
        n.push_back(std::stod(text.substr(begin, end - begin)));
    }
    const auto turn = [](double degrees, const Vector3d& axis) {
        return Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis);
    };
    const auto about = [&](double z, double y, double x) {
        return Eigen::Matrix3d(turn(z, Vector3d::UnitZ()) * turn(y, Vector3d::UnitY()) *
                               turn(x, Vector3d::UnitX()));
    };
    Isometry3d place = Isometry3d::Identity();
    place.translation() = (format == ProgramFormat::Ur ? 1 : 1e-3) * Vector3d(n[0], n[1], n[2]);
    if (format == ProgramFormat::Fanuc) place.linear() = about(n[5], n[4], n[3]);  // W, P, R
    if (format == ProgramFormat::Kuka) place.linear() = about(n[3], n[4], n[5]);   // A, B, C
    if (format == ProgramFormat::Abb) {
        place.linear() = Eigen::Quaterniond(n[3], n[4], n[5], n[6]).toRotationMatrix();
    }
    if (format == ProgramFormat::Ur) {
        const Vector3d vector(n[3], n[4], n[5]);
        place.linear() = Eigen::AngleAxisd(vector.norm(), vector.normalized()).toRotationMatrix();
    }
    return place;
}

/// By how much the digits of a place in such a file move what is 0.25 m off its origin, m.
double rounding_of(ProgramFormat format) {
    const double length = format == ProgramFormat::Kuka  ? 5e-9
                          : format == ProgramFormat::Abb ? 5e-8
                                                         : 5e-7;
    const double angle = format == ProgramFormat::Fanuc  ? 5e-4 * std::numbers::pi / 180
                         : format == ProgramFormat::Kuka ? 5e-6 * std::numbers::pi / 180
                         : format == ProgramFormat::Abb  ? 1e-8
                                                         : 5e-7;
    return std::sqrt(3.0) * (length + 0.26 * angle);
}

/// Also where the correction may turn joints by so little that an error is left: what is claimed
/// to be left is.
TEST(ProgramPlaces, LeaveTheErrorThatTheCorrectionStates) {
    for (const ProgramFormat format : place_formats) {
        for (const double largest_change : {10.0, 0.001}) {  // deg
            const Cell cell(format);
            const Chain& robot = cell.campaign.robot;
            const auto& controller = cell.campaign.controller;
            const TargetProgram program = cell.read();
            const RowMatrixXd nominal =
                nominal_configurations(cell.campaign, cell.targets(program), cell.frames);
            CorrectionOptions options;
            options.largest_turn = to_radians(largest_change);
            const CorrectedPoses corrected =
                correct_poses(cell.campaign, cell.truth, nominal, {"a", "b", "c"},
                              CorrectionBase::Estimate, options);
            const std::vector<Isometry3d> places = corrected_targets(corrected, cell.frames);
            std::vector<CorrectedPlace> replaced;
            for (std::size_t k = 0; k < places.size(); ++k) {
                replaced.push_back(
                    {places[k],
                     controller.to_controller(nominal.row(static_cast<Index>(k)).transpose()),
                     controller.to_controller(corrected.corrections[k].joints)});
            }
            const std::string path = cell.folder.path(file_of(format));
            write_program_targets(path, program, format, controller, {}, replaced);
            const TargetProgram back = cell.read();
            const RowMatrixXd sent =
                nominal_configurations(cell.campaign, cell.targets(back), cell.frames);
            const double rounding = rounding_of(format);
            for (Index i = 0; i < sent.rows(); ++i) {
                const auto k = static_cast<std::size_t>(i);
                const Correction& one = corrected.corrections[k];
                const Isometry3d stated = place_in(back.content, format, back.places[k]);
                const Isometry3d tool = robot.base_from_flange(one.joints, no_errors(robot)) *
                                        cell.frames.flange_from_tool;
                const Isometry3d off = (cell.frames.base_from_frame * stated).inverse() * tool;
                EXPECT_LT(off.translation().norm(), rounding) << program_format_name(format);
                EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), rounding / 0.26)
                    << program_format_name(format);
                const Vector3d wanted =
                    robot.base_from_flange(nominal.row(i).transpose(), no_errors(robot))
                        .translation();
                const Vector3d reached =
                    robot.base_from_flange(sent.row(i).transpose(), cell.truth.robot).translation();
                EXPECT_NEAR((reached - wanted).norm(), one.residual.position, 1.2 * rounding)
                    << program_format_name(format) << ' ' << i;
                if (largest_change < 1) {
                    EXPECT_GT(one.residual.position, 1e-5);
                } else {
                    EXPECT_LT(one.residual.position, 1e-9);
                }
            }
        }
    }
}

TEST(ProgramPlaces, BringARobotThatBendsWhereTheyAre) {
    for (const ProgramFormat format : place_formats) {
        const Cell cell(format);
        const Chain& robot = cell.campaign.robot;
        const TargetProgram program = cell.read();
        ASSERT_EQ(program.places.size(), 3U) << program_format_name(format);
        EXPECT_TRUE(program.others.empty() && program.targets.empty());
        const std::vector<CartesianTarget> targets = cell.targets(program);
        const RowMatrixXd nominal = nominal_configurations(cell.campaign, targets, cell.frames);
        EXPECT_LT((nominal - cell.joints).cwiseAbs().maxCoeff(), 1e-4)
            << program_format_name(format) << '\n'
            << nominal << '\n'
            << cell.joints;
        std::vector<std::string> ids;
        for (const CartesianTarget& target : targets) ids.push_back(target.id);
        const CorrectedPoses corrected = correct_poses(cell.campaign, cell.truth, nominal, ids);
        const std::vector<Isometry3d> places = corrected_targets(corrected, cell.frames);
        std::vector<CorrectedPlace> replaced;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const auto& controller = cell.campaign.controller;
            replaced.push_back(
                {places[k],
                 controller.to_controller(nominal.row(static_cast<Index>(k)).transpose()),
                 controller.to_controller(corrected.corrections[k].joints)});
        }
        const std::string path = cell.folder.path(file_of(format));
        write_program_targets(path, program, format, cell.campaign.controller, {}, replaced);
        const TargetProgram back = cell.read();
        EXPECT_EQ(without_places(back), without_places(program));
        EXPECT_NE(back.content, program.content);
        // The controller's joints for what was written, and where the real robot is then.
        const RowMatrixXd sent =
            nominal_configurations(cell.campaign, cell.targets(back), cell.frames);
        for (Index i = 0; i < sent.rows(); ++i) {
            const VectorXd q = sent.row(i).transpose();
            const Isometry3d& wanted = cell.wanted[static_cast<std::size_t>(i)];
            const auto miss = [&](const VectorXd& joints) {
                return (robot.base_from_flange(joints, cell.truth.robot) *
                            cell.frames.flange_from_tool.translation() -
                        wanted * cell.frames.flange_from_tool.translation())
                    .norm();
            };
            EXPECT_GT(miss(cell.joints.row(i).transpose()), 1e-4);
            // Rounding of program and correction, by 1e-3 mm and deg at most.
            EXPECT_LT(miss(q), 3e-5) << program_format_name(format) << ' ' << i;
        }
    }
}

TEST(ProgramPlaces, AreLeftUnlessTheyAreAskedFor) {
    for (const ProgramFormat format : place_formats) {
        const Cell cell(format);
        EXPECT_NE(input_error_of([&] {
                      read_program_targets(cell.path, format, cell.campaign.controller);
                  }).find("has no target in joint values"),
                  std::string::npos);
    }
}

TEST(ProgramPlaces, AreOfOneToolAndFrame) {
    const auto error = [](ProgramFormat format, const std::string& what, const std::string& by) {
        const Cell cell(format);
        std::string text = detail::read_file(cell.path);
        const std::size_t at = text.rfind(what);
        EXPECT_NE(at, std::string::npos) << text;
        text.replace(at, what.size(), by);
        detail::write_file(cell.path, text);
        return input_error_of([&] { cell.read(); });
    };
    using enum ProgramFormat;
    EXPECT_NE(error(Fanuc, "UT : 2", "UT : 3").find("several tools, '2' and '3'"),
              std::string::npos);
    EXPECT_NE(error(Fanuc, "UF : 1", "UF : 3").find("several frames"), std::string::npos);
    EXPECT_NE(error(Kuka, "PTP {", "$TOOL=TOOL_DATA[2]\nPTP {").find("several tools"),
              std::string::npos);
    EXPECT_NE(error(Abb, "torch", "tool0").find("several tools, 'tool0' and 'torch'"),
              std::string::npos);
    EXPECT_NE(error(Abb, "table", "wobj0").find("several frames"), std::string::npos);
    EXPECT_NE(error(Ur, "  movel", "  set_tcp(p[0,0,0,0,0,0])\n  movel").find("several tools"),
              std::string::npos);
    const auto expect = [&](ProgramFormat format, const std::string& what, const std::string& by,
                            const std::string& words) {
        const std::string found = error(format, what, by);
        EXPECT_NE(found.find(words), std::string::npos) << by << ": " << found;
    };
    expect(Kuka, "PTP {", "BAS(#TOOL,2)\nPTP {",
           "several tools, 'tool_data[1]' and 'tool_data[2]'");
    expect(Kuka, "PTP {", "BAS (#TOOL, 1 )\nPTP {", "no error");
    expect(Kuka, "PTP {", "$tool = Tool_Data[1]\nPTP {", "no error");
    expect(Kuka, "PTP {", "BAS(#BASE,2)\n$BASE=BASE_DATA[3]\nPTP {", "several frames");
    expect(Kuka, "$TOOL=TOOL_DATA[1]", "FDAT_ACT=FP1\nFDAT_ACT=FP2",
           "several tools, 'fp1' and 'fp2'");
    expect(Fanuc, "/POS", "   2:  UTOOL_NUM=4 ;\n/POS", "several tools, '2' and '4'");
    expect(Fanuc, "/POS", "   2:  UTOOL_NUM=2 ;\n   3:  !UTOOL_NUM=4 ;\n/POS", "no error");
    expect(Fanuc, "/POS", "   2:  UFRAME_NUM = 4 ;\n/POS", "several frames, '1' and '4'");
    expect(Abb, "MoveL [", "TriggL p1,v100,t,fine,gun;\n MoveL [", "several tools, 'gun'");
    expect(Abb, "MoveL [", "MoveLDO p1,v100,fine,torch\\WObj:=table,do1,on;\n MoveL [", "no error");
    expect(Abb, "MoveL [", "MoveJSync p1,v100,fine,gun,\"lamp\";\n MoveL [",
           "several tools, 'gun'");
    // What shifts places, or calculates where they are.
    expect(Kuka, "PTP {", "$BASE.X=$BASE.X+10\nPTP {", "poses.src:5: calculates '$base.x'");
    expect(Kuka, "PTP {", "$BASE=BASE_DATA[1]:OFFS\nPTP {", "calculates '$base'");
    expect(Kuka, "PTP {", "BASE_DATA[1]=f(2)\nPTP {", "calculates 'base_data[1]'");
    expect(Kuka, "PTP {", "$BASE={FRAME: X 1,Y 2,Z 3,A 0,B 0,C 0}\nPTP {", "no error");
    expect(Fanuc, "/POS", "   2:  UFRAME[1]=PR[3] ;\n/POS", "CELL.LS:5: sets 'uframe[1]'");
    for (const std::string shift :
         {"PDispSet d;", "PDispOn p1,torch;", "EOffsSet e;", "EOffsOn p1;"}) {
        expect(Abb, "MoveL [", shift + "\n MoveL [", "shifts places by '");
    }
    expect(Abb, "MoveL [", "PDispOff; ! PDispSet d;\n MoveL [", "no error");
    expect(Abb, ",torch", "\\Corr,torch", "shifts places by '\\corr'");
    expect(Ur, "  movel", "  path_offset_enable()\n  movel", "cell.script:5: shifts places");
    // Numbers that are none.
    expect(Fanuc, "CONFIG", "", "has no CONFIG");
    EXPECT_NE(error(Fanuc, "X = ", "X = x").find("is no number of mm"), std::string::npos);
    EXPECT_NE(error(Abb, "],[0.", "],[7.").find("has a quaternion of length"), std::string::npos);
    EXPECT_NE(error(Ur, "p[0.", "p[1234567890.").find("where no cell is"), std::string::npos);
}

/// A program of inline forms selects tool and base by its FDATs, which stand in the .dat.
TEST(ProgramPlaces, OfKukaTakeToolsFromTheFileBeside) {
    const Cell cell(ProgramFormat::Kuka);
    std::string text = detail::read_file(cell.path);
    text.replace(text.find("$TOOL=TOOL_DATA[1]"), 18, "FDAT_ACT=FP1");
    text.replace(text.rfind("PTP {"), 5, "FDAT_ACT=FP2\nPTP {");
    detail::write_file(cell.path, text);
    const auto error = [&](int tool, int base) {
        cell.folder.write("poses.dat",
                          fmt::format("DEFDAT poses\nDECL FDAT FP1={{TOOL_NO 1,BASE_NO 1,IPO_FRAME "
                                      "#BASE}}\nDECL FDAT FP2={{TOOL_NO {},BASE_NO {},IPO_FRAME "
                                      "#BASE}}\nENDDAT\n",
                                      tool, base));
        return input_error_of([&] { cell.read(); });
    };
    EXPECT_EQ(error(1, 1), "no error");
    EXPECT_NE(error(2, 1).find("several tools, 'tool_data[1]'"), std::string::npos) << error(2, 1);
    EXPECT_NE(error(1, 2).find("several frames"), std::string::npos) << error(1, 2);
}

TEST(ProgramPlaces, NameTheToolThatTheProgramStates) {
    const auto tool = [](ProgramFormat format, const std::string& what, const std::string& by) {
        const Cell cell(format);
        std::string text = detail::read_file(cell.path);
        for (std::size_t at = text.find(what); at != std::string::npos;
             at = text.find(what, at + by.size())) {
            text.replace(at, what.size(), by);
        }
        detail::write_file(cell.path, text);
        const auto stated = cell.read().tool;
        if (!stated) return std::string("none");
        const Vector3d mm = 1e3 * stated->position;
        return fmt::format("{:g} {:g} {:g} in {}", mm[0], mm[1], mm[2], stated->line);
    };
    using enum ProgramFormat;
    EXPECT_EQ(tool(Ur, "x", "x"), "0 0 200 in 2");
    EXPECT_EQ(tool(Ur, "set_tcp(p[0, 0, 0.2, 0, 0, 0])", "set_tcp(torch)"), "none");
    EXPECT_EQ(tool(Kuka, "x", "x"), "none");
    EXPECT_EQ(tool(Kuka, "TOOL_DATA[1]", " {FRAME: X 1, Y 2,Z -3.5,A 0,B 0,C 0}"), "1 2 -3.5 in 2");
    EXPECT_EQ(tool(Kuka, "=TOOL_DATA[1]", " = $NULLFRAME"), "0 0 0 in 2");
    EXPECT_EQ(tool(Abb, "x", "x"), "none");
    EXPECT_EQ(tool(Abb, ",torch", ",tool0"), "0 0 0 in 3");
    const std::string data = "[[7,8,250],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];\n  PROC";
    EXPECT_EQ(tool(Abb, "  PROC", "\n  TASK PERS tooldata Torch:=[TRUE," + data), "7 8 250 in 3");
    EXPECT_EQ(tool(Abb, "  PROC", "  PERS tooldata torch:=[FALSE," + data), "none");
    EXPECT_EQ(tool(Abb, "  PROC", "  PERS tooldata torch2:=[TRUE," + data), "none");
    EXPECT_EQ(tool(Fanuc, "x", "x"), "none");
}

TEST(ProgramPlaces, WithMovingExternalAxesStay) {
    using enum ProgramFormat;
    for (const auto& [format, what, by] :
         {std::tuple{Kuka, ",S 2,", ",E1 5.0,S 2,"}, std::tuple{Abb, "[9E9,", "[12.5,"}}) {
        const Cell cell(format);
        std::string text = detail::read_file(cell.path);
        text.replace(text.find(what), std::string(what).size(), by);
        detail::write_file(cell.path, text);
        EXPECT_EQ(cell.read().places.size(), 2U);
        EXPECT_EQ(cell.read().others.size(), 1U);
    }
}

TEST(CartesianTable, IsReadAsTargets) {
    const TemporaryFolder folder;
    const CampaignFile campaign = cell_with("{}");
    const auto read = [&](const std::string& text) {
        return read_cartesian_targets(folder.write("t.csv", text), campaign);
    };
    const auto targets = read(
        "config,x_mm,y_mm,z_m,roll_deg,pitch_deg,yaw_deg\nhole 1,100,200,0.3,0,90,0\n"
        "hole 2,1,2,3,10,20,30\n");
    ASSERT_EQ(targets.size(), 2U);
    EXPECT_EQ(targets[0].id, "hole 1");
    EXPECT_LT((targets[0].frame_from_tool.translation() - Vector3d(0.1, 0.2, 0.3)).norm(), 1e-15);
    EXPECT_LT((targets[0].frame_from_tool.linear() * Vector3d::UnitX() + Vector3d::UnitZ()).norm(),
              1e-12);
    EXPECT_EQ(targets[0].seed.size(), 0);
    const auto other = read(
        "qw;qx;qy;qz;config;x_mm;y_mm;z_mm;q1_deg;q2_deg;q3_deg;q4_deg;q5_deg;q6_deg\n"
        "0;0;1;0;a;1;2;3;10;20;30;40;50;60\n");
    EXPECT_LT((other[0].frame_from_tool.linear() * Vector3d::UnitX() + Vector3d::UnitX()).norm(),
              1e-12);
    EXPECT_NEAR(to_degrees(other[0].seed[5]), 60, 1e-12);
    const auto error = [&](const std::string& text) { return input_error_of([&] { read(text); }); };
    const std::string start = "config,x_mm,y_mm,z_mm,";
    for (const auto& [text, words] :
         {std::pair{std::string(), "is empty"},
          {start + "roll_deg,pitch_deg,yaw_deg\n", "has no target"},
          {start + "roll_deg,pitch_deg\na,1,2,3,4,5\n", "must state the orientation once"},
          {start + "roll_deg,pitch_deg,yaw_deg,qw\na,1,2,3,4,5,6,7\n", "orientation once"},
          {start + "roll,pitch_deg,yaw_deg\n", "has the wrong unit, or none"},
          {start + "roll_deg,pitch_deg,yaw_deg,q1_deg\n", "has columns of 1 joints"},
          {start + "roll_deg,pitch_deg,yaw_deg,q7_deg\n", "'q7_deg' is unknown"},
          {start + "roll_deg,pitch_deg,yaw_deg\na,1,2,3,4,5,x\n", "is not a number"},
          {start + "roll_deg,pitch_deg,yaw_deg\n,1,2,3,4,5,6\n", "config is empty"},
          {start + "roll_deg,pitch_deg,yaw_deg\na,1,2,3,4,5\n", "row has 6 fields"},
          {start + "qw,qx,qy,qz\na,1,2,3,4,5,6,7\n", "quaternion has length"},
          {std::string("config,x_mm,y_mm,rx_deg,ry_deg,rz_deg\n"), "missing column z"}}) {
        EXPECT_NE(error(text).find(words), std::string::npos) << error(text);
    }
}

}  // namespace
}  // namespace posewise::io
