#include <gtest/gtest.h>

#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/error_terms.hpp"
#include "posewise/report/reports.hpp"
#include "support/campaigns.hpp"
#include "support/sensors.hpp"

namespace posewise {
namespace {

bool holds(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

struct Example {
    Campaign campaign = testing::tracked_campaign(testing::fanuc());
    Measurements measurements;

    explicit Example(Index poses) {
        campaign.name = "robot";
        measurements = simulate(campaign, {.pose_count = poses, .repeats = 2}).measurements;
    }
};

TEST(FormatCalibration, SaysWhatWasFoundAndHowAccurateItIs) {
    const Example example(16);
    const Calibration calibration = calibrate(example.campaign, example.measurements);
    const std::string text = format(calibration);
    EXPECT_EQ(text.find("robot: 16 configurations, 32 samples, 33 parameters\nlm: converged"), 0U)
        << text;
    for (const char* const part :
         {"\nAccuracy\n\n", "held out: 16 folds, 0 of them not identifiable\n",
          "noise floor from repeats: 0.0", "\nParameters (errors of the robot, base, targets in",
          "\nStrongest correlations\n\n"}) {
        EXPECT_TRUE(holds(text, part)) << part;
    }
    EXPECT_FALSE(holds(text, "Compliances"));
    EXPECT_TRUE(describe_doubts(calibration).empty());
}

TEST(FormatCalibration, ShowsLearnedSizesBesideTheExpected) {
    Example example(16);
    example.campaign.spread.is_prior = true;
    CalibrationOptions options;
    options.folds = 0;
    example.campaign.spread.is_open = false;
    EXPECT_FALSE(
        holds(format(calibrate(example.campaign, example.measurements, options)), "class"));
    example.campaign.spread.is_open = true;
    const std::string text = format(calibrate(example.campaign, example.measurements, options));
    EXPECT_TRUE(holds(text, "class           count  expected  learned     RMS")) << text;
}

TEST(FormatCalibration, ShowsHarmonicsOfSlidesAsLengths) {
    const Chain rail = testing::with_pitch(testing::rail_with_fanuc(), 0, 0.02);
    Campaign campaign = testing::tracked_campaign(with_harmonics(rail, {1}));
    campaign.spread.is_prior = true;
    campaign.spread.slide_harmonic = 5e-6;
    const auto measured = simulate(campaign, {.pose_count = 12}).measurements;
    const std::string text = format(calibrate(campaign, measured, {.folds = 0}));
    const auto begin = text.find("\nharmonics of joints that slide      2     0.005");
    ASSERT_NE(begin, std::string::npos) << text;
    const std::string line = text.substr(begin + 1, text.find('\n', begin + 1) - begin - 1);
    EXPECT_TRUE(holds(line, "  mm    rail.")) << line;
    EXPECT_TRUE(holds(text, "\nharmonics                          12      0.15")) << text;
}

TEST(FormatCalibration, DoesNotClaimAModelErrorFoundFromNothing) {
    Example example(16);
    example.campaign.spread.is_prior = true;
    Calibration calibration = calibrate(example.campaign, example.measurements, {.folds = 0});
    EXPECT_TRUE(holds(format(calibration), "\nmodel error found: 0."));
    calibration.estimate.degrees_of_freedom = 0;
    const std::string text = format(calibration);
    EXPECT_TRUE(holds(text, "\nmodel error assumed, nothing is left to find it from: 0.")) << text;
    EXPECT_FALSE(holds(text, "error found"));
}

TEST(FormatCalibration, SaysWhatToExpectAtPosesToPredict) {
    const Example example(16);
    Calibration calibration = calibrate(example.campaign, example.measurements, {.folds = 0});
    EXPECT_FALSE(holds(format(calibration), "to predict"));
    const PredictedError error{{3e-4, 4e-4, 0}, 9e-4};
    calibration.predicted = {{false, &length_units, error, {error, error}},
                             {true, &angle_units, error, {error, error}}};
    for (const std::string unit : {"mm", "mrad"}) {
        EXPECT_TRUE(holds(format(calibration), "\nexpected at the 2 poses to predict: 0.5 " + unit +
                                                   " (parameters 0.3 " + unit + ", left over 0.4 " +
                                                   unit + ", instrument 0 " + unit +
                                                   "), 95 % are below 0.9 " + unit + "\n"))
            << format(calibration);
    }
}

/// Empty without such an answer.
std::string answer_of(const Calibration& calibration, const std::string& key) {
    for (const Answer& one : answer(calibration)) {
        if (one.key == key) return one.text;
    }
    return "";
}

TEST(FormatCalibration, SaysWhichResidualsAreNotAsStated) {
    Campaign truth = testing::tracked_campaign(testing::fanuc());
    truth.sensor = std::make_shared<PoseSensor>(std::nullopt, IsotropicNoise{5e-5}, 5e-5);
    truth.nominal.sensor = VectorXd::Zero(6);
    truth = with_robot(truth, irreducible_model(with_robot(truth, testing::fanuc())));
    truth.model_error = truth.model_error_orientation = 4e-4;
    const Measurements measured = simulate(truth, {.pose_count = 200}).measurements;
    Campaign stated = truth;
    stated.model_error_orientation = 2e-4;
    Calibration calibration = calibrate(stated, measured, {.folds = 0});
    ASSERT_EQ(calibration.doubts.residuals.size(), 1U);
    EXPECT_NEAR(calibration.doubts.residuals[0].fitting, 4e-4, 4e-5);
    EXPECT_EQ(answer_of(calibration, "residuals"),
              "the residuals in mrad are 1.8 times what sigma and model error say");
    stated.model_error_orientation = 8e-4;
    EXPECT_TRUE(holds(answer_of(calibrate(stated, measured, {.folds = 0}), "residuals"),
                      "what sigma and model error say, as a model error of 0."));
}

TEST(FormatCalibration, NamesOnlyCuresThatWereTriedWithTheirFigures) {
    const Example example(16);
    Calibration calibration = calibrate(example.campaign, example.measurements, {.folds = 0});
    EXPECT_FALSE(holds(format(calibration), "of little or no use"));
    calibration.cures = {{{exclusion({"5"}), 0.038, 1.6e-4}},
                         {{"loss cauchy"}, {"errors: full", true}}};
    const std::string cure = "with --exclude 5: 0.16 instead of 38 mm held out";
    EXPECT_TRUE(holds(format(calibration),
                      cure + "\ntried, of little or no use: --loss cauchy, errors: full\n"))
        << format(calibration);
    EXPECT_TRUE(describe_doubts(calibration, "m.csv").empty()) << "there is none to cure";
    calibration.faults = {"it is wrong"};
    EXPECT_EQ(describe_doubts(calibration, "m.csv"), std::vector<std::string>{"m.csv: " + cure});
}

TEST(FormatCalibration, SaysWhetherTheValidationIsAsExpected) {
    const Example example(40);
    Measurements others = simulate(example.campaign, {.pose_count = 30, .seed = 9}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    options.validation = &others;
    options.refitted = {"base"};
    const auto report = [&] {
        return format(calibrate(example.campaign, example.measurements, options));
    };
    EXPECT_TRUE(holds(report(), "within chance: the calibration holds there\n")) << report();
    EXPECT_TRUE(holds(report(), "\nRefitted to the validation (base, targets")) << report();
    EXPECT_FALSE(holds(report(), "extrapolated")) << report();
    others.configurations.col(2).array() += 0.002;  // another zero since
    EXPECT_TRUE(holds(report(), "times what is expected, beyond chance")) << report();
    EXPECT_TRUE(holds(report(),
                      "the robot has changed, or the robot's errors there are unlike those "
                      "calibrated with, or the model error is larger than the one stated"))
        << report();
    others.configurations(4, 1) += 3;
    EXPECT_TRUE(holds(report(), "\nvalidation, 29 new poses: RMS ")) << report();
    const std::string accuracy =
        answer(calibrate(example.campaign, example.measurements, options))[0].text;
    EXPECT_TRUE(holds(accuracy,
                      " at 29 of 30 poses of the validation (judged apart: 1 beyond the range of "
                      "q2); before "))
        << accuracy;
    EXPECT_TRUE(
        holds(report(), "\nvalidation, 1 pose beyond the joint ranges calibrated with (q2): RMS "))
        << report();
    EXPECT_TRUE(holds(report(), "extrapolated; calibrate with poses like those, too\n"))
        << report();
}

TEST(FormatCalibration, TellsOfVerificationBesideTheValidation) {
    const Example example(40);
    const Measurements others =
        simulate(example.campaign, {.pose_count = 30, .seed = 9}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    for (Index i = 0; i < 30; ++i) options.used.push_back(i);
    for (Index i = 30; i < 40; ++i) options.verification.push_back(i);
    const auto accuracy = [&] {
        return answer(calibrate(example.campaign, example.measurements, options))[0].text;
    };
    EXPECT_TRUE(holds(accuracy(), " that the plan set aside to verify; before ")) << accuracy();
    EXPECT_FALSE(holds(accuracy(), "validation")) << accuracy();
    options.validation = &others;
    const std::string both = accuracy();
    const std::size_t validation = both.find(" of the validation");
    const std::size_t verification = both.find(" that the plan set aside to verify");
    ASSERT_TRUE(validation < verification && verification != both.npos) << both;
    EXPECT_TRUE(holds(both.substr(validation, verification - validation), " mm RMS (95 %: "))
        << both;
}

TEST(FormatCalibration, ShowsWhatAnotherInstrumentJudgesInItsOwnUnits) {
    const Campaign tracked = testing::tracked_campaign(testing::fanuc());
    const Campaign seen = testing::before_camera(tracked, testing::fixed_camera());
    const Simulation views = simulate(seen, {.pose_count = 30, .repeats = 1, .truth_seed = 2});
    Parameters truth = tracked.nominal;
    truth.robot = views.truth.robot;
    const RowMatrixXd poses =
        simulate(tracked, {.pose_count = 20, .seed = 9}).measurements.configurations;
    const Measurements others = simulate_measurements(tracked, truth, poses, 1, 5);
    CalibrationOptions options;
    options.folds = 0;
    options.validation = &others;
    options.validation_campaign = &tracked;
    options.refitted = {"base", "targets"};
    const Calibration calibration = calibrate(seen, views.measurements, options);
    ASSERT_TRUE(calibration.validation);
    EXPECT_EQ(calibration.validation->units, &length_units);
    const std::string text = format(calibration);
    const auto line = [&text](const std::string& begin) {
        const std::size_t at = text.find(begin);
        return at == std::string::npos ? "" : text.substr(at, text.find('\n', at) - at);
    };
    EXPECT_TRUE(holds(line("validation, "), " mm")) << text;
    EXPECT_FALSE(holds(line("validation, "), " px")) << text;
    EXPECT_FALSE(holds(line("error "), "validation")) << text;
    EXPECT_TRUE(holds(line("expected over the workspace, in the instrument's frame: "), " mm"))
        << text;
    const std::string alone = line("expected over the workspace, of the robot alone");
    EXPECT_TRUE(holds(alone, " mm, nominal ")) << text;
    ASSERT_TRUE(calibration.expected_robot);
    EXPECT_EQ(holds(alone, "nothing is gained"),
              calibration.expected_robot->calibrated >= calibration.expected_robot->nominal);
}

TEST(AnswerCalibration, SaysWhereACameraIsThatIsFoundAlone) {
    const Campaign robot = testing::before_camera(testing::tracked_campaign(testing::fanuc()),
                                                  testing::fixed_camera());
    const Measurements views =
        simulate(robot, {.pose_count = 30, .repeats = 1, .truth_seed = 2}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    const auto place_of = [&](const Campaign& campaign) {
        for (const Answer& one : answer(calibrate(campaign, views, options))) {
            if (one.key == "place") return one.text;
        }
        return std::string();
    };
    EXPECT_EQ(place_of(robot), "");
    const std::string place = place_of(with_robot(robot, without_parameters(robot.robot)));
    const std::string begin = "the board is at ";
    ASSERT_EQ(place.find(begin), 0U) << place;
    EXPECT_NEAR(std::stod(place.substr(begin.size())), 100, 1);
    EXPECT_NE(place.find("; the camera is at "), std::string::npos) << place;
}

TEST(AnswerCalibration, SaysWhichPartsOfTheImageCornersCover) {
    const Campaign seen = testing::before_camera(testing::tracked_campaign(testing::fanuc()),
                                                 testing::fixed_camera());
    const Measurements views =
        simulate(seen, {.pose_count = 30, .repeats = 1, .truth_seed = 2}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    Calibration calibration = calibrate(seen, views, options);
    const auto text = [&] {
        for (const Answer& one : answer(calibration)) {
            if (one.key == "image") return one.text;
        }
        return std::string();
    };
    ASSERT_EQ(calibration.images.size(), 1U);
    EXPECT_EQ(text().find("corners of the board cover "), 0U) << text();
    ImageCoverage& image = calibration.images.front();
    image.part = 34.0 / 48;
    image.empty = {"top left", "left", "bottom right"};
    EXPECT_EQ(text(),
              "corners of the board cover 71 % of the image, none at its top left, left or bottom "
              "right");
    image.part = 1;
    image.empty.clear();
    EXPECT_EQ(text(), "corners of the board cover 100 % of the image");
    image.name = "camera 1";
    calibration.images.push_back({1, {1280, 960}, 8, 6, {}, 0.25, {"middle"}, "camera 2"});
    calibration.images.push_back({2, {1280, 960}, 8, 6, {}, 0, {"middle"}, "camera 3"});
    EXPECT_EQ(text(),
              "corners of the board cover 100 % of camera 1's image; 25 % of camera 2's image, "
              "none at its middle; 0 % of camera 3's image");
    calibration.images.clear();
    EXPECT_EQ(text(), "");
}

TEST(FormatCalibration, NeverSaysWithinChanceOfPosesCalibratedWith) {
    const Example example(20);
    const Measurements again =
        simulate(example.campaign, {.pose_count = 20, .repeats = 1}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    options.limit = 1e-3;
    options.validation = &again;
    const std::string text = format(calibrate(example.campaign, example.measurements, options));
    EXPECT_TRUE(holds(text, "\nvalidation, 20 poses calibrated with: RMS ")) << text;
    EXPECT_TRUE(holds(text,
                      " degrees of freedom), limit 1 mm: not judged; they were calibrated "
                      "with and say nothing of other poses\n"))
        << text;
    EXPECT_FALSE(holds(text, "within chance")) << text;
}

TEST(FormatCalibration, SaysWhetherALimitIsKept) {
    const Example example(30);
    const Measurements others =
        simulate(example.campaign, {.pose_count = 15, .seed = 9}).measurements;
    CalibrationOptions options;
    options.folds = 0;
    options.validation = &others;
    const auto report = [&](double limit) {
        options.limit = limit;
        return format(calibrate(example.campaign, example.measurements, options));
    };
    const double rms =
        calibrate(example.campaign, example.measurements, options).validation->found.rms();
    EXPECT_TRUE(holds(report(2 * rms), " mm: pass; ")) << report(2 * rms);
    EXPECT_TRUE(holds(report(0.5 * rms), " mm: fail; ")) << report(0.5 * rms);
    EXPECT_TRUE(holds(report(0.5 * rms), "within chance: as expected, but more than the limit\n"))
        << report(0.5 * rms);
    EXPECT_TRUE(holds(report(1.1 * rms), " mm: undecided (if the RMS stays, "))
        << report(1.1 * rms);
}

TEST(FormatCalibration, OfOneThatIsNotIdentifiedSaysWhy) {
    const Example example(3);
    EXPECT_EQ(format(calibrate(example.campaign, example.measurements)),
              "3 configurations give 27 equations, 33 parameters need at least as many\n");
}

TEST(DescribeDoubts, NamesTheMeasurementsOfWhatIsWrongWithThem) {
    const Example example(16);
    Calibration calibration = calibrate(example.campaign, example.measurements, {.folds = 0});
    calibration.doubts.gross_error = 0.25;
    calibration.doubts.sizes = {{"dq2", 40, 0, &angle_units, false},
                                {"Tx1", 25.5, 0, &length_units, false}};
    calibration.doubts.orientations = 0.5;
    EXPECT_EQ(
        describe_doubts(calibration, "m.csv"),
        (std::vector<std::string>{
            "m.csv: the nominal robot misses the points by 0.25 m (RMS)",
            "m.csv: the nominal robot misses the orientations by 28.6 deg (RMS); in no other sense "
            "of their columns that was tried by clearly less",
            "far above the expected size: dq2 (40 times), Tx1 (25.5 times); are sign, unit and "
            "nominal value in the campaign right, and do the poses tell them apart?"}));
    for (int k = 1; k <= 5; ++k) {
        calibration.doubts.sizes.push_back(
            {"a" + std::to_string(k), 20.0 + k, 0, &angle_units, false});
    }
    EXPECT_NE(
        describe_doubts(calibration)
            .back()
            .find("dq2 (40 times), Tx1 (25.5 times), a5 (25 times), a4 (24 times), a3 (23 times) "
                  "and 2 more; are sign"),
        std::string::npos);
    calibration.doubts = {};
    calibration.doubts.sizes = {{"dq2", 3.5, 0.07, &angle_units, true}};
    calibration.campaign.spread.by_name["dq2"] = 0.02;
    calibration.campaign.spread.is_prior = true;
    calibration.doubts.model_errors = {{9, 9e-4, false}};
    const auto sentences = describe_doubts(calibration);
    ASSERT_EQ(sentences.size(), 2U);
    EXPECT_EQ(sentences[0],
              "beyond three times the expected size, which holds them back: dq2 (70 mrad, 3.5 "
              "times); does the robot give way that much?");
    EXPECT_TRUE(sentences[1].starts_with(
        "the model error found is 0.9 mm, 9 times what is expected: so much is left over"));
    calibration.doubts.model_errors = {{40, 4e-3, false, true}};
    EXPECT_TRUE(describe_doubts(calibration)[1].starts_with(
        "the model error found is 4 mm or more, 40 times what is expected: "));
}

TEST(DescribeBeyondLimits, CountsThemAndNamesTheFirst) {
    const Example example(3);
    EXPECT_EQ(describe(BeyondLimits{2, 1, "q2 is 61 deg, must be from -50 to 60 deg"},
                       example.measurements.ids),
              "2 of 3 configurations are beyond the campaign's joint limits, the first is "
              "'" +
                  example.measurements.ids[1] + "': q2 is 61 deg, must be from -50 to 60 deg");
}

}  // namespace
}  // namespace posewise
