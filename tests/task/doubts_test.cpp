#include "posewise/task/doubts.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

Campaign tracked_fanuc() { return testing::tracked_campaign(testing::fanuc()); }

Measurements measure(const Campaign& campaign) {
    return simulate(campaign, {.pose_count = 20}).measurements;
}

std::optional<Misfit> misfit_of(const Campaign& campaign, const Measurements& measurements) {
    return find_misfit(campaign, measurements,
                       register_base_and_targets(campaign, measurements).parameters);
}

TEST(FindMisfit, IsNothingForTheRobotsOwnMeasurements) {
    const Campaign campaign = tracked_fanuc();
    const Measurements measurements = measure(campaign);
    EXPECT_FALSE(misfit_of(campaign, measurements));
    EXPECT_NO_THROW(check_is_of_robot(campaign, measurements,
                                      register_base_and_targets(campaign, measurements)));
}

TEST(FindMisfit, NamesTheUnitThatIsWrong) {
    const Campaign campaign = tracked_fanuc();
    const Measurements right = measure(campaign);
    Measurements wrong = right;
    wrong.configurations *= 180 / 3.14159265358979;
    EXPECT_EQ(misfit_of(campaign, wrong)->reading->words,
              "joint values in degrees where the file says rad");
    wrong = right;
    wrong.observations *= 1000;
    const auto misfit = misfit_of(campaign, wrong);
    EXPECT_EQ(misfit->reading->words, "points in mm where the file says m");
    EXPECT_LT(misfit->reading->misfit.distance_rms, 0.01);
    EXPECT_EQ(misfit->reading->cure, "let the names of their columns end in _mm");
    EXPECT_GT(misfit->distance, 10 * misfit->expected);
    const std::string words = describe_misfit(campaign, *misfit);
    EXPECT_NE(words.find("they fit clearly better with points in mm where the file says m ("),
              std::string::npos)
        << words;
    EXPECT_THROW(check_is_of_robot(campaign, wrong, register_base_and_targets(campaign, wrong)),
                 InputError);
}

TEST(FindMisfit, NamesNoReadingOfAnotherRobot) {
    const Campaign campaign = tracked_fanuc();
    Measurements wrong = measure(campaign);
    wrong.configurations.col(1).array() += 0.6;  // nearer to a zero that is 90 deg elsewhere
    wrong.configurations.col(2).array() -= 0.5;
    const auto misfit = misfit_of(campaign, wrong);
    ASSERT_TRUE(misfit);
    EXPECT_FALSE(misfit->reading) << misfit->reading->words;
}

TEST(FindMisfit, TakesNoTorqueForAJoint) {
    const Campaign campaign =
        testing::tracked_campaign(with_measured_compliance(testing::fanuc(), {{1, 300}, {2, 200}}));
    Measurements wrong = measure(campaign);
    ASSERT_GT(wrong.configurations.rightCols(2).cwiseAbs().maxCoeff(), 100);
    wrong.observations *= 1000;
    EXPECT_EQ(misfit_of(campaign, wrong)->reading->words, "points in mm where the file says m");
}

TEST(CheckIsOfRobot, CannotTellWithTooFewMeasurements) {
    const Campaign campaign = tracked_fanuc();
    Measurements one = take(measure(campaign), {0});
    one.observations *= 1000;
    const Registration registration = register_base_and_targets(campaign, one);
    EXPECT_FALSE(registration.is_determined());
    EXPECT_NO_THROW(check_is_of_robot(campaign, one, registration));
}

TEST(FindBeyondLimits, CountsConfigurationsAndNamesTheFirst) {
    const Campaign campaign = tracked_fanuc();
    Measurements measurements = measure(campaign);
    EXPECT_FALSE(find_beyond_limits(campaign, measurements.configurations));
    measurements.configurations(3, 1) = measurements.configurations(7, 0) = 10;
    const auto beyond = find_beyond_limits(campaign, measurements.configurations);
    EXPECT_EQ(beyond->count, 2);
    EXPECT_EQ(beyond->first, 3);
    EXPECT_EQ(beyond->violation.find(campaign.robot.joint(1).name), 0U) << beyond->violation;
}

TEST(FindScatterDoubt, NamesTheSampleThatIsGrosslyWrong) {
    const Campaign campaign = tracked_fanuc();
    Measurements measured = simulate(campaign, {.pose_count = 20, .repeats = 3}).measurements;
    const Parameters at = register_base_and_targets(campaign, measured).parameters;
    EXPECT_FALSE(find_scatter_doubt(campaign, measured, at));
    EXPECT_FALSE(find_scatter_doubt(campaign, take(measured, {}), at));
    measured.observations(measured.first_sample[6] + 1, 2) += 8e-3;
    ASSERT_TRUE(find_scatter_doubt(campaign, measured, at));
    EXPECT_EQ(find_scatter_doubt(campaign, measured, at)->sample, measured.ids[6] + ":2");
    EXPECT_GT(find_scatter_doubt(campaign, measured, at)->ratio, 5);
    for (Index k = 0; k < 60; ++k) measured.sample_names.push_back(std::to_string(k % 3));
    EXPECT_EQ(find_scatter_doubt(campaign, measured, at)->sample, measured.ids[6] + ":1");
    measured.is_seen(measured.first_sample[6] + 1, 0) =
        false;  // what stands there is not looked at
    measured.observations.row(measured.first_sample[6] + 1)
        .head(3)
        .setConstant(std::numeric_limits<double>::quiet_NaN());
    EXPECT_FALSE(find_scatter_doubt(campaign, measured, at));
}

TEST(FindBeyondMeasured, CountsPosesThatLeaveTheRangeByMoreThanATenth) {
    const Campaign campaign = tracked_fanuc();
    const RowMatrixXd measured = measure(campaign).configurations;
    EXPECT_FALSE(find_beyond_measured(campaign, measured, measured));
    RowMatrixXd others = measured;
    const double range = measured.col(1).maxCoeff() - measured.col(1).minCoeff();
    others(3, 1) = measured.col(1).maxCoeff() + 0.09 * range;
    EXPECT_FALSE(find_beyond_measured(campaign, measured, others));
    others(3, 1) = others(5, 1) = measured.col(1).maxCoeff() + 0.11 * range;
    const auto beyond = find_beyond_measured(campaign, measured, others);
    EXPECT_EQ(beyond->count, 2);
    EXPECT_EQ(beyond->of, 20);
    EXPECT_EQ(beyond->joints, std::vector<std::string>{campaign.robot.joint(1).name});
}

TEST(AddDoubts, JudgesSizesAndResiduals) {
    const Campaign campaign = tracked_fanuc();
    const Measurements measurements = measure(campaign);
    Estimate estimate = identify(campaign, measurements,
                                 register_base_and_targets(campaign, measurements).parameters);
    Doubts doubts;
    add_doubts(campaign, measurements, estimate, doubts);
    EXPECT_TRUE(doubts.sizes.empty());
    EXPECT_TRUE(doubts.residuals.empty());
    EXPECT_TRUE(doubts.negative_compliances.empty());

    const VectorXd scale = parameter_scale(campaign);
    estimate.parameters.robot[2] = 25 * scale[6 + 2];
    estimate.variance_factor = 9;
    add_doubts(campaign, measurements, estimate, doubts);
    ASSERT_EQ(doubts.sizes.size(), 1U);
    EXPECT_EQ(doubts.sizes[0].parameter, campaign.robot.parameter_names()[2]);
    EXPECT_NEAR(doubts.sizes[0].times, 25, 1e-9);
    ASSERT_EQ(doubts.residuals.size(), 1U);
    EXPECT_EQ(doubts.residuals[0].ratio, 3);
}

TEST(AddDoubts, SaysAlwaysThatGravityIsNotInTheModelAndHardlyEverWhereThereIsNone) {
    const Chain bare = without_parameters(testing::fanuc());
    const Campaign stated = testing::tracked_campaign(bare);
    const Campaign free = with_robot(stated, irreducible_model(stated));
    Campaign held = with_robot(stated, detail::complete_model(bare));
    held.spread = population_spread(bare);
    held.model_error_common = 0;  // as it is simulated
    const Campaign bending =
        with_robot(stated, detail::complete_model(with_compliance(bare, testing::fanuc_loads())));
    constexpr Index campaigns = 200;
    for (const Campaign& geometric : {free, held}) {
        for (const double yield : {0.0, 0.7e-3}) {  // rad under the largest torque
            Index said = 0;
            for (std::uint64_t run = 0; run < campaigns; ++run) {
                Parameters truth = draw_truth(bending, run);
                for (const Compliance& compliance : compliances(bending.robot)) {
                    truth.robot[compliance.parameter] = yield;
                }
                const Measurements measured = simulate_measurements(
                    bending, truth, detail::random_configurations(bare, 16, run), 1, 1000 + run);
                Doubts doubts;
                add_doubts(geometric, measured,
                           identify(geometric, measured,
                                    register_base_and_targets(geometric, measured).parameters),
                           doubts);
                const bool misses = !doubts.residuals.empty() && doubts.residuals[0].ratio > 1;
                said += misses || doubts.missing_errors || !doubts.model_errors.empty() ? 1 : 0;
            }
            if (yield > 0) {
                EXPECT_EQ(said, campaigns);
            } else {
                EXPECT_LE(said, 2);  // each in a thousand cases
            }
        }
    }
}

TEST(AddDoubts, JudgesResidualsByTheirDegreesOfFreedom) {
    const Campaign campaign = tracked_fanuc();
    const Measurements measurements = measure(campaign);
    Estimate estimate;
    estimate.parameters = campaign.nominal;
    estimate.names = parameter_names(campaign);
    const Index count = parameter_count(campaign);
    estimate.covariance = MatrixXd::Identity(count, count);
    const auto is_said = [&](double variance_factor, Index freedom) {
        estimate.variance_factor = variance_factor;
        estimate.degrees_of_freedom = freedom;
        Doubts doubts;
        add_doubts(campaign, measurements, estimate, doubts);
        return !doubts.residuals.empty();
    };
    EXPECT_TRUE(is_said(1.58, 507));
    EXPECT_FALSE(is_said(1.58, 30));
    EXPECT_TRUE(is_said(0.5, 200));
    EXPECT_FALSE(is_said(0.5, 20));
    EXPECT_FALSE(is_said(1.3, 10000));  // beyond chance, and of no consequence
    EXPECT_FALSE(is_said(9, 0));
}

class FindFaults : public ::testing::Test {
  protected:
    FindFaults()
        : campaign_(tracked_fanuc()),
          measured_(measure(campaign_)),
          estimate_(identify(campaign_, measured_,
                             register_base_and_targets(campaign_, measured_).parameters)) {}

    /// The one fault after a change.
    std::string fault_after(const std::function<void(Estimate&)>& change) const {
        Estimate changed = estimate_;
        change(changed);
        const std::vector<std::string> faults = find_faults(campaign_, changed);
        EXPECT_LE(faults.size(), 1U) << faults.front();
        return faults.empty() ? "" : faults.front();
    }

    const Campaign campaign_;
    const Measurements measured_;
    const Estimate estimate_;
};

TEST_F(FindFaults, CountsTheModelErrorFoundWhereResidualsAreBeyondItToo) {
    const double stated = campaign_.model_error;
    ASSERT_GT(stated, 0);
    const auto fault_of = [&](double times, double ratio) {
        return fault_after([&](Estimate& e) {
            e.model_error = times * stated;
            e.variance_factor = ratio * ratio;
            e.variance_by_kind.clear();
        });
    };
    EXPECT_EQ(fault_of(40, 9), "its residuals are 3.6e+02 times what sigma and model error say");
    EXPECT_EQ(fault_of(40, 7), "");
    EXPECT_EQ(fault_of(1000, 1.5), "");
    EXPECT_EQ(fault_of(1, 290), "");
    EXPECT_EQ(fault_of(1, 310), "its residuals are 3.1e+02 times what sigma and model error say");
}

TEST_F(FindFaults, NamesWhatNoCellHas) {
    EXPECT_EQ(fault_after([](Estimate&) {}), "");
    EXPECT_EQ(fault_after([](Estimate& e) { e.model_error = 0.5; }),
              "its model error is 500 mm, above the 100 mm of any robot");
    EXPECT_EQ(fault_after([](Estimate& e) { e.model_error_orientation = 0.2; }),
              "its model error is 200 mrad, above the 100 mrad of any robot");
    const std::string far =
        fault_after([](Estimate& e) { e.parameters.world_from_base.translation().x() += 1e4; });
    EXPECT_EQ(far.find("the base is 1"), 0U) << far;
    Campaign stated = campaign_;
    stated.nominal.world_from_base.translation().x() += 1e4;  // in mm, read as m
    EXPECT_TRUE(find_faults(stated, estimate_).empty());
    Estimate there = estimate_;
    there.parameters.world_from_base.translation().x() += 1e4;
    EXPECT_TRUE(find_faults(stated, there).empty());
    EXPECT_EQ(fault_after([](Estimate& e) { e.parameters.sensor.head<3>() << 0, 0, 50; }),
              "target 1 is 50 m from the flange, above 10 m");
    EXPECT_EQ(fault_after([](Estimate& e) {
                  e.parameters.sensor.segment<3>(3) = e.parameters.sensor.head<3>();
              }),
              "targets 1 and 2 are at one place, 0 mm apart");
    EXPECT_EQ(fault_after([](Estimate& e) { e.variance_factor = 1e-300; }),
              "its variance factor is 1e-300, which no measurement gives");
    EXPECT_EQ(fault_after([](Estimate& e) {
                  e.variance_factor = 0.9;
                  e.degrees_of_freedom = 0;
              }),
              "its variance factor is 0.9, of no degrees of freedom");
    EXPECT_EQ(fault_after([](Estimate& e) { e.covariance(7, 7) = 1e-306; }),
              "the standard deviation of " + parameter_names(campaign_)[7] +
                  " is 1e-150 mm, which no measurement gives");
    // Of targets that were moved nothing is known.
    EXPECT_EQ(fault_after([&](Estimate& e) { e.covariance.bottomRightCorner<9, 9>().setZero(); }),
              "");
}

TEST_F(FindFaults, AreNoneWithoutAnyNoise) {
    Parameters truth = draw_truth(campaign_, 1);
    Measurements exact = measured_;
    for (Index i = 0; i < exact.configuration_count(); ++i) {
        const VectorXd q = exact.configurations.row(i).transpose();
        const VectorXd seen =
            campaign_.sensor->predict(world_from_flange(campaign_, truth, q), truth.sensor);
        for (Index k = exact.first_sample[static_cast<std::size_t>(i)];
             k < exact.first_sample[static_cast<std::size_t>(i) + 1]; ++k) {
            exact.observations.row(k) = seen.transpose();
        }
    }
    const Estimate estimate =
        identify(campaign_, exact, register_base_and_targets(campaign_, exact).parameters);
    EXPECT_LT(estimate.variance_factor, 1e-15);
    const std::vector<std::string> faults = find_faults(campaign_, estimate);
    EXPECT_TRUE(faults.empty()) << faults.front();
}

TEST(FindPlaceDoubts, NameABaseThatIsStatedTurned) {
    Campaign campaign = tracked_fanuc();
    const Parameters registered = register_base_and_targets(campaign, measure(campaign)).parameters;
    campaign.has_nominal_targets = false;
    const auto turned_by = [&](double angle) {
        Campaign turned = campaign;
        turned.nominal.world_from_base.rotate(Eigen::AngleAxisd(angle, Vector3d::UnitX()));
        return find_place_doubts(turned, registered);
    };
    EXPECT_TRUE(turned_by(0).empty());
    EXPECT_TRUE(turned_by(0.2).empty());
    const auto doubts = turned_by(3.1415926535);
    ASSERT_EQ(doubts.size(), 1U);
    EXPECT_NEAR(doubts[0].turn, 3.1415926535, 0.01);
    EXPECT_EQ(describe_places(doubts).find("base is measured turned by 1"), 0U)
        << describe_places(doubts);
}

}  // namespace
}  // namespace posewise
