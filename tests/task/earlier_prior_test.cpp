#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "posewise/calibrator/identification.hpp"
#include "posewise/core/random.hpp"
#include "posewise/criteria/criterion.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/inspection.hpp"
#include "support/held_robot.hpp"

/// calibrate() with an earlier estimate as prior.
namespace posewise {
namespace {

using namespace testing;

/// How much larger an error at poses not measured is to be expected after these poses than after
/// those, with what was known before them: M of the parameters, whitened by the noise.
double expected_ratio(const Campaign& campaign, const Parameters& truth, const Measurements& fresh,
                      const MatrixXd& M, const MatrixXd& M_of_others) {
    const MatrixXd J = make_blocks(campaign, truth, fresh.configurations, 1.0).matrix;
    const auto mean_square = [&J](const MatrixXd& told) {
        return 1 + J.cwiseProduct(J * told.inverse()).sum() / static_cast<double>(J.rows());
    };
    return std::sqrt(mean_square(M) / mean_square(M_of_others));
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

TEST(EarlierEstimate, AsPriorMakesFourPosesAsGoodAsTheyCanBe) {
    const Campaign campaign = held_campaign();
    constexpr int robots = 40;
    std::vector<double> ratios;
    std::vector<double> best_ratios;  // of who knows all covariances
    Index inside = 0;
    Index intervals = 0;
    for (std::uint64_t seed = 0; seed < robots; ++seed) {
        Parameters truth = draw_truth(campaign, seed);
        CalibrationOptions options = without_folds();
        const Measurements twelve = measure_at_random(campaign, truth, 12, seed);
        options.earlier =
            Earlier{calibrate(campaign, twelve, options).estimate, {.is_prior = true}};
        const auto told_by = [&](const Measurements& measured) {
            return information(make_blocks(campaign, truth, measured.configurations, 1.0));
        };
        const VectorXd scale = parameter_scale(campaign);
        MatrixXd before = (told_by(twelve) + prior_information(campaign)).inverse();
        const Index count = campaign.robot.parameter_count();
        RandomStream stream(1000 + seed);
        for (Index k = 0; k < count; ++k) {
            const bool is_offset = !campaign.robot.parameter_element(k).joints.empty();
            if (!is_offset) continue;
            const double drift = options.earlier->use.drift.offset;
            truth.robot[k] += drift * stream.normal();
            const Index parameter = base_parameter_count(campaign) + k;
            before(parameter, parameter) += std::pow(drift / scale[parameter], 2);
        }
        const Measurements sixteen = measure_at_random(campaign, truth, 16, 500 + seed);
        const Measurements four = take(sixteen, {0, 1, 2, 3});
        const Calibration few = calibrate(campaign, four, options);
        const Calibration many = calibrate(campaign, sixteen, without_folds());
        const Measurements fresh = measure_at_random(campaign, truth, 40, 900 + seed);
        const auto held_out = [&](const Calibration& calibration) {
            return make_metrics(residuals(campaign, calibration.estimate.parameters, fresh))
                .distance_rms;
        };
        ratios.push_back(held_out(few) / held_out(many));
        best_ratios.push_back(expected_ratio(campaign, truth, fresh,
                                             before.inverse() + told_by(four),
                                             told_by(sixteen) + prior_information(campaign)));
        const Index begin = base_parameter_count(campaign);
        const VectorXd sigmas = standard_deviations(few.estimate).segment(begin, count);
        const VectorXd off = few.estimate.parameters.robot - truth.robot;
        inside += (off.array().abs() < 1.96 * sigmas.array()).count();
        intervals += count;
    }
    // Six joints are zeroed anew by four poses and not sixteen, however well all else is known.
    EXPECT_GT(median(best_ratios), 1.03);
    EXPECT_LE(median(ratios), 1.08 * median(best_ratios));
    const double share = static_cast<double>(inside) / static_cast<double>(intervals);
    EXPECT_GE(share, 0.92);
    EXPECT_LE(share, 0.97);
    RecordProperty("median_ratio", std::to_string(median(ratios)));
    RecordProperty("best_median_ratio", std::to_string(median(best_ratios)));
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
