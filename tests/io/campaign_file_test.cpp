#include "posewise/io/campaign_file.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "campaign_text.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaign_from.hpp"
#include "support/places.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using testing::campaign_from;
using testing::campaign_text;
using testing::input_error_of;
using testing::replaced;
using testing::TemporaryFolder;
constexpr double pi = std::numbers::pi;

TEST(ReadCampaign, TakesJointsWithLimitsInAnyUnit) {
    const Chain robot = campaign_from(campaign_text).robot;
    ASSERT_EQ(robot.joint_count(), 3);
    EXPECT_EQ(robot.joints()[0].name, "q1");
    EXPECT_DOUBLE_EQ(robot.joints()[0].upper, pi / 2);
    EXPECT_EQ(robot.joints()[1].upper, 1.5);
    EXPECT_EQ(robot.joints()[2].upper, 0.5);
    EXPECT_EQ(robot.joint(2).motion, Motion::Translation);
}

TEST(ReadCampaign, TakesElementsWithSignsOffsetsAndCoupling) {
    const std::vector<Element> elements = campaign_from(campaign_text).robot.elements();
    ASSERT_EQ(elements.size(), 6U);
    EXPECT_EQ(elements[2].value, 0.312);
    EXPECT_EQ(elements[2].parameter, "Tx1");
    const Element& coupled = elements[3];
    EXPECT_EQ(coupled.motion, Motion::Rotation);
    EXPECT_EQ(coupled.axis, Axis::Y);
    EXPECT_DOUBLE_EQ(coupled.value, pi / 2);
    ASSERT_EQ(coupled.joints.size(), 2U);
    EXPECT_EQ(coupled.joints[0].joint, 1);
    EXPECT_EQ(coupled.joints[0].coefficient, -1);
    EXPECT_EQ(coupled.joints[1].joint, 0);
    EXPECT_EQ(coupled.joints[1].coefficient, 0.5);
    EXPECT_EQ(elements[5].value, -1.5);
    EXPECT_EQ(elements[5].parameter, "");
}

TEST(ReadCampaign, DoesNotMindBlanksInElements) {
    const auto text = replaced(campaign_text, "Ry -q2 + 0.5*q1 + 90 deg [dq2]",
                               "'  Ry - q2+0.5 * q1+90deg[ dq2 ] '");
    const Element spaced = campaign_from(text).robot.elements()[3];
    const Element plain = campaign_from(campaign_text).robot.elements()[3];
    EXPECT_EQ(spaced.value, plain.value);
    EXPECT_EQ(spaced.parameter, plain.parameter);
    ASSERT_EQ(spaced.joints.size(), plain.joints.size());
    for (std::size_t k = 0; k < plain.joints.size(); ++k) {
        EXPECT_EQ(spaced.joints[k].joint, plain.joints[k].joint);
        EXPECT_EQ(spaced.joints[k].coefficient, plain.joints[k].coefficient);
    }
}

TEST(ReadCampaign, TakesErrorsThatDependOnTheConfiguration) {
    const Chain robot =
        campaign_from(
            replaced(campaign_text, "90 deg [dq2]",
                     "90 deg [dq2] [k1 * sin(q2)] [k2*cos(2*q1 - q2 + 30 deg)] [ratio*0.5*q2] "
                     "[coupling*(q1-q2)]"))
            .robot;
    EXPECT_EQ(robot.parameter_names(), (std::vector<std::string>{"dq1", "Tx1", "dq2", "k1", "k2",
                                                                 "ratio", "coupling", "Ty2"}));
    VectorXd errors = VectorXd::Zero(8), same = errors;
    errors.segment<4>(3) << 0.1, 0.2, 0.3, 0.4;
    const Vector3d q(0.3, -0.5, 0.1);
    same[2] = 0.1 * std::sin(-0.5) + 0.2 * std::cos(1.1 + pi / 6) + 0.3 * 0.5 * -0.5 + 0.4 * 0.8;
    EXPECT_TRUE(robot.base_from_flange(q, errors).isApprox(robot.base_from_flange(q, same), 1e-14));
    EXPECT_EQ(robot.parameter_term(3)->kind, TermKind::Free);
}

/// The crane with its second joint level, and these keys beside its elements.
CampaignFile read_level(const std::string& keys, const std::string& spread = "length_mm: 2") {
    auto text = replaced(campaign_text, "Ry -q2 + 0.5*q1", "Ry -q2");
    text = replaced(text, "length_mm: 2", spread);
    return campaign_from(replaced(text, "  elements:\n", keys + "  elements:\n"));
}

TEST(ReadCampaign, TakesGravityAndHarmonics) {
    const CampaignFile file =
        read_level("  gravity: true\n  harmonics: {orders: [2, 40.5], joints: [q1]}\n",
                   "gravity_mrad: 0.7, harmonic_mrad: 0.2");
    const auto names = parameter_names(file);
    const VectorXd scale = parameter_scale(file);
    const auto size_of = [&](const std::string& name) {
        return scale[std::find(names.begin(), names.end(), name) - names.begin()];
    };
    EXPECT_EQ(file.robot.parameter_count(), 4 + 2 + 4);
    EXPECT_DOUBLE_EQ(size_of("q2.sin(q2)"), 0.7e-3);
    EXPECT_DOUBLE_EQ(size_of("q1.cos(40.5q1)"), 0.2e-3);
    EXPECT_DOUBLE_EQ(size_of("dq1"), 3e-3);
    EXPECT_EQ(read_level("  gravity: false\n").robot.parameter_count(), 4);
    EXPECT_EQ(read_level("  harmonics: {orders: [1]}\n").robot.parameter_count(), 4 + 4);
    const CampaignFile on_wall = read_level("  gravity: {direction: [0, 9.8, 0], joints: [q1]}\n");
    EXPECT_EQ(on_wall.robot.parameter_names()[1], "q1.sin(q1)");
    EXPECT_EQ(parameter_scale(on_wall)[7], 1e-3);
}

TEST(ReadCampaign, GivesASlideWithAPitchItsHarmonics) {
    const std::string text =
        replaced(campaign_text, "limits_mm: [0, 500]", "limits_mm: [0, 500], pitch_mm: 20");
    EXPECT_DOUBLE_EQ(campaign_from(text).robot.joint(2).pitch, 0.02);
    const auto count = [](const CampaignFile& file) { return file.robot.parameter_count(); };
    EXPECT_EQ(count(campaign_from(text)), 4) << "these are stated";
    const std::string harmonics = "  harmonics: {orders: [1, 3], joints: [lift]}\n  elements:\n";
    const CampaignFile some = campaign_from(replaced(text, "  elements:\n", harmonics));
    const auto names = some.robot.parameter_names();
    EXPECT_EQ(std::vector<std::string>(names.begin() + 1, names.begin() + 5),
              (std::vector<std::string>{"lift.sin(lift)", "lift.cos(lift)", "lift.sin(3lift)",
                                        "lift.cos(3lift)"}));

    const std::string unsized = replaced(text, ", parameters: {dq2: 0.5 mrad, Tx1: 4 mm}", "");
    const std::string full = replaced(unsized, "robot:\n", "robot:\n  errors: full\n");
    const CampaignFile file = campaign_from(full);
    EXPECT_EQ(count(file), count(campaign_from(replaced(full, ", pitch_mm: 20", ""))) + 4);
    const auto sizes = shared_sizes(file.spread, file.robot);
    const auto slide = std::ranges::find(sizes, "slide_harmonic", &SharedSize::key);
    ASSERT_NE(slide, sizes.end());
    EXPECT_EQ(slide->size, 8e-6);
    EXPECT_FALSE(slide->is_angle);
    EXPECT_EQ(slide->members.size(), 4U);
    const CampaignFile stated = campaign_from(
        replaced(full, "angle_mrad: 3",
                 "angle_mrad: 3, slide_harmonic_um: 5, parameters: {lift.cos(2lift): 20 um}"));
    const VectorXd scale = robot_error_sizes(stated.spread, stated.robot);
    EXPECT_EQ((scale.array() == 5e-6).count(), 3);
    EXPECT_EQ((scale.array() == 20e-6).count(), 1);
    const auto freed = [&](const std::string& errors) {
        return count(
            campaign_from(replaced(unsized, "robot:\n", "robot:\n  errors: " + errors + '\n')));
    };
    EXPECT_EQ(freed("[class:harmonics]"), 4 + 2 * 4);
    EXPECT_EQ(freed("[lift.sin(2lift)]"), 1);
}

TEST(ReadCampaign, TakesTiltsOfAxes) {
    const CampaignFile file =
        read_level("  axis_tilt: {orders: [1, 2], joints: [q1]}\n", "tilt_mrad: 0.02");
    EXPECT_EQ(file.robot.parameter_count(), 4 + 2 * 4);
    EXPECT_EQ((parameter_scale(file).array() == 0.02e-3).count(), 8);
    EXPECT_EQ(read_level("  axis_tilt: {orders: [1]}\n").spread.tilt, 0.05e-3);
}

TEST(ReadCampaign, ReducesGeometryBesideTerms) {
    auto text = campaign_text;
    for (const char* const name : {" [dq1]", " [Tx1]", " [dq2]", " [Ty2]"})
        text = replaced(text, name, "");
    text = replaced(text, ", parameters: {dq2: 0.5 mrad, Tx1: 4 mm}", "");
    text = replaced(text, "robot:\n", "robot:\n  errors: geometric\n");
    const CampaignFile geometric = campaign_from(text);
    const CampaignFile file =
        campaign_from(replaced(text, "  elements:\n", "  harmonics: {orders: [2]}\n  elements:\n"));
    EXPECT_EQ(file.error_model, ErrorModel::Complete);
    EXPECT_EQ(file.robot.parameter_count(), geometric.robot.parameter_count() + 4);
}

TEST(ReadCampaign, TakesOtherErrorModelsThanTheFileStates) {
    const TemporaryFolder folder;
    const auto read_models = [&](const std::string& text) {
        return read_campaign(folder.write("c.yaml", text),
                             {ErrorModel::Full, ErrorModel::Complete, ErrorModel::Stated});
    };
    const auto files = read_models(campaign_text);
    ASSERT_EQ(files.size(), 3u);
    const std::string unsized =
        replaced(campaign_text, ", parameters: {dq2: 0.5 mrad, Tx1: 4 mm}", "");
    for (const CampaignFile& file : files) {
        const std::string name(error_model_name(file.error_model));
        EXPECT_EQ(parse_error_model(name), file.error_model);
        const auto alone =
            campaign_from(replaced(unsized, "robot:\n", "robot:\n  errors: " + name + '\n'));
        EXPECT_EQ(parameter_names(file), parameter_names(alone)) << name;
        EXPECT_EQ(file.spread.is_prior, alone.spread.is_prior) << name;
    }
    EXPECT_EQ(files[2].spread.by_name.size(), 2u);
    EXPECT_NE(input_error_of([&] {
                  read_models(replaced(campaign_text, "{dq2:", "{dq7:"));
              }).find("'dq7' is no parameter of this campaign"),
              std::string::npos);
    EXPECT_THROW(parse_error_model("geometry"), InputError);
}

TEST(ReadCampaign, ExpectsErrorsOfTheRobotsClass) {
    const auto stated = replaced(
        replaced(campaign_text, "model_error_mm: 0.2\n", ""),
        "spread: {length_mm: 2, angle_mrad: 3, parameters: {dq2: 0.5 mrad, Tx1: 4 mm}}\n", "");
    const auto of_class = [&](const std::string& name) {
        return campaign_from(
            replaced(stated, "robot:", "robot:\n  errors: full\n  class: " + name));
    };
    const CampaignFile unknown = of_class("unknown");
    EXPECT_EQ(unknown.robot_class, RobotClass::Unknown);
    EXPECT_EQ(unknown.known_within.error_size, KnownWithin().error_size);
    double previous = 0;
    for (const std::string name : {"small", "industrial", "collaborative", "service"}) {
        const CampaignFile file = of_class(name);
        EXPECT_EQ(robot_class_name(file.robot_class), name);
        const Population expected = population_of(file.robot_class, file.declared_robot);
        EXPECT_GT(expected.model_error, previous) << name;
        previous = expected.model_error;
        EXPECT_EQ(file.model_error, expected.model_error) << name;
        EXPECT_EQ(file.spread.gravity, expected.spread.gravity) << name;
        EXPECT_EQ(file.spread.offset, expected.spread.offset) << name;
        EXPECT_LT(file.known_within.model_error, unknown.known_within.model_error) << name;
        EXPECT_LT(file.known_within.error_size, unknown.known_within.error_size) << name;
    }
    EXPECT_NE(input_error_of([&] { of_class("colaborative"); }).find("collaborative"),
              std::string::npos);
}

TEST(ReadCampaign, TakesSensorBaseSpreadAndDefaults) {
    const CampaignFile file = campaign_from(campaign_text);
    const Campaign& campaign = file;
    EXPECT_EQ(campaign.name, "crane");
    const auto& sensor = dynamic_cast<const PointSensor&>(*campaign.sensor);
    EXPECT_EQ(sensor.target_count(), 2);
    EXPECT_FALSE(sensor.targets().is_known(0));
    EXPECT_DOUBLE_EQ(sensor.sigma(), 5e-5);
    EXPECT_TRUE(campaign.has_nominal_targets);
    EXPECT_EQ(campaign.nominal.sensor[4], 0.2);
    EXPECT_TRUE(campaign.has_nominal_base);
    EXPECT_EQ(campaign.nominal.world_from_base.translation(), Vector3d(1, 0, -0.5));
    EXPECT_TRUE((campaign.nominal.world_from_base.linear() * Vector3d::UnitX())
                    .isApprox(Vector3d::UnitY()));
    EXPECT_EQ(campaign.model_error, 2e-4);
    EXPECT_EQ(campaign.spread.length, 2e-3);
    EXPECT_EQ(campaign.spread.angle, 3e-3);
    EXPECT_EQ(campaign.spread.by_name.at("dq2"), 5e-4);
    EXPECT_EQ(campaign.spread.by_name.at("Tx1"), 4e-3);
    EXPECT_EQ(file.criterion, Criterion::O3);
    EXPECT_EQ(file.seed, 7U);
    EXPECT_EQ(file.mat.joints, "q");
    EXPECT_EQ(file.mat.points, (std::vector<std::string>{"mA", "mB"}));
    EXPECT_DOUBLE_EQ(file.mat.angle_unit, pi / 180);
    EXPECT_EQ(file.mat.length_unit, 1e-3);
}

TEST(ReadCampaign, TurnsTheBaseAboutFixedAxesXThenYThenZ) {
    const auto text = replaced(campaign_text, "rpy_deg: [0, 0, 90]", "rpy_deg: [90, 0, 90]");
    const Matrix3d R = campaign_from(text).nominal.world_from_base.linear();
    EXPECT_TRUE((R * Vector3d::UnitY()).isApprox(Vector3d::UnitZ()));  // by roll; yaw leaves it
}

TEST(ReadCampaign, NeedsOnlyNameRobotAndSensor) {
    const auto end = campaign_text.find("model_error_mm");
    const CampaignFile file = campaign_from(replaced(
        campaign_text.substr(0, end), "position_mm: [[100, 0, 0], [0, 200, -10]]", "count: 3"));
    EXPECT_EQ(file.model_error, 1e-4);
    EXPECT_EQ(file.spread.length, 1e-3);
    EXPECT_EQ(file.criterion, Criterion::V);
    EXPECT_EQ(file.seed, 1U);
    EXPECT_FALSE(file.has_nominal_base);
    EXPECT_FALSE(file.has_nominal_targets);
    ASSERT_EQ(file.nominal.sensor.size(), 9);
    const Vector3d a = file.nominal.sensor.segment<3>(0);
    const Vector3d b = file.nominal.sensor.segment<3>(3);
    const Vector3d c = file.nominal.sensor.segment<3>(6);
    EXPECT_GT((b - a).cross(c - a).norm(), 0.01);  // not in line
}

TEST(ReadCampaign, TakesKnownTargets) {
    const auto text = replaced(campaign_text, "-10]]}", "-10]], known: true}");
    const Campaign campaign = campaign_from(text);
    EXPECT_EQ(campaign.nominal.sensor.size(), 0);
    const auto& sensor = dynamic_cast<const PointSensor&>(*campaign.sensor);
    EXPECT_EQ(sensor.target_position(1, VectorXd()), Vector3d(0, 0.2, -0.01));
}

TEST(ReadCampaign, TakesTheFullErrorModelWithTheSizesThatErrorsHave) {
    const std::string text =
        R"(name: arm
robot:
  errors: full
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}, q3: {limits_deg: [-90, 90]}}
  elements: [Rz q1, Tz 0.3 m, Ry q2, Tz 0.5 m, Ry q3, Tx 0.4 m]
sensor: {kind: points, sigma_mm: 0.1, targets: {count: 3}}
)";
    const CampaignFile file = campaign_from(text);
    EXPECT_EQ(file.error_model, ErrorModel::Full);
    EXPECT_TRUE(file.spread.is_prior);
    const auto names = parameter_names(file);
    const VectorXd scale = parameter_scale(file);
    const auto size_of = [&](const std::string& name) {
        const auto found = std::find(names.begin(), names.end(), name);
        return found == names.end() ? -1 : scale[found - names.begin()];
    };
    EXPECT_EQ(size_of("dq2"), 20e-3);
    EXPECT_EQ(size_of("Rx2"), 0.7e-3);
    EXPECT_EQ(size_of("q2.torque(q3)"), 0.7e-3);
    EXPECT_EQ(size_of("q3.cos(2q3)"), 0.15e-3);
    EXPECT_NEAR(size_of("Tx1"), 4e-4 * extent(file.declared_robot), 1e-15);
    EXPECT_EQ(size_of("q1.torque(q2)"), -1);

    const CampaignFile stated =
        campaign_from(text + "spread: {offset_mrad: 2, gravity_mrad: 3}\nprior: false\n");
    EXPECT_EQ(*stated.spread.offset, 2e-3);
    EXPECT_EQ(stated.spread.gravity, 3e-3);
    EXPECT_EQ(stated.spread.harmonic, 0.15e-3);
    EXPECT_FALSE(stated.spread.is_prior);
    EXPECT_TRUE(find_identifiable(stated).dropped.empty());  // without priors it is reduced
    EXPECT_LT(stated.robot.parameter_count(), file.robot.parameter_count());

    const CampaignFile unsaid = campaign_from(replaced(text, "  errors: full\n", ""));
    EXPECT_EQ(unsaid.error_model, ErrorModel::Full);
    EXPECT_EQ(campaign_from(text + "model_error_mm: auto\n").model_error, unsaid.model_error);
    EXPECT_FALSE(unsaid.model_error_common);
    EXPECT_EQ(campaign_from(text + "model_error_common: 0.9\n").model_error_common, 0.9);
    EXPECT_EQ(unsaid.robot.parameter_names(), file.robot.parameter_names());

    const CampaignFile on_wall = campaign_from(
        replaced(text, "errors: full", "errors: full\n  gravity: {direction: [1, 0, 0]}"));
    const std::string of_one = "errors: full\n  gravity: {joints: [q2]}";
    EXPECT_NE(input_error_of([&] {
                  campaign_from(replaced(text, "errors: full", of_one));
              }).find("campaign.yaml:4:21: robot.gravity.joints is stated, but errors: full has"),
              std::string::npos);
    const auto has_torque_of_q1 = on_wall.robot.parameter_names();
    EXPECT_TRUE(std::any_of(has_torque_of_q1.begin(), has_torque_of_q1.end(),
                            [](const auto& n) { return n.starts_with("q1.torque("); }));
}

TEST(PlannedCampaign, HasTheErrorsToPlanWithWhichAreNoFewer) {
    const TemporaryFolder folder;
    const auto path =
        folder.write("c.yaml", std::string(campaign_text) + "\nplanning: {errors: full}\n");
    EXPECT_EQ(read_campaign(path).error_model, ErrorModel::Stated);
    const CampaignFile planned = planned_campaign(read_campaign(path));
    EXPECT_EQ(planned.error_model, ErrorModel::Full);
    EXPECT_TRUE(planned.spread.is_prior);
    EXPECT_EQ(planned_campaign(read_campaign(folder.write("d.yaml", campaign_text))).error_model,
              ErrorModel::Stated);
    const std::string poorer =
        replaced(campaign_text, "robot:\n", "planning: {errors: stated}\nrobot:\n  errors: full\n");
    EXPECT_NE(input_error_of([&] { campaign_from(poorer); }).find("poorer than robot.errors"),
              std::string::npos);
}

TEST(ReadCampaign, HasTheStatedErrorsIfAnyIsStated) {
    const CampaignFile file = campaign_from(campaign_text);
    EXPECT_EQ(file.error_model, ErrorModel::Stated);
    EXPECT_EQ(file.robot.parameter_names(), (std::vector<std::string>{"dq1", "Tx1", "dq2", "Ty2"}));
    EXPECT_EQ(file.nominal.robot, VectorXd::Zero(4));
}

TEST(ReadCampaign, ReducesTheCompleteErrorsToAnIrreducibleSet) {
    const auto text =
        R"(name: pan-tilt
robot:
  errors: geometric
  joints: {q1: {limits_deg: [-90, 90]}, q2: {limits_deg: [-90, 90]}}
  elements: [Rz q1, Tx 1 m, Tz 0.1 m, Ry q2, Tx 0.8 m]
sensor: {kind: points, sigma_mm: 0.1, targets: {count: 3}}
)";
    const CampaignFile file = campaign_from(text);
    EXPECT_EQ(file.error_model, ErrorModel::Complete);
    EXPECT_EQ(file.declared_robot.parameter_count(), 0);
    // 4R + 2P + 3n of all, of which base 6 and targets 9.
    EXPECT_EQ(file.robot.parameter_count(), 4 * 2 + 9 - 6 - 9);
    EXPECT_EQ(file.nominal.robot.size(), file.robot.parameter_count());
}

TEST(ReadCampaign, ReadsTheFanucDesigns) {
    const std::string folder = source_folder() + "/designs/fanuc_r2000ic_165f/";
    const CampaignFile file = read_campaign(folder + "campaign.yaml");
    EXPECT_EQ(file.robot.parameter_count(), 18);
    EXPECT_EQ(find_identifiable(file).dropped.size(), 0U);
    const CampaignFile seed_report = read_campaign(folder + "seed_report.yaml");
    EXPECT_EQ(seed_report.robot.parameter_count(), 18);
    EXPECT_EQ(find_identifiable(seed_report).dropped.size(), 1U);
}

TEST(ReadCampaign, FindsAsManyErrorsInTheFanucAsItsDesignStates) {
    const TemporaryFolder folder;
    const std::string path = source_folder() + "/designs/fanuc_r2000ic_165f/campaign.yaml";
    std::ifstream in(path);
    const std::string text(std::istreambuf_iterator<char>(in), {});
    const auto complete = replaced(text, "  elements:", "  errors: complete\n  elements:");
    EXPECT_EQ(campaign_from(complete).robot.parameter_count(), 18);
}

}  // namespace
}  // namespace posewise::io
