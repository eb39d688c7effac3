#include <gtest/gtest.h>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "campaign_text.hpp"
#include "lift_urdf.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/robots.hpp"
#include "support/sweep.hpp"
#include "support/temporary_folder.hpp"
#include "support/urdf_text.hpp"

namespace posewise::io {
namespace {

using namespace detail;
using namespace testing;

/// Joints with random origins and axes, every third fixed, the last one as asked for.
std::string random_urdf(RandomStream& stream, bool is_last_fixed) {
    std::vector<JointText> joints;
    for (int j = 0; j < 9; ++j) {
        const bool is_fixed = j == 8 ? is_last_fixed : j % 3 == 1;
        const bool slides = stream.uniform(0, 1) < 0.3;
        Vector3d axis = random_vector(stream, 3, 1);
        if (j % 2 == 0) axis = -Vector3d::Unit(j % 3);
        std::string origin = "xyz=\"" + vector_text(random_vector(stream, 3, 1)) + "\" rpy=\"" +
                             vector_text(random_vector(stream, 3, 3)) + '"';
        if (j == 3) origin = "rpy='0 1.5707963267948966 0'";
        if (j == 5) origin = "";
        joints.push_back({is_fixed ? "fixed"
                          : slides ? "prismatic"
                                   : "revolute",
                          origin, is_fixed ? "" : vector_text(axis)});
    }
    return urdf_text(joints);
}

double distance(const Isometry3d& a, const Isometry3d& b) {
    return (a.matrix() - b.matrix()).cwiseAbs().maxCoeff();
}

/// Largest difference of the tip's pose over random configurations.
double difference(const Chain& a, const VectorXd& parameters_a, const Chain& b,
                  const VectorXd& parameters_b) {
    double largest = 0;
    const RowMatrixXd configurations = random_configurations(a, 20, 5);
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        largest = std::max(largest, distance(a.base_from_flange(q, parameters_a),
                                             b.base_from_flange(q, parameters_b)));
    }
    return largest;
}

struct Exported {
    std::string before;
    CalibratedUrdf urdf;
    Chain robot;  ///< with error parameters
    Chain again;  ///< of the exported file
};

Exported export_with(const std::string& text, const VectorXd& parameters) {
    const TemporaryFolder folder;
    const UrdfSource source{folder.write("robot.urdf", text), "", ""};
    Exported result;
    result.before = text;
    result.robot = complete_model(make_chain(read_urdf(source)));
    result.urdf = make_calibrated_urdf(
        source, result.robot,
        parameters.head(std::min(parameters.size(), result.robot.parameter_count())));
    result.again =
        make_chain(read_urdf({folder.write("calibrated.urdf", result.urdf.text), "", ""}));
    return result;
}

TEST(CalibratedUrdf, PredictsAsTheErrorModelDoes) {
    RandomStream stream(21);
    for (Index i = 0; i < sweep_count() / 10; ++i) {
        const VectorXd parameters = random_vector(stream, 30, i % 2 == 0 ? 1e-3 : 0.3);
        const Exported exported = export_with(random_urdf(stream, true), parameters);
        ASSERT_EQ(exported.robot.parameter_count(), 25);
        EXPECT_LT(difference(exported.robot, parameters.head(25), exported.again, VectorXd()),
                  1e-12)
            << i;
        EXPECT_TRUE(exported.urdf.not_expressed.empty());
        EXPECT_EQ(exported.urdf.changes.size(), 6U) << "five that move and the first behind them";
    }
}

TEST(CalibratedUrdf, PredictsAsTheErrorModelOfAMimicDoes) {
    RandomStream stream(24);
    const std::string axes[] = {"0 0 1", "0.3 -1 0.2", "1 0 0"};
    std::vector<JointText> joints;
    for (const std::string& axis : axes) joints.push_back({"revolute", "xyz=\"0.3 0.1 0\"", axis});
    joints.push_back({"fixed", "xyz=\"0 0 0.1\"", ""});
    std::string text = urdf_text(joints);
    const std::string second = "    <axis xyz=\"" + axes[1] + "\"/>\n";
    ASSERT_NE(text.find(second), std::string::npos);
    text.insert(text.find(second),
                "    <mimic joint=\"q1\" multiplier=\"-0.7\" offset=\"0.4\"/>\n");
    for (int i = 0; i < 20; ++i) {
        const VectorXd parameters = random_vector(stream, 30, 0.1);
        const Exported exported = export_with(text, parameters);
        ASSERT_EQ(exported.robot.joint_count(), 2);
        const Index count = exported.robot.parameter_count();
        EXPECT_LT(difference(exported.robot, parameters.head(count), exported.again, VectorXd()),
                  1e-12)
            << i;
    }
}

TEST(CalibratedUrdf, OfNoErrorsIsTheFileItself) {
    RandomStream stream(22);
    const std::string text = random_urdf(stream, false);
    const Exported exported = export_with(text, VectorXd::Zero(30));
    EXPECT_EQ(exported.urdf.text, text);
    EXPECT_TRUE(exported.urdf.changes.empty());
}

TEST(CalibratedUrdf, SaysWhatItCannotExpress) {
    RandomStream stream(23);
    VectorXd parameters = random_vector(stream, 30, 1e-3);
    const std::string text = random_urdf(stream, false);
    const Exported exported = export_with(text, parameters);
    const Index count = exported.robot.parameter_count();
    ASSERT_EQ(count, 30);
    const auto names = exported.robot.parameter_names();
    EXPECT_EQ(exported.urdf.not_expressed, std::vector<std::string>(names.end() - 4, names.end()));
    parameters.tail<4>().setZero();
    EXPECT_TRUE(export_with(text, parameters).urdf.not_expressed.empty());
    EXPECT_LT(difference(exported.robot, parameters, exported.again, VectorXd()), 1e-12)
        << "all else is expressed";
}

/// A rail with a wrist, measured: what the calibrated file predicts of every point is what the
/// estimate predicts, and the estimate is read back as it was.
TEST(CalibratedUrdf, PredictsTheMeasuredPointsAsTheEstimateDoes) {
    const TemporaryFolder folder;
    const std::string rpy = " rpy=\"1.5708 0.2 -0.4\"";
    folder.write("robot.urdf", urdf_text({{"prismatic", "", "0 1 0"},
                                          {"revolute", "xyz=\"0.2 0 0.4\"" + rpy, "0 0 1"},
                                          {"fixed", "xyz=\"0 0 0.3\"" + rpy, ""},
                                          {"revolute", "xyz=\"0.5 0 0\"", "0 1 0"},
                                          {"revolute", "xyz=\"0.4 0 0.1\"" + rpy, "0.3 0 -1"},
                                          {"revolute", "xyz=\"0.1 0 0\"", "1 0 0"}}));
    const std::string text =
        "name: rail\nrobot: {errors: geometric, urdf: robot.urdf, base_link: link0, tip_link: "
        "link6}\n"
        "base: {position_mm: [2000, 500, -300], rpy_deg: [10, 20, 130]}\n"
        "sensor: {kind: points, sigma_mm: 0.05, targets: {position_mm: [[100, 0, 50], [0, 100, "
        "50], "
        "[-80, -80, 60]]}}\n";
    const CampaignFile file = read_campaign(folder.write("campaign.yaml", text));
    const Simulation simulation = simulate(file, {30, 1, 4, 9});
    const Measurements& measurements = simulation.measurements;
    const Calibration calibration = calibrate(file, measurements, {.folds = 0});
    ASSERT_EQ(calibration.estimate.ending, Ending::Converged);
    write_estimate(folder.path("estimate.json"), calibration, {"simulated"});
    const Parameters parameters = read_estimate(folder.path("estimate.json"), file).parameters;
    const CalibratedUrdf urdf = make_calibrated_urdf(*file.urdf, file.robot, parameters.robot);
    EXPECT_TRUE(urdf.not_expressed.empty());

    folder.write("calibrated.urdf", urdf.text);
    const std::string plain = replaced(text, "robot: {errors: geometric, urdf: robot",
                                       "robot: {errors: stated, urdf: calibrated");
    const Campaign calibrated = read_campaign(folder.write("again.yaml", plain));
    ASSERT_EQ(calibrated.robot.parameter_count(), 0);
    Parameters same = parameters;
    same.robot.resize(0);
    const RowMatrixXd expected = residuals(file, calibration.estimate.parameters, measurements);
    EXPECT_LT((residuals(calibrated, same, measurements) - expected).cwiseAbs().maxCoeff(), 1e-12);
    EXPECT_GT((residuals(file, file.nominal, measurements) - expected).norm(), 1e-3)
        << "there was something to calibrate";
}

/// Everything but the origins of the joints on the way, byte by byte.
TEST(CalibratedUrdf, KeepsEveryOtherByte) {
    const std::string head =
        "\xEF\xBB\xBF<?xml version='1.0' encoding=\"utf-8\"?>\r\n<!-- <origin xyz=\"9\"> -->\n"
        "<robot  name='a &amp; b'\n  xmlns:x=\"y\"><link name='base'/>\t<link name='tip'/>"
        "<gazebo><![CDATA[ <joint> > ]]></gazebo>\n"
        "<transmission name='t'><joint name='turn'/></transmission>\n";
    const std::string joint_head =
        "<joint name='turn' type='revolute'>  <!-- here --> <parent link='base'/>"
        "<child link='tip'/><origin ";
    const std::string joint_tail =
        " /><axis xyz='0 0 1'/><limit lower='-1' upper='1'/></joint>\n\n</robot>\n<!-- end -->";
    const TemporaryFolder folder;
    const UrdfSource source{
        folder.write("a.urdf", head + joint_head + "rpy = '0 0 0.5'  xyz='1 2 3'" + joint_tail), "",
        ""};
    std::vector<Element> elements = make_chain(read_urdf(source)).elements();
    elements.front().parameter = "Tx0";
    const Chain robot({{"turn", -1, 1}}, elements);
    const auto urdf = make_calibrated_urdf(source, robot, VectorXd::Constant(1, 0.25));
    EXPECT_EQ(urdf.text, head + joint_head + "rpy = '0 0 0.5'  xyz='1.25 2 3'" + joint_tail);
    ASSERT_EQ(urdf.changes.size(), 1U);
    EXPECT_EQ(urdf.changes[0].joint, "turn");
    EXPECT_NEAR(urdf.changes[0].translation, 0.25, 1e-15);
    EXPECT_EQ(urdf.changes[0].rotation, 0);
}

TEST(CalibratedUrdf, PutsInOriginsThatWereNotThere) {
    const TemporaryFolder folder;
    const std::string text =
        urdf_text({{"revolute", "", "0 0 1"}, {"revolute", "xyz='0 0 1'", "1 0 0"}});
    const UrdfSource source{folder.write("a.urdf", text), "", ""};
    const auto chain = make_chain(read_urdf(source));
    std::vector<Element> elements = chain.elements();
    elements.insert(elements.begin(), {Motion::Translation, Axis::Y, 0, {}, "Ty0"});
    elements.back().parameter = "dq2";
    const Chain robot(chain.joints(), elements);
    const auto urdf = make_calibrated_urdf(source, robot, Eigen::Vector2d(0.5, 0.25));
    const std::string expected =
        replaced(replaced(text, "type=\"revolute\">\n",
                          "type=\"revolute\">\n    <origin xyz=\"0 0.5 0\"/>\n"),
                 "<origin xyz='0 0 1'/>", "<origin rpy=\"0.25 0 0\" xyz='0 0 1'/>");
    EXPECT_EQ(urdf.text, expected);
}

TEST(CalibratedUrdf, LeavesOutAndNamesTermsThatDependOnTheConfiguration) {
    const TemporaryFolder folder;
    const std::string text = urdf_text({{"revolute", "", "0 0 1"},
                                        {"revolute", "xyz='0 0 1'", "1 0 0"},
                                        {"fixed", "xyz='0 0 0.5'", ""}});
    const UrdfSource source{folder.write("a.urdf", text), "", ""};
    const Chain geometric = complete_model(make_chain(read_urdf(source)));
    const Chain robot = with_harmonics(geometric, {1});
    ASSERT_EQ(robot.parameter_count(), 10 + 4);
    RandomStream stream(24);
    VectorXd errors = random_vector(stream, 14, 1e-2);
    errors[1] = 0;  // of the four terms: behind dq1 and dq2 each two
    VectorXd constant(10);
    constant << errors[0], errors.segment(3, 5), errors.segment(10, 4);
    const auto expected = make_calibrated_urdf(source, geometric, constant);
    const auto urdf = make_calibrated_urdf(source, robot, errors);
    EXPECT_EQ(urdf.text, expected.text);
    const auto names = robot.parameter_names();
    EXPECT_EQ(urdf.terms, (std::vector<std::string>{names[2], names[8], names[9]}));
    EXPECT_TRUE(urdf.not_expressed.empty());
    EXPECT_TRUE(expected.terms.empty());
}

/// What a slide bends by and its drive's errors are left out; its geometry is the same without
/// them.
TEST(CalibratedUrdf, HasTheGeometryOfASlideThatBends) {
    const TemporaryFolder folder;
    const UrdfSource source{folder.write("a.urdf", lift_urdf), "base", "tool"};
    const Chain chain = with_pitch(make_chain(read_urdf(source)), 0, 0.02);
    const Chain full = full_model(chain);
    const Chain geometric = complete_model(chain);
    const Chain written = without_terms(full);
    ASSERT_EQ(written.parameter_names(), geometric.parameter_names());
    RandomStream stream(25);
    const VectorXd errors = random_vector(stream, written.parameter_count(), 1e-3);
    EXPECT_EQ(make_calibrated_urdf(source, written, errors).text,
              make_calibrated_urdf(source, geometric, errors).text);
    const auto terms = active_terms(full, VectorXd::Ones(full.parameter_count()));
    for (const char* const term : {"lift.sin(lift)", "lift.cos(2lift)", "lift.scale"}) {
        EXPECT_NE(std::ranges::find(terms, term), terms.end()) << term;
    }
}

TEST(CalibratedUrdf, IsOfTheRobotItself) {
    const TemporaryFolder folder;
    const UrdfSource source{folder.write("a.urdf", urdf_text({{"revolute", "", "0 0 1"}})), "", ""};
    const Chain other({{"a", 0, 1}, {"b", 0, 1}}, {{Motion::Rotation, Axis::Z, 0, {{0, 1.0}}, ""},
                                                   {Motion::Rotation, Axis::X, 0, {{1, 1.0}}, ""}});
    EXPECT_EQ(input_error_of([&] { make_calibrated_urdf(source, other, VectorXd()); }),
              "a.urdf: has 1 joints that move, the robot 2; must be the URDF the robot was made "
              "from");
}

}  // namespace
}  // namespace posewise::io
