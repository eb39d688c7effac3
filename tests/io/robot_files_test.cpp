#include "posewise/io/robot_files.hpp"

#include <gtest/gtest.h>

#include "../../src/io/format/atomic_file.hpp"
#include "../../src/model/complete_model.hpp"
#include "campaign_text.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/robots.hpp"
#include "support/slips.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"
#include "support/urdf_text.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using namespace testing;

VectorXd random_errors(const Chain& chain, Index without_last) {
    RandomStream stream(31);
    VectorXd errors = random_vector(stream, chain.parameter_count(), 1e-3);
    errors.tail(without_last).setZero();
    return errors;
}

TEST(WriteDh, IsReadBackAsTheSameRobot) {
    const TemporaryFolder folder;
    const std::string path = folder.path("dh.yaml");
    for (const Chain& chain : {fanuc(), scara(), gantry_with_wrist(), ur_type()}) {
        const Chain robot = complete_model(with_harmonics(chain, {1}));
        const VectorXd errors = random_errors(robot, 0);
        const auto difference = write_dh(path, "a\nb", dh_rows(robot, errors), robot, errors);
        EXPECT_LT(difference.position, 1e-13);
        EXPECT_LT(difference.orientation, 1e-13);
        EXPECT_EQ(difference.configuration_count, 1000);
    }
    const std::string text = read_file(path);
    EXPECT_EQ(text.rfind("# a\\x0ab\nrobot:\n", 0), 0U) << text;
    EXPECT_NE(text.find("beta_deg: "), std::string::npos) << text;
    EXPECT_EQ(folder.file_count(), 1U);
}

/// 2 nm in one offset: what stood there stays.
TEST(WriteDh, LeavesWhatStoodThereIfItIsAnotherRobot) {
    const TemporaryFolder folder;
    const std::string path = folder.write("dh.yaml", "old");
    const Chain robot = complete_model(ur_type());
    const VectorXd errors = random_errors(robot, 0);
    auto rows = dh_rows(robot, errors);
    rows[3].d += 2e-9;
    EXPECT_EQ(input_error_of([&] {
                  write_dh(path, "ur", rows, robot, errors);
              }).rfind("dh.yaml: is not written: read back, its flange is up to 2.0e-09 m and ", 0),
              0U);
    EXPECT_EQ(read_file(path), "old");
    EXPECT_EQ(folder.file_count(), 1U);
}

TEST(WriteUrKinematics, IsReadBackAsTheSameRobot) {
    const TemporaryFolder folder;
    const std::string path = folder.path("ur.yaml");
    const Chain robot = complete_model(ur_type());
    const VectorXd errors = random_errors(robot, 4);
    const UrFrames frames = ur_frames(robot, errors);
    EXPECT_LT(write_ur_kinematics(path, "ur", frames, robot, errors).position, 1e-14);
    const UrFrames back = read_ur_kinematics(path);
    for (std::size_t k = 0; k < 6; ++k) EXPECT_TRUE(back[k].isApprox(frames[k], 1e-15));
    const std::string text = read_file(path);
    EXPECT_NE(text.find("  hash: posewise_"), std::string::npos) << text;
    EXPECT_THROW(write_ur_kinematics(path, "ur", ur_frames(ur_type(), VectorXd()), robot, errors),
                 InputError);
    EXPECT_EQ(read_file(path), text);
}

TEST(ReadUrKinematics, TellsWhatIsWrongAndWhere) {
    const TemporaryFolder folder;
    const Chain robot = ur_type();
    write_ur_kinematics(folder.path("k.yaml"), "ur", ur_frames(robot, VectorXd()), robot,
                        VectorXd());
    const std::string text = read_file(folder.path("k.yaml"));
    const auto error = [&](const std::string& part, const std::string& by) {
        folder.write("k.yaml", replaced(text, part, by));
        return input_error_of([&] { read_ur_kinematics(folder.path("k.yaml")); });
    };
    EXPECT_EQ(error("forearm:", "elbow:").rfind("k.yaml:17:3: unknown key 'elbow'", 0), 0U);
    EXPECT_NE(error("    z: 0.1273\n", "").find("kinematics.shoulder has no key z"),
              std::string::npos);
    EXPECT_NE(error("z: 0.1273", "z: .nan").find("which is not a number"), std::string::npos);
    EXPECT_NE(error("kinematics:", "robot:").find("unknown key 'robot'"), std::string::npos);
}

/// What acts behind the last joint where no fixed joint could take it is not held against the file.
TEST(WriteCalibratedUrdf, IsReadBackAsTheSameRobotWithoutWhatItCannotExpress) {
    const TemporaryFolder folder;
    const UrdfSource source{
        folder.write("a.urdf", urdf_text({{"revolute", "xyz='0 0 1'", "0 0 1"},
                                          {"revolute", "xyz='1 0 0'", "1 0 0"}})),
        "", ""};
    const Chain robot = complete_model(with_harmonics(make_chain(read_urdf(source)), {1}));
    const VectorXd errors = random_errors(robot, 0);
    const CalibratedUrdf urdf = make_calibrated_urdf(source, robot, errors);
    EXPECT_EQ(urdf.not_expressed.size(), 4U);
    const std::string path = folder.path("b.urdf");
    EXPECT_LT(write_calibrated_urdf(path, urdf, source, robot, errors).position, 1e-14);
    EXPECT_EQ(read_file(path), urdf.text);
    VectorXd others = errors;
    others[0] += 2e-9;
    EXPECT_EQ(input_error_of([&] {
                  write_calibrated_urdf(path, urdf, source, robot, others);
              }).rfind("b.urdf: is not written: read back, its flange is up to ", 0),
              0U);
    EXPECT_EQ(folder.file_count(), 2U);
}

}  // namespace
}  // namespace posewise::io
