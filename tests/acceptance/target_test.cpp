// How many poses a target needs, on the designs that are shipped.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <vector>

#include "../../src/core/elementary.hpp"
#include "../../src/core/statistics.hpp"
#include "../../src/model/sampling.hpp"
#include "../../src/task/calibration/inputs.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/io/campaign_file.hpp"
#include "posewise/io/documents.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/report/reports.hpp"
#include "posewise/task/planning.hpp"
#include "support/campaign_from.hpp"
#include "support/campaigns.hpp"
#include "support/places.hpp"

namespace posewise {
namespace {

/// The RMS of robots drawn one by one from the linear model: each parameter a normal number, sizes
/// and model error log-normal.
VectorXd draw_rms(const PositionErrors& errors, const Campaign& campaign, const MatrixXd& M,
                  const InformationByNoise& by_noise) {
    const PredictedAccuracy accuracy = predict_accuracy(errors, M, campaign, by_noise);
    const MatrixXd spread = M.llt().matrixL().solve(errors.by_parameters.matrix.transpose());
    const MatrixXd square =
        3 * spread * spread.transpose() / static_cast<double>(errors.by_parameters.matrix.rows());
    const VectorXd squares = Eigen::SelfAdjointEigenSolver<MatrixXd>(square).eigenvalues();
    VectorXd drawn(200000);
    RandomStream random(11);
    for (double& rms : drawn) {
        double sum = 0;
        for (const double one : squares) {
            const double z = random.normal();
            sum += one * z * z;
        }
        const double model = std::pow(campaign.known_within.model_error, random.normal());
        const double size = std::pow(campaign.known_within.error_size, random.normal());
        const double left = model * accuracy.left_over;
        rms = std::sqrt(accuracy.growth(model * model, size * size) * sum + left * left);
    }
    return drawn;
}

TEST(PredictRange, AgreesWithRobotsDrawnOneByOne) {
    for (const char* const name :
         {"fanuc_r2000ic_165f/campaign.yaml", "abb_irb120/planning.yaml", "ur10/campaign.yaml"}) {
        const Campaign campaign = testing::design_campaign(name);
        const auto configurations = [&](Index count, std::uint64_t seed) {
            return detail::random_configurations(campaign.robot, count, seed);
        };
        const PositionErrors errors = make_position_errors(campaign, configurations(100, 2));
        MatrixXd M = prior_information(campaign);
        const RowMatrixXd poses = configurations(15, 1);
        M += information(make_blocks(campaign, campaign.nominal, poses));
        const InformationByNoise by_noise =
            information_by_noise(campaign, campaign.nominal, poses,
                                 RowMatrixXd::Ones(poses.rows(), campaign.sensor->target_count()));
        const VectorXd drawn = draw_rms(errors, campaign, M, by_noise);
        for (const double assurance : {0.5, 0.95, 0.99}) {
            const double direct = detail::quantile(drawn, assurance, detail::QuantileRule::Linear);
            const ErrorRange range =
                predict_range(errors, campaign, M, by_noise, ErrorQuantity::Rms, assurance);
            EXPECT_NEAR(range.assured, direct, 0.05 * direct) << name << ' ' << assurance;
        }
    }
}

/// Three joints and one target: 15 parameters, so that plans are quick.
Campaign small_arm() {
    using namespace testing;
    const auto R = Motion::Rotation;
    const Chain arm({{"q1", -170 * degree, 170 * degree},
                     {"q2", -90 * degree, 90 * degree},
                     {"q3", -120 * degree, 120 * degree}},
                    {driven(R, Axis::Z, 0), translation(Axis::X, 0.15), driven(R, Axis::Y, 1),
                     translation(Axis::X, 0.6), driven(R, Axis::Y, 2), translation(Axis::X, 0.5)});
    Campaign campaign = tracked_campaign(arm);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(1, std::nullopt), 5e-5);
    campaign.nominal.sensor = Vector3d(0.05, 0.03, 0.08);
    campaign.model_error = 1e-4;
    return with_robot(campaign, irreducible_model(campaign));
}

class Target : public ::testing::Test {
  protected:
    Target() {
        options_.pool_count = 200;
        options_.workspace_count = 20;
        options_.starts = 1;
        target_.limit = 0.86e-3;
    }
    TargetPlanning find() const { return plan_for_target(campaign_, options_, target_); }
    Index count() const { return find().planning.value().search.pose_count; }

    Campaign campaign_ = small_arm();
    PlanningOptions options_;
    TargetOptions target_;
};

TEST_F(Target, IsKeptByThePlanAndNotByOneOfAPoseLess) {
    const TargetPlanning found = find();
    ASSERT_EQ(found.ending, TargetEnding::Reached);
    const Planning& planning = *found.planning;
    EXPECT_LE(found.error->assured, 0.86e-3);
    EXPECT_TRUE(verify(planning.plan, campaign_, options_).is_right());
    const auto reach = [&](Index count) {
        options_.pose_count = count;
        const Planning plan = make_plan(campaign_, options_);
        return predict_range(plan.errors, campaign_, plan.information, plan.by_noise,
                             ErrorQuantity::Rms, 0.95)
            .assured;
    };
    EXPECT_EQ(reach(planning.search.pose_count), found.error->assured);
    EXPECT_GT(reach(planning.search.pose_count - 1), 0.86e-3);
    // The curve falls, and takes longer.
    double before = std::numeric_limits<double>::infinity();
    for (const CountPrediction& one : found.curve) {
        if (one.is_planned || !one.error) continue;
        EXPECT_LE(one.error->assured, before);
        EXPECT_GT(one.error->assured, found.floor.assured);
        before = one.error->assured;
    }
    EXPECT_GT(found.curve.size(), 4u);
    EXPECT_GT(found.curve.back().duration, planning.plan.duration);
}

TEST_F(Target, NeedsMorePosesTheSurerAndTheTighterItIs) {
    const Index at_95 = count();
    target_.assurance = 0.5;
    const Index at_50 = count();
    target_.assurance = 0.99;
    target_.limit = 1.6e-3;
    const Index loose_at_99 = count();
    target_.assurance = 0.95;
    const Index loose_at_95 = count();
    EXPECT_LT(at_50, at_95);
    EXPECT_LT(loose_at_95, at_95);
    EXPECT_LT(loose_at_95, loose_at_99);
}

TEST_F(Target, SaysHowFarTheNumberMayBeOff) {
    const auto counts_of = [&](double limit, double assurance) {
        target_.limit = limit;
        target_.assurance = assurance;
        return find();
    };
    const TargetPlanning found = counts_of(0.9e-3, 0.5);
    const CountRange& counts = found.counts.value();
    // Numbers of chosen poses: plans need about as many.
    const auto planned = [&](double assurance) {
        return static_cast<double>(counts_of(0.9e-3, assurance).planning.value().search.pose_count);
    };
    EXPECT_NEAR(static_cast<double>(counts.lower.value()), planned(0.05), 1.5);
    EXPECT_NEAR(static_cast<double>(counts.upper.value()), planned(0.95), 3.5);
    EXPECT_LT(counts.lower.value(), counts.upper.value());
    EXPECT_NE(format(found).find(fmt::format("\nenough:      {} new poses with 5 % probability, {} "
                                             "with 95 %; plan --poses 5, measure them",
                                             *counts.lower, *counts.upper)),
              std::string::npos)
        << format(found);

    const TargetPlanning sure = counts_of(0.9e-3, 0.95);  // what is planned counts, too
    EXPECT_LE(sure.counts.value().upper.value(), sure.planning.value().search.pose_count);

    const TargetPlanning low = counts_of(0.4e-3, 0.5);  // below the floor's 95 % end
    EXPECT_TRUE(low.counts.value().lower);
    EXPECT_FALSE(low.counts.value().upper);
    EXPECT_NE(format(low).find("no number with 95 % (floor 0.78"), std::string::npos)
        << format(low);
    const TargetPlanning tight = counts_of(0.785e-3, 0.5);
    EXPECT_FALSE(tight.counts.value().upper);
    EXPECT_NE(format(tight).find(fmt::format(", more than {} with 95 %; ", tight.counts->most)),
              std::string::npos)
        << format(tight);
    target_.limit.reset();
    target_.duration = 60;
    EXPECT_FALSE(find().counts);
}

TEST_F(Target, OfTheLargestErrorOrWithPosesMissingNeedsMore) {
    const Index rms = count();
    target_.robust_to = 1;
    const TargetPlanning robust = find();
    EXPECT_GT(robust.planning->search.pose_count, rms);
    EXPECT_LE(robust.error->assured, 0.86e-3);
    target_.robust_to = 0;
    target_.limit = 1.6e-3;
    const Index loose = count();
    target_.quantity = ErrorQuantity::Max;
    EXPECT_GT(count(), loose);
}

TEST_F(Target, BelowTheFloorIsNotReachedByAnyNumber) {
    target_.limit = 0.5e-3;
    const TargetPlanning below = find();
    EXPECT_EQ(below.ending, TargetEnding::BelowFloor);
    EXPECT_FALSE(below.planning.has_value());
    // Of a model error of 0.1 mm a coordinate, known within a factor of 2.5.
    EXPECT_NEAR(below.floor.assured, std::sqrt(3.0) * 1e-4 * std::pow(2.5, 1.645), 2e-6);
    EXPECT_NEAR(below.floor_of_known_model_error, std::sqrt(3.0) * 1e-4, 1e-9);
    // Below the floor of even a small model error, 3.84e-5 m, no number is looked for.
    target_.limit = 3.8e-5;
    EXPECT_FALSE(find().counts);
    EXPECT_NEAR(below.floor.lower, 3.837e-5, 1e-7);
    target_.limit = 0.8e-3;
    target_.most_poses = 12;
    const TargetPlanning few = find();
    EXPECT_EQ(few.ending, TargetEnding::TooManyPoses);
    EXPECT_FALSE(few.planning.has_value());
    ASSERT_TRUE(few.counts);
    EXPECT_EQ(few.counts->most, 12);
    EXPECT_FALSE(few.counts->upper);
    ASSERT_FALSE(few.curve.empty());
    EXPECT_GT(few.curve.back().error->assured, 0.8e-3);
}

TEST_F(Target, ThatIsMissedTellsWhatWouldDoWithLuck) {
    target_.limit = 0.5e-3;
    const TargetPlanning below = find();
    EXPECT_EQ(below.ending, TargetEnding::BelowFloor);
    ASSERT_TRUE(below.counts && below.counts->lower) << describe_shortfall(below);
    EXPECT_FALSE(below.counts->upper);
    for (const CountPrediction& one : below.curve) {
        if (!one.error) continue;
        EXPECT_EQ(one.error->lower <= 0.5e-3, one.pose_count >= *below.counts->lower)
            << one.pose_count;
    }
    const std::string text = describe_shortfall(below);
    EXPECT_NE(text.find("enough are "), std::string::npos) << text;
    EXPECT_NE(text.find(" with 5 % probability, no number with 95 % (floor 0.78"),
              std::string::npos)
        << text;
}

TEST_F(Target, AsManyPosesAsFitInTheTime) {
    campaign_.cell.dwell = 4;
    options_.repeats = 3;
    target_ = {};
    target_.duration = 120;
    const TargetPlanning found = find();
    const Planning& planning = found.planning.value();
    const auto poses = static_cast<double>(planning.plan.poses.size());
    EXPECT_NEAR(planning.plan.duration, planning.tour.time + 12 * poses, 1e-9);
    EXPECT_LE(planning.plan.duration, 120);
    options_.pose_count = planning.search.pose_count + 1;
    EXPECT_GT(make_plan(campaign_, options_).plan.duration, 120);
    // Beside a limit.
    target_.limit = 1e-3;
    EXPECT_EQ(find().ending, TargetEnding::Reached);
    target_.limit = 0.8e-3;
    const TargetPlanning long_one = find();
    EXPECT_EQ(long_one.ending, TargetEnding::TooLong);
    EXPECT_FALSE(long_one.planning.has_value());
}

/// A plan cut short does not tell that its number of poses is not enough.
TEST_F(Target, StoppedEarlyHasNoEvidenceThatFewerPosesDoNot) {
    std::atomic<bool> is_interrupted = false;
    Index calls = 0;
    Index last_call = 0;
    Index done = 0;
    std::vector<Index> begins;  // of full plans
    options_.stop.interrupted = &is_interrupted;
    options_.progress = [&](const Progress& state) {
        if (++calls == last_call) is_interrupted = true;
        if (calls == 1 || state.done < done) begins.push_back(calls);
        done = state.done;
    };
    const TargetPlanning whole = find();
    const Index count = whole.planning.value().search.pose_count;
    EXPECT_TRUE(whole.is_settled);
    EXPECT_EQ(whole.planning->plan.ending, Ending::Converged);
    EXPECT_EQ(format(whole).find("stopped early"), std::string::npos);
    const auto is_less = [&](const CountPrediction& one) {
        return one.is_planned && one.pose_count == count - 1;
    };
    EXPECT_TRUE(std::any_of(whole.curve.begin(), whole.curve.end(), is_less));

    // The last plan is that of a pose less.
    last_call = begins.back();
    calls = 0;
    const TargetPlanning found = find();
    EXPECT_EQ(found.planning.value().search.pose_count, count);
    EXPECT_EQ(found.error->assured, whole.error->assured);
    EXPECT_FALSE(found.is_settled);
    EXPECT_EQ(found.planning->plan.ending, Ending::Interrupted);
    EXPECT_FALSE(std::any_of(found.curve.begin(), found.curve.end(), is_less));
    const std::string text = format(found);
    EXPECT_EQ(text.find(fmt::format(" ({}: ", count - 1)), std::string::npos) << text;
    EXPECT_NE(text.find("; stopped early: fewer may do"), std::string::npos) << text;
    EXPECT_NE(io::to_json(found, "p.json").find("\"is_settled\": false"), std::string::npos);
}

TEST_F(Target, RefusesWhatNoNumberOfPosesCanMeet) {
    const auto refuses = [&](auto&& change, const std::string& words) {
        TargetOptions changed = target_;
        change(changed);
        try {
            plan_for_target(campaign_, options_, changed);
            ADD_FAILURE() << words;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
        }
    };
    for (const double limit : {0.0, -1e-3, std::nan(""), double(INFINITY)}) {
        refuses([&](TargetOptions& target) { target.limit = limit; }, "must be positive");
        refuses([&](TargetOptions& target) { target.duration = limit; }, "must be positive");
    }
    for (const double assurance : {0.0, 1.0, std::nan("")}) {
        refuses([&](TargetOptions& target) { target.assurance = assurance; }, "assurance");
    }
    refuses([](TargetOptions& target) { target.limit.reset(); }, "neither");
    refuses([](TargetOptions& target) { target.robust_to = -1; }, "not negative");
    refuses(
        [](TargetOptions& target) {
            target.limit.reset();
            target.duration = 0.5;
        },
        "too short");
}

}  // namespace
}  // namespace posewise
