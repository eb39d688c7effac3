#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "posewise/calibrator/registration.hpp"
#include "posewise/core/random.hpp"
#include "posewise/criteria/criterion.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/inspection.hpp"
#include "support/held_robot.hpp"

/// calibrate() with an earlier estimate as prior.
namespace posewise {
namespace {

using namespace testing;

TEST(EarlierEstimate, AsPriorMakesFourPosesAlmostAsGoodAsSixteen) {
    const Campaign campaign = held_campaign();
    constexpr int robots = 40;
    std::vector<double> ratios;
    Index inside = 0;
    Index intervals = 0;
    for (std::uint64_t seed = 0; seed < robots; ++seed) {
        Parameters truth = draw_truth(campaign, seed);
        CalibrationOptions options = without_folds();
        options.earlier = Earlier{
            calibrate(campaign, measure_at_random(campaign, truth, 12, seed), options).estimate,
            {.is_prior = true}};
        const Index count = campaign.robot.parameter_count();
        RandomStream stream(1000 + seed);
        for (Index k = 0; k < count; ++k) {
            const bool is_offset = !campaign.robot.parameter_element(k).joints.empty();
            if (is_offset) truth.robot[k] += options.earlier->use.drift.offset * stream.normal();
        }
        const Measurements sixteen = measure_at_random(campaign, truth, 16, 500 + seed);
        const Calibration few = calibrate(campaign, take(sixteen, {0, 1, 2, 3}), options);
        const Calibration many = calibrate(campaign, sixteen, without_folds());
        const Measurements fresh = measure_at_random(campaign, truth, 40, 900 + seed);
        const auto held_out = [&](const Calibration& calibration) {
            return make_metrics(residuals(campaign, calibration.estimate.parameters, fresh))
                .distance_rms;
        };
        ratios.push_back(held_out(few) / held_out(many));
        const Index begin = base_parameter_count(campaign);
        const VectorXd sigmas = standard_deviations(few.estimate).segment(begin, count);
        const VectorXd off = few.estimate.parameters.robot - truth.robot;
        inside += (off.array().abs() < 1.96 * sigmas.array()).count();
        intervals += count;
    }
    std::nth_element(ratios.begin(), ratios.begin() + robots / 2, ratios.end());
    // What 0.1 mrad in each of six joints has changed, four poses find in part.
    EXPECT_LE(ratios[robots / 2], 1.1);
    const double share = static_cast<double>(inside) / static_cast<double>(intervals);
    EXPECT_GE(share, 0.93);
    EXPECT_LE(share, 0.97);
    RecordProperty("median_ratio", std::to_string(ratios[robots / 2]));
    RecordProperty("coverage", std::to_string(share));
}

TEST(EarlierEstimate, AsPriorOnePoseIsEnough) {
    const Campaign campaign = held_campaign();
    Parameters truth = draw_truth(campaign, 5);
    CalibrationOptions options = without_folds();
    const Calibration first =
        calibrate(campaign, measure_at_random(campaign, truth, 24, 1), options);
    options.earlier = Earlier{first.estimate, {.is_prior = true}};
    const Index dq3 = base_parameter_count(campaign) + 7;
    for (const Index count : {1, 2}) {
        const Calibration found =
            calibrate(campaign, measure_at_random(campaign, truth, count, 2), options);
        ASSERT_EQ(found.estimate.ending, Ending::Converged) << found.estimate.undetermined;
        EXPECT_TRUE(found.faults.empty());
        EXPECT_FALSE(found.moved_since);
        EXPECT_LT(standard_deviations(found.estimate)[dq3],
                  std::hypot(standard_deviations(first.estimate)[dq3], 1e-4));
        EXPECT_GT(found.nominal.distance_rms, 1e-4) << "the robot as its maker says";
        options.earlier->use.has_new_targets = true;
        EXPECT_TRUE(calibrate(campaign, measure_at_random(campaign, truth, 2, 2), options)
                        .is_identified() == campaign.has_nominal_targets);
        options.earlier->use.has_new_targets = false;
    }
    // Of base and targets nothing was known then.
    options.earlier->use = {};
    EXPECT_FALSE(
        calibrate(campaign, measure_at_random(campaign, truth, 2, 2), options).is_identified());
}

TEST(EarlierEstimate, AsPriorCountsInRatings) {
    const Campaign campaign = held_campaign();
    Earlier earlier{calibrate(campaign, measure_at_random(campaign, draw_truth(campaign, 3), 24, 1),
                              without_folds())
                        .estimate,
                    {.is_prior = true}};
    const Campaign known = with_earlier(campaign, earlier);
    const Measurements measured = measure_at_random(campaign, draw_truth(campaign, 3), 6, 8);
    const Parameters registered = determined(register_base_and_targets(known, measured));
    const MatrixXd M = information(make_blocks(known, registered, measured.configurations, 1.0)) +
                       prior_information(known);
    const Rating rating = rate(known, measured, 0);
    const auto d = static_cast<std::size_t>(
        std::find(all_criteria.begin(), all_criteria.end(), Criterion::D) - all_criteria.begin());
    EXPECT_NEAR(rating.scaled.values[d], evaluate(Criterion::D, M, 6), 1e-6);
}

}  // namespace
}  // namespace posewise
