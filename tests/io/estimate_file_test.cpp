#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "../../src/io/format/atomic_file.hpp"
#include "campaign_text.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/result_files.hpp"
#include "support/temporary_folder.hpp"

namespace posewise::io {
namespace {

using namespace detail;

using Json = nlohmann::json;

/// The crane's estimate with round numbers: parameter k is off by k / 3 mm or mrad.
class EstimateFile : public ::testing::Test {
  protected:
    EstimateFile() {
        campaign_ = read_campaign(folder_.write("c.yaml", testing::campaign_text));
        Estimate& estimate = calibration_.estimate;
        const Index count = parameter_count(campaign_);
        estimate.ending = Ending::Converged;
        estimate.names = parameter_names(campaign_);
        estimate.parameters =
            advance(campaign_, campaign_.nominal,
                    1e-3 / 3 * VectorXd::LinSpaced(count, 0, static_cast<double>(count - 1)));
        estimate.covariance = 1e-8 * MatrixXd::Identity(count, count);
        estimate.covariance(0, 1) = estimate.covariance(1, 0) = -0.9e-8;
        estimate.fit.distance_rms = 1.5e-4;
        estimate.fit.coordinate_max = {1e-3, 2e-3, 3e-3};
    }

    Json written() const {
        Calibration calibration = calibration_;
        calibration.campaign = campaign_;
        write_estimate(path_, calibration, {"m.csv"});
        return Json::parse(read_file(path_));
    }

    testing::TemporaryFolder folder_;
    std::string path_ = folder_.path("estimate.json");
    Campaign campaign_;
    Calibration calibration_;
};

TEST_F(EstimateFile, GivesEachRobotParameterWithItsUnitAndSigma) {
    const Json robot = written().at("robot");
    EXPECT_EQ(robot.size(), 4U);
    const VectorXd& values = calibration_.estimate.parameters.robot;
    EXPECT_EQ(robot.at("dq1").at("value_rad").get<double>(), values[0]);
    EXPECT_EQ(robot.at("Tx1").at("value_m").get<double>(), values[1]);
    EXPECT_EQ(robot.at("Ty2").at("value_m").get<double>(), values[3]);
    EXPECT_DOUBLE_EQ(robot.at("dq2").at("sigma_rad").get<double>(), 1e-4);
}

TEST_F(EstimateFile, GivesTheBaseThreeWaysThatAgree) {
    const Json base = written().at("base");
    const Isometry3d& expected = calibration_.estimate.parameters.world_from_base;
    const auto p = base.at("position_m").get<std::vector<double>>();
    EXPECT_EQ(Vector3d(p[0], p[1], p[2]), expected.translation());
    const auto q = base.at("quaternion_wxyz").get<std::vector<double>>();
    EXPECT_TRUE(Eigen::Quaterniond(q[0], q[1], q[2], q[3])
                    .toRotationMatrix()
                    .isApprox(expected.linear(), 1e-14));
    const auto rpy = base.at("rpy_deg").get<std::vector<double>>();
    const auto text = testing::replaced(testing::campaign_text, "[0, 0, 90]",
                                        Json(rpy).dump());  // as the campaign file takes it
    const Campaign again = read_campaign(folder_.write("again.yaml", text));
    EXPECT_TRUE(again.nominal.world_from_base.linear().isApprox(expected.linear(), 1e-12));
}

TEST_F(EstimateFile, GivesTheTargetsByName) {
    const Json target = written().at("targets").at("target2");
    const auto p = target.at("position_m").get<std::vector<double>>();
    EXPECT_EQ(Vector3d(p[0], p[1], p[2]), calibration_.estimate.parameters.sensor.tail(3));
    EXPECT_FALSE(target.at("known").get<bool>());
    EXPECT_DOUBLE_EQ(written().at("sigma").at("target2.z_m").get<double>(), 1e-4);
}

TEST_F(EstimateFile, GivesAccuracyInMillimetres) {
    const Json fit = written().at("accuracy").at("fit");
    EXPECT_DOUBLE_EQ(fit.at("distance_rms_mm").get<double>(), 0.15);
    EXPECT_DOUBLE_EQ(fit.at("coordinate_max_mm").at("z").get<double>(), 3);
}

TEST_F(EstimateFile, LeavesOutWhatWasNotComputed) {
    EXPECT_FALSE(written().at("accuracy").contains("held_out"));
    EXPECT_FALSE(written().at("accuracy").contains("repeatability_mm"));
    EXPECT_FALSE(written().at("accuracy").contains("left_out"));
    calibration_.repeatability = Repeatability{5e-5};
    calibration_.held_out = CrossValidation{};
    calibration_.held_out->failures = {"fold 3: too few", "fold 4: too few"};
    calibration_.left_out = Judgement{};
    calibration_.validation = Judgement{};
    const Json accuracy = written().at("accuracy");
    EXPECT_DOUBLE_EQ(accuracy.at("repeatability_mm").get<double>(), 0.05);
    EXPECT_EQ(accuracy.at("held_out").at("failures").size(), 2U);
    EXPECT_TRUE(accuracy.contains("left_out"));
    EXPECT_TRUE(accuracy.contains("validation"));
}

TEST_F(EstimateFile, ListsOutliersOfARobustLossOnly) {
    EXPECT_FALSE(written().contains("loss"));
    EXPECT_FALSE(written().contains("outliers"));
    calibration_.estimate.loss = {LossKind::Huber, 1.5};
    EXPECT_EQ(written().at("outliers"), Json::array());
    calibration_.estimate.outliers = {{4, "e", 1, 2e-3, 12, 0.25}};
    calibration_.without_outliers = WithoutOutliers{1e-4, std::nullopt};
    const Json document = written();
    EXPECT_EQ(document.at("loss"), (Json{{"kind", "huber"}, {"width_standard_deviations", 1.5}}));
    EXPECT_EQ(document.at("outliers").at(0), (Json{{"configuration", "e"},
                                                   {"target", "target2"},
                                                   {"distance_mm", 2.0},
                                                   {"standard_deviations", 12.0},
                                                   {"weight", 0.25}}));
    EXPECT_DOUBLE_EQ(
        document.at("accuracy").at("without_outliers").at("fit_means_rms_mm").get<double>(), 0.1);
}

TEST_F(EstimateFile, GivesTheParameterSetsCompared) {
    EXPECT_FALSE(written().contains("model_selection"));
    calibration_.selection = ModelSelection{5, {}, -1, -1, {}};
    calibration_.selection->trials = {{{"base and targets", {}}, 15, 6e-4, 7e-4, 9e-5},
                                      {{"+ lengths", {"Tx1"}}, 16, 0, 0, 0, "too few"}};
    EXPECT_FALSE(written().at("model_selection").contains("recommended"));
    calibration_.selection->best = calibration_.selection->recommended = 0;
    const Json selection = written().at("model_selection");
    EXPECT_EQ(selection.at("recommended"), "base and targets");
    const Json& first = selection.at("sets").at(0);
    EXPECT_DOUBLE_EQ(first.at("held_out_rms_mm").get<double>(), 0.7);
    EXPECT_DOUBLE_EQ(first.at("standard_error_mm").get<double>(), 0.09);
    const Json& second = selection.at("sets").at(1);
    EXPECT_EQ(second.at("failure"), "too few");
    EXPECT_EQ(second.at("parameters"), Json{"Tx1"});
    EXPECT_FALSE(second.contains("fit_rms_mm"));
}

TEST_F(EstimateFile, NamesTheStrongestCorrelation) {
    const Json strongest = written().at("strongest_correlations").at(0);
    EXPECT_EQ(strongest.at("first"), "base.x");
    EXPECT_EQ(strongest.at("second"), "base.y");
    EXPECT_NEAR(strongest.at("coefficient").get<double>(), -0.9, 1e-12);
}

TEST_F(EstimateFile, HasTheSameBytesForTheSameEstimate) {
    written();
    const std::string first = read_file(path_);
    written();
    EXPECT_EQ(read_file(path_), first);
}

TEST_F(EstimateFile, IsReadBackExactly) {
    written();
    const Estimate estimate = read_estimate(path_, campaign_);
    const Parameters& parameters = estimate.parameters;
    const Parameters& expected = calibration_.estimate.parameters;
    EXPECT_EQ(parameters.robot, expected.robot);
    EXPECT_EQ(parameters.sensor, expected.sensor);
    EXPECT_EQ(parameters.world_from_base.translation(), expected.world_from_base.translation());
    EXPECT_TRUE(parameters.world_from_base.isApprox(expected.world_from_base, 1e-15));
}

TEST_F(EstimateFile, IsRefusedInAFormatThatIsNotKnown) {
    Json document = written();
    const auto error = [&] {
        folder_.write("estimate.json", document.dump());
        return testing::input_error_of([&] { read_estimate(path_, campaign_); });
    };
    for (const int format : {0, 2}) {
        document["format"] = format;
        EXPECT_EQ(error(), "estimate.json: format: is " + std::to_string(format) +
                               "; this posewise reads 1: make the estimate again with it");
    }
    document["format"] = "1";
    EXPECT_NE(error().find("format: "), std::string::npos);
    document.erase("format");
    EXPECT_EQ(error(), "estimate.json: has no key format; must be 1, as posewise writes it");
}

TEST_F(EstimateFile, IsReadAsAnEarlierOneWithTheSizesLearned) {
    calibration_.stated_spread = campaign_.spread;
    Campaign stated = campaign_;
    campaign_.spread.length = 2.5e-3;
    Json document = written();
    folder_.write("estimate.json", document.dump());
    const EarlierFile earlier = read_earlier(path_, stated, {.is_prior = true});
    EXPECT_TRUE(earlier.use.is_prior);
    ASSERT_TRUE(earlier.estimate.spread);
    EXPECT_EQ(earlier.estimate.spread->length, 2.5e-3);
    EXPECT_EQ(earlier.estimate.spread->angle, stated.spread.angle);
    EXPECT_EQ(earlier.estimate.covariance, calibration_.estimate.covariance);
    EXPECT_TRUE(earlier.changes.empty()) << earlier.changes.front();

    document["assumes"]["sigma_m"] = 1.0;
    const auto error_with = [&](const std::string& key, double size) {
        Json changed = document;
        changed["learned_sizes"][key]["learned"] = size;
        folder_.write("estimate.json", changed.dump());
        return testing::input_error_of([&] { read_earlier(path_, stated, {}); });
    };
    const std::string of = "estimate.json: learned_sizes.";
    EXPECT_EQ(error_with("length_m", 0), of + "length_m.learned: is 0; must be from 1e-12 to 10 m");
    EXPECT_EQ(error_with("length_m", 10), "no error");
    EXPECT_EQ(error_with("length_m", 1e5),
              of + "length_m.learned: is 100000; must be from 1e-12 to 10 m");
    EXPECT_EQ(error_with("angle_rad", 3.2),
              of + "angle_rad.learned: is 3.2; must be from 1e-12 to 3.14159 rad");
    document.erase("learned_sizes");
    folder_.write("estimate.json", document.dump());
    EXPECT_EQ(read_earlier(path_, stated, {}).changes.front().substr(0, 15), "sigma_m was 1, ");
}

TEST_F(EstimateFile, TellsNothingOfTargetsThatWereMoved) {
    written();
    Campaign other = campaign_;
    other.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{1e-5}, 1e-5);
    other.nominal.sensor = VectorXd::Constant(6, 0.1);
    EXPECT_THROW(read_earlier(path_, other, {}), InputError);
    const Estimate estimate = read_earlier(path_, other, {.has_new_targets = true}).estimate;
    EXPECT_EQ(estimate.names, parameter_names(other));
    EXPECT_EQ(estimate.parameters.robot, calibration_.estimate.parameters.robot);
    EXPECT_EQ(estimate.parameters.sensor, other.nominal.sensor);
    const Index told = parameter_count(other) - 6;
    EXPECT_EQ(estimate.covariance.topLeftCorner(told, told),
              calibration_.estimate.covariance.topLeftCorner(told, told));
    EXPECT_TRUE(estimate.covariance.bottomRows(6).isZero(0));
}

TEST_F(EstimateFile, TellsNothingOfABaseThatWasMoved) {
    written();
    Campaign known = campaign_;
    known.base_is_known.fill(true);
    known.nominal.world_from_base.translation().x() += 1;
    EXPECT_THROW(read_earlier(path_, known, {}), InputError);
    const MatrixXd whole = calibration_.estimate.covariance;
    const Index told = parameter_count(known);
    const Estimate estimate = read_earlier(path_, known, {.has_new_base = true}).estimate;
    EXPECT_EQ(estimate.names, parameter_names(known));
    EXPECT_EQ(estimate.parameters.sensor, calibration_.estimate.parameters.sensor);
    EXPECT_TRUE(estimate.parameters.world_from_base.isApprox(known.nominal.world_from_base, 0));
    EXPECT_EQ(estimate.covariance, whole.bottomRightCorner(told, told));

    std::swap(campaign_, known);
    calibration_.estimate.names = parameter_names(campaign_);
    calibration_.estimate.covariance = whole.bottomRightCorner(told, told);
    written();
    const MatrixXd back = read_earlier(path_, known, {.has_new_base = true}).estimate.covariance;
    EXPECT_EQ(back.bottomRightCorner(told, told), whole.bottomRightCorner(told, told));
    EXPECT_TRUE(back.topRows(6).isZero(0));
}

TEST_F(EstimateFile, IsNoPriorWhereItsCovarianceIsNotPositiveDefinite) {
    Json document = written();
    document["covariance"]["rows_si"][2] = {-0.9e-8, -0.9e-8, 1e-8};
    folder_.write("estimate.json", document.dump());
    EXPECT_EQ(
        testing::input_error_of([&] { read_earlier(path_, campaign_, {.is_prior = true}); }),
        "estimate.json: covariance.rows_si: is not positive definite, its correlations have the "
        "eigenvalue -0.8; must be, to be a prior");
    EXPECT_NO_THROW(read_earlier(path_, campaign_, {}));
}

TEST_F(EstimateFile, OfAnotherCampaignIsRefused) {
    written();
    const std::string good = read_file(path_);
    const auto error_with = [&](const std::string& part, const std::string& by) {
        folder_.write("estimate.json", testing::replaced(good, part, by));
        return testing::input_error_of([&] { read_estimate(path_, campaign_); });
    };
    EXPECT_EQ(error_with("\"Tx1\": {", "\"Tx9\": {"),
              "estimate.json: robot: has no parameter 'Tx1'; must be an estimate of this campaign");
    const std::string of_another =
        "; the estimate is of another robot, or of this one before its nominal values were changed "
        "(a robot that it has corrected, for one)";
    EXPECT_EQ(error_with("0.312", "0.3125"),
              "estimate.json: chain.elements: element 3 is "
              R"({"motion":"Tx","amount_m":0.3125,"error":"Tx1"}, the campaign's robot has )"
              R"({"motion":"Tx","amount_m":0.312,"error":"Tx1"})" +
                  of_another);
    EXPECT_EQ(error_with("\"elements\": [", "\"elements\": [1,").substr(0, 50),
              "estimate.json: chain.elements: element 1 is 1, the");
    EXPECT_EQ(error_with("\"readings\": \"points\"", "\"readings\": \"poses\""),
              "estimate.json: readings: is 'poses', the campaign's sensor measures points; must be "
              "an estimate of this campaign");
    EXPECT_EQ(error_with("\"ending\": \"converged\"", "\"ending\": \"fine\""),
              "estimate.json: ending: is 'fine'; must be not run, converged, optimal, converged to "
              "rounding, iteration limit, stalled, time limit, interrupted, not identifiable or "
              "optimiser failed");
    EXPECT_EQ(error_with("\"robot\": {", "\"robot\": {\"Tx9\": {},"),
              "estimate.json: robot: has 5 parameters, the campaign's robot 4; must be an estimate "
              "of this campaign");
    EXPECT_EQ(
        error_with("\"value_rad\"", "\"value_m\""),
        "estimate.json: robot.dq1.value_rad: is missing; must be there as posewise writes it");
    EXPECT_EQ(error_with("\"quaternion_wxyz\": [", "\"quaternion_wxyz\": [1,"),
              "estimate.json: base.quaternion_wxyz: has 5 values; must have 4");
    EXPECT_EQ(error_with("\"posewise estimate\"", "\"posewise plan\""),
              "estimate.json: kind: must be \"posewise estimate\", as in an estimate written by "
              "posewise");
    EXPECT_EQ(error_with("\"target2\"", "\"target7\""),
              "estimate.json: targets.target2: is missing; must be there as posewise writes it");
}

TEST_F(EstimateFile, HoldsTheWholeCovarianceAndHowTheIdentificationEnded) {
    Estimate& expected = calibration_.estimate;
    expected.iterations = 7;
    expected.degrees_of_freedom = 42;
    expected.variance_factor = 1.25;
    expected.variance_by_kind = {{0.9, 20.5}, {1.7, 21.5}};
    expected.model_error = 2e-4;
    expected.model_error_within = 1.5;
    expected.ending = Ending::IterationLimit;
    calibration_.faults = {"it did not converge (iteration limit)"};
    const Json document = written();
    EXPECT_EQ(document.at("faults").size(), 1U);
    EXPECT_EQ(document.at("robot").at("Tx1").at("expected_m").get<double>(), 4e-3);
    const Estimate estimate = read_estimate(path_, campaign_);
    EXPECT_EQ(estimate.covariance, expected.covariance);
    EXPECT_EQ(estimate.names, expected.names);
    EXPECT_EQ(estimate.iterations, 7);
    EXPECT_EQ(estimate.degrees_of_freedom, 42);
    EXPECT_EQ(estimate.variance_factor, 1.25);
    EXPECT_EQ(estimate.variance_of(true).factor, 1.7);
    EXPECT_EQ(estimate.variance_of(false).degrees_of_freedom, 20.5);
    EXPECT_EQ(estimate.model_error, 2e-4);
    EXPECT_EQ(estimate.model_error_within, 1.5);
    EXPECT_EQ(estimate.ending, Ending::IterationLimit);
    Json before = document;  // as written by earlier versions
    before.erase("model_error_within");
    folder_.write("estimate.json", before.dump());
    EXPECT_EQ(read_estimate(path_, campaign_).model_error_within, model_error_factor);

    const auto error_with = [&](const char* pointer, const Json& value) {
        Json changed = document;
        changed[Json::json_pointer(pointer)] = value;
        folder_.write("estimate.json", changed.dump());
        return testing::input_error_of([&] { read_estimate(path_, campaign_); });
    };
    EXPECT_EQ(error_with("/covariance/rows_si/1/0", -2e-8),
              "estimate.json: covariance.rows_si[1]: is no row of a covariance; a correlation is "
              "beyond 1");
    EXPECT_EQ(error_with("/covariance/rows_si/3", {1, 2}),
              "estimate.json: covariance.rows_si[3]: has 2 values; must have 4");
    EXPECT_EQ(error_with("/covariance/parameters/7", "x"),
              "estimate.json: covariance.parameters[7]: is 'x'; must be 'Tx1'");
    EXPECT_EQ(error_with("/model_error_within", 0.5),
              "estimate.json: model_error_within: is 0.5; must be at least 1");
    EXPECT_EQ(error_with("/variance_factor", -1),
              "estimate.json: variance_factor: is -1; must be at least 0");
    EXPECT_EQ(error_with("/model_error_m", 1e308),
              "estimate.json: model_error_m: is 1e+308; must be at most 1e+06 m in magnitude");
    const std::string said = " is 0.001, the covariance says 0.0001; must agree with it";
    EXPECT_EQ(error_with("/robot/Tx1/sigma_m", 1e-3), "estimate.json: robot.Tx1.sigma_m:" + said);
    EXPECT_EQ(error_with("/sigma/base.x_m", 1e-3), "estimate.json: sigma.base.x_m:" + said);
    EXPECT_EQ(error_with("/faults", 3), "estimate.json: faults: is of type number; must be a list");
}

TEST_F(EstimateFile, DoesNotDependOnJointLimits) {
    written();
    const std::string text =
        testing::replaced(testing::campaign_text, "limits_deg: [-90, 90]", "limits_deg: [-80, 90]");
    EXPECT_NO_THROW(read_estimate(path_, read_campaign(folder_.write("other.yaml", text))));
}

TEST_F(EstimateFile, WithAQuaternionThatIsNoRotationIsRefused) {
    Json document = written();
    document["base"]["quaternion_wxyz"] = {2, 0, 0, 0};
    folder_.write("estimate.json", document.dump());
    EXPECT_EQ(testing::input_error_of([&] { read_estimate(path_, campaign_); }),
              "estimate.json: base.quaternion_wxyz: has length 2; must be 1");
    for (const double change : {1e-3, 1e300}) {
        document = written();
        document["base"]["rpy_deg"][2] = document["base"]["rpy_deg"][2].get<double>() + change;
        folder_.write("estimate.json", document.dump());
        EXPECT_EQ(testing::input_error_of([&] { read_estimate(path_, campaign_); }),
                  "estimate.json: base.rpy_deg: is not the rotation of quaternion_wxyz; must agree "
                  "with it");
    }
}

TEST_F(EstimateFile, OfASizeThatDoesNotOccurIsRefused) {
    const Json good = written();
    const auto error_with = [&](const char* pointer) {
        Json document = good;
        document[Json::json_pointer(pointer)] = -1e300;
        folder_.write("estimate.json", document.dump());
        return testing::input_error_of([&] { read_estimate(path_, campaign_); });
    };
    const std::string length = " is -1e+300; must be at most 1e+06 m in magnitude";
    EXPECT_EQ(error_with("/robot/Tx1/value_m"), "estimate.json: robot.Tx1.value_m:" + length);
    EXPECT_EQ(error_with("/base/position_m/1"), "estimate.json: base.position_m[1]:" + length);
    EXPECT_EQ(error_with("/targets/target2/position_m/0"),
              "estimate.json: targets.target2.position_m[0]:" + length);
    EXPECT_EQ(error_with("/robot/dq1/value_rad"),
              "estimate.json: robot.dq1.value_rad: is -1e+300; must be at most 10000 rad in "
              "magnitude");
}

}  // namespace
}  // namespace posewise::io
