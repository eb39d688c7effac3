#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "../../src/model/complete_model.hpp"
#include "io/format/atomic_file.hpp"
#include "posewise/io/robot_files.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"

// Parameters for RoboDK, by a forward kinematics of their own.

namespace posewise::io {
namespace {

using namespace testing;

/// The numbers of a Python list of lists of four.
std::vector<Eigen::Vector4d> list_in(const std::string& text, const std::string& name) {
    const std::size_t begin = text.find('\n' + name + " = [\n");
    EXPECT_NE(begin, std::string::npos) << name;
    const std::size_t end = text.find("\n]\n", begin);
    std::vector<double> numbers;
    for (std::size_t at = begin + name.size() + 4; at < end;) {
        at = text.find_first_of("-0123456789", at);
        if (at >= end) break;
        char* behind = nullptr;
        numbers.push_back(std::strtod(text.c_str() + at, &behind));
        at = static_cast<std::size_t>(behind - text.c_str());
    }
    EXPECT_EQ(numbers.size() % 4, 0U);
    std::vector<Eigen::Vector4d> rows;
    for (std::size_t k = 0; k + 3 < numbers.size(); k += 4) {
        rows.emplace_back(numbers[k], numbers[k + 1], numbers[k + 2], numbers[k + 3]);
    }
    return rows;
}

Isometry3d frame_in(const std::string& text, const std::string& name) {
    const auto rows = list_in(text, name);
    Isometry3d frame = Isometry3d::Identity();
    for (Index k = 0; k < 4; ++k) {
        frame.matrix().row(k) = rows.at(static_cast<std::size_t>(k)).transpose();
    }
    EXPECT_EQ(frame.matrix().row(3), Eigen::RowVector4d(0, 0, 0, 1));
    frame.translation() /= 1000;
    return frame;
}

/// Craig's matrix of a link, written out [Craig 1986, eq. 3.6].
Isometry3d craig(double alpha, double a, double theta, double d) {
    const double ca = std::cos(alpha), sa = std::sin(alpha);
    const double ct = std::cos(theta), st = std::sin(theta);
    Isometry3d link = Isometry3d::Identity();
    link.matrix() << ct, -st, 0, a,      //
        st * ca, ct * ca, -sa, -sa * d,  //
        st * sa, ct * sa, ca, ca * d,    //
        0, 0, 0, 1;
    return link;
}

Isometry3d flange_of(const std::string& text, const VectorXd& q) {
    Isometry3d frame = frame_in(text, "BASE");
    const auto rows = list_in(text, "DHM");
    EXPECT_EQ(std::ssize(rows), q.size());
    for (Index k = 0; k < q.size(); ++k) {
        const Eigen::Vector4d& row = rows.at(static_cast<std::size_t>(k));
        frame = frame * craig(row[0], row[1] / 1000, row[2] + q[k], row[3] / 1000);
    }
    return frame * frame_in(text, "TOOL");
}

TEST(WriteRobodk, HasTheFlangeWhereTheCalibratedRobotHasIt) {
    const TemporaryFolder folder;
    const std::string path = folder.path("arm.py");
    // FANUC's axes 2 and 3, a UR's 2, 3 and 4 are parallel but for errors.
    for (const auto& [chain, has_parallel] :
         {std::pair{fanuc(), true}, {ur_type(), true}, {fanuc(), false}}) {
        for (const double size : {0.0, 1e-6, 1e-4, 1e-2}) {
            const Chain robot = complete_model(with_harmonics(chain, {1}));
            RandomStream stream(31);
            VectorXd errors = random_vector(stream, robot.parameter_count(), size);
            const std::vector<std::string> names = robot.parameter_names();
            for (Index k = 0; k < errors.size(); ++k) {
                if (robot.parameter_term(k) != nullptr) errors[k] = 0;
                // Axes 2 and 3 stay parallel without turns behind joint 2.
                const std::string& name = names[static_cast<std::size_t>(k)];
                if (!has_parallel && (name == "Rx2" || name == "Rz2")) errors[k] = 0;
            }
            const FlangeDifference difference =
                write_robodk(path, "a\"<b", modified_dh(robot, errors), robot, errors);
            const double tolerance = has_parallel && size > 0 ? 1e-9 : 1e-12;
            EXPECT_LT(difference.position, tolerance) << size;
            const std::string text = detail::read_file(path);
            for (Index i = 0; i < 100; ++i) {
                const VectorXd q = random_vector(stream, robot.joint_count(), 3);
                const Isometry3d off =
                    robot.base_from_flange(q, errors).inverse() * flange_of(text, q);
                EXPECT_LT(off.translation().norm(), tolerance) << size;
                EXPECT_LT((off.linear() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << size;
            }
        }
    }
}

TEST(WriteRobodk, IsForJointsThatTurnOneAxisEach) {
    EXPECT_NE(input_error_of([] {
                  modified_dh(scara(), {});
              }).find("does not turn one axis of its own in the order of the joints"),
              std::string::npos);
    using enum Motion;
    const Chain coupled({{"q1", -3, 3}, {"q2", -1, 2}},
                        {{Rotation, Axis::Z, 0.1, {{0, 1}}, ""},
                         {Translation, Axis::X, 0.3, {}, ""},
                         {Rotation, Axis::Y, 0, {{1, 1}, {0, 1}}, ""},
                         {Translation, Axis::X, 0.3, {}, ""}});
    EXPECT_NE(input_error_of([&] { modified_dh(coupled, {}); }).find("joint 'q2' does not turn"),
              std::string::npos);
}

/// Run beside modules that stand for RoboDK's, it sends what RoboDK's API for C# sends, in its
/// order.
TEST(WriteRobodk, SendsRowsAndFramesTwice) {
    const TemporaryFolder folder;
    const Chain robot = fanuc();
    const VectorXd none = VectorXd::Zero(robot.parameter_count());
    write_robodk(folder.path("arm.py"), "arm", modified_dh(robot, none), robot, none);
    std::filesystem::create_directory(folder.path("robodk"));
    folder.write("robodk/__init__.py", "");
    folder.write("robodk/robomath.py", "Mat = list\n");
    folder.write("robodk/robolink.py", R"(ITEM_TYPE_ROBOT = 2
class Robolink:
    def ItemUserPick(self, words, kind):
        assert kind == 2
        return "robot"
    def __getattr__(self, name):
        assert name in ("_check_connection", "_check_status", "_send_line", "_send_item", "_send_pose", "_send_int", "_send_array")
        return lambda *values: print(name, *[len(v) if isinstance(v, list) else v for v in values])
)");
    const std::string line = "cd '" + folder.path("") + "' && python3 arm.py > sent.txt";
    ASSERT_EQ(std::system(line.c_str()), 0);
    std::string expected =
        "_check_connection\n_send_line S_AbsAccParam\n_send_item robot\n"
        "_send_pose 4\n";
    for (int k = 0; k < 2; ++k) {
        expected += "_send_pose 4\n_send_pose 4\n_send_int 6\n";
        for (int row = 0; row < 6; ++row) expected += "_send_array 4\n";
    }
    EXPECT_EQ(detail::read_file(folder.path("sent.txt")),
              expected + "_send_array 0\n_send_array 0\n_check_status\n");
}

}  // namespace
}  // namespace posewise::io
