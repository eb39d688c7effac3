#include <gtest/gtest.h>

#include <cmath>

#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/planner/planning.hpp"
#include "support/held_robot.hpp"

/// What is predicted from an earlier estimate on, and how surely.
namespace posewise {
namespace {

using namespace testing;

double width_of(const PredictedTotal& total) { return std::log(total.upper / total.lower); }

PredictedAccuracy predict(const Campaign& campaign, const RowMatrixXd& poses,
                          const RowMatrixXd& workspace) {
    const MatrixXd M = information(make_blocks(campaign, campaign.nominal, poses, 1.0)) +
                       prior_information(campaign);
    const RowMatrixXd once = RowMatrixXd::Ones(poses.rows(), campaign.sensor->target_count());
    return predict_accuracy(make_position_errors(campaign, workspace), M, campaign,
                            information_by_noise(campaign, campaign.nominal, poses, once));
}

/// Of targets at configurations of the workspace, with the model error of the robot that `truth`
/// is.
double total_error(const Campaign& truth, const Parameters& parameters, const Parameters& found,
                   const RowMatrixXd& workspace) {
    Campaign exact = truth;
    exact.model_error = 0;
    exact.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), 1e-9);
    const Measurements there = simulate_measurements(exact, parameters, workspace, 1, 1);
    const double rms = make_metrics(residuals(truth, found, there)).distance_rms;
    return std::sqrt(rms * rms + 3 * truth.model_error * truth.model_error);
}

TEST(EarlierEstimate, NarrowsTheIntervalToWhatItTells) {
    constexpr int robots = 60;
    int inside = 0;
    for (std::uint64_t seed = 0; seed < robots; ++seed) {
        const Campaign stated = held_campaign();
        Campaign campaign = stated;  // robots differ in what the model lacks
        campaign.model_error *= std::pow(model_error_factor, RandomStream(seed, 7).normal());
        const Parameters truth = draw_truth(campaign, seed);
        CalibrationOptions options = without_folds();
        options.earlier = Earlier{
            calibrate(stated, measure_at_random(campaign, truth, 24, seed), options).estimate};
        const Campaign known = with_earlier(stated, *options.earlier);
        const RowMatrixXd workspace = detail::random_configurations(stated.robot, 60, 3000 + seed);
        const Measurements next = measure_at_random(campaign, truth, 12, 500 + seed);
        PredictedAccuracy accuracy = predict(known, next.configurations, workspace);
        const PredictedTotal total = predict_total(accuracy);
        accuracy.known_within = {};
        const PredictedTotal of_any = predict_total(accuracy);
        EXPECT_LT(width_of(total), 0.75 * width_of(of_any));
        EXPECT_DOUBLE_EQ(total.rms, of_any.rms);
        const double found = total_error(
            campaign, truth, calibrate(stated, next, options).estimate.parameters, workspace);
        inside += found >= total.lower && found <= total.upper ? 1 : 0;
    }
    RecordProperty("inside", inside);
    EXPECT_GE(inside, 0.8 * robots);  // 0.9 expected, less two standard deviations and a half
}

TEST(EarlierEstimate, KnowsSizesAsWellAsItsErrorsTellThem) {
    const Campaign campaign = held_campaign();
    const Parameters truth = draw_truth(campaign, 2);
    const auto within_of = [&](Index count) {
        const Calibration found =
            calibrate(campaign, measure_at_random(campaign, truth, count, 4), without_folds());
        Estimate not_learned = found.estimate;
        not_learned.spread.reset();
        EXPECT_EQ(with_earlier(campaign, {not_learned}).known_within.error_size, error_size_factor);
        return with_earlier(campaign, {found.estimate}).known_within.error_size;
    };
    const double few = within_of(6);
    const double many = within_of(40);
    EXPECT_LT(many, few);
    EXPECT_LT(few, error_size_factor);
    EXPECT_GT(many, 1.2);
}

}  // namespace
}  // namespace posewise
