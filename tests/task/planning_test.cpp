#include "posewise/task/planning.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "posewise/core/errors.hpp"
#include "support/cells.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

class MakePlan : public ::testing::Test {
  protected:
    MakePlan() {
        campaign_.cell = testing::demo_cell();
        campaign_.spread.is_prior = true;
        options_.pose_count = 4;
        options_.pool_count = 300;
        options_.starts = 1;
        options_.workspace_count = 20;
    }
    Campaign campaign_ = testing::cell_campaign();
    PlanningOptions options_;
};

TEST_F(MakePlan, IsVerifiedWithoutAnyFile) {
    const Planning planning = make_plan(campaign_, options_);
    const Plan& plan = planning.plan;
    ASSERT_EQ(plan.poses.size(), 4U);
    EXPECT_TRUE(plan.is_continuous());
    EXPECT_GE(plan.value, plan.choice_value);
    EXPECT_EQ(plan.standard_deviations.size(),
              static_cast<std::size_t>(parameter_count(campaign_)));
    EXPECT_TRUE(verify(plan, campaign_, options_).is_right());
    EXPECT_NEAR(plan.value_rms.value(), plan.predicted->rms, 1e-9 * plan.predicted->rms);
    Plan edited = plan;
    edited.poses[2].configuration[1] = 50;
    edited.predicted->rms *= 1.01;
    const auto wrong = verify(edited, campaign_, options_).wrong();
    EXPECT_NE(std::find(wrong.begin(), wrong.end(), "poses"), wrong.end());
    EXPECT_NE(std::find(wrong.begin(), wrong.end(), "RMS/mm"), wrong.end());
    edited.campaign = "another";
    EXPECT_THROW(verify(edited, campaign_, options_), InputError);
    // On the way there, too.
    edited = plan;
    edited.poses[2].via = plan.poses[1].configuration;
    EXPECT_TRUE(verify(edited, campaign_, options_).is_right());
    (*edited.poses[2].via)[1] = 50;
    EXPECT_EQ(verify(edited, campaign_, options_).wrong(), std::vector<std::string>{"poses"});
    edited.poses[2].via->setZero();
    (*edited.poses[2].via)[1] = 1;  // the arm lies on the table
    EXPECT_EQ(verify(edited, campaign_, options_).wrong(), std::vector<std::string>{"poses"});
}

/// What the model lacks is the same at the same pose, so it must not be measured there twice.
TEST_F(MakePlan, HasNoPoseTwiceWhereTheModelLacksSomething) {
    const auto least_distance = [&] {
        const std::vector<PlannedPose> poses = make_plan(campaign_, options_).plan.poses;
        double least = std::numeric_limits<double>::infinity();
        for (auto a = poses.begin(); a != poses.end(); ++a) {
            for (auto b = a + 1; b != poses.end(); ++b) {
                least = std::min(least, joint_distance(a->configuration, b->configuration));
            }
        }
        return least;
    };
    campaign_ = with_robot(campaign_, without_parameters(campaign_.robot));
    campaign_.cell = {};
    for (const Index joint : {0, 1, 2, 3}) campaign_.cell.fixed_joints[joint] = 0;
    options_.pose_count = 12;
    campaign_.model_error = campaign_.model_error_orientation = 0;
    EXPECT_LT(least_distance(), to_radians(5));
    campaign_.model_error = 1e-4;
    EXPECT_GE(least_distance(), to_radians(5) - 1e-9);
}

TEST_F(MakePlan, KeepsSumsOfJointsAtEveryPoseAndOnTheWay) {
    const double degree = testing::degree;
    VectorXd coefficients = VectorXd::Zero(6);
    coefficients << 0, -1, 1, 0, 0, 0;
    campaign_.cell.joint_sums = {{"q3 - q2", coefficients, {-60 * degree, 35 * degree}}};
    // A beam that the arm must go round.
    campaign_.cell.keep_outs.push_back({"beam", Box{{0.7, -0.5, 0.4}, {2.9, -0.2, 3.2}}});
    campaign_.cell.home[0] = -60 * degree;
    campaign_.cell.sight->is_line_required = false;
    options_.pose_count = 12;
    options_.pool_count = 1500;
    options_.workspace_count = 5;
    const Planning planning = make_plan(campaign_, options_);
    EXPECT_TRUE(std::ranges::any_of(planning.plan.poses,
                                    [](const auto& pose) { return pose.via.has_value(); }));
    for (const PlannedPose& pose : planning.plan.poses) {
        for (const VectorXd& q : {pose.via.value_or(pose.configuration), pose.configuration}) {
            EXPECT_LE(q[2] - q[1], 33 * degree + 1e-9);  // less the margin
            EXPECT_GE(q[2] - q[1], -58 * degree - 1e-9);
        }
    }
    EXPECT_TRUE(verify(planning.plan, campaign_, options_).is_right());
    Plan edited = planning.plan;
    edited.poses[1].configuration[2] = edited.poses[1].configuration[1] + 40 * degree;
    const auto wrong = verify(edited, campaign_, options_).wrong();
    EXPECT_NE(std::find(wrong.begin(), wrong.end(), "poses"), wrong.end());
}

TEST_F(MakePlan, TakesTheTimeOfWhatIsDoneByHand) {
    Cell& cell = campaign_.cell;
    cell.dwell = 2;
    cell.settle = 1;
    const Planning once = make_plan(campaign_, options_);
    EXPECT_NEAR(once.plan.duration, once.tour.time + 4 * 3, 1e-9);
    const auto time = [&](double target_change) {
        cell.target_change = target_change;
        const Planning planning = judge_again(once.plan, campaign_, options_);
        return std::pair(planning.plan.duration, planning.plan.is_target_changed_at_poses);
    };
    const double moves = once.tour.time;
    EXPECT_EQ(campaign_.sensor->target_count(), 3);
    // Targets that a pose does not show take no time.
    double visible = 0;
    for (const PlannedPose& pose : once.plan.poses) {
        visible += static_cast<double>(pose.targets.size());
    }
    EXPECT_LT(visible, 4 * 3);
    const auto [in_runs, at_end] = time(1000);
    EXPECT_NEAR(in_runs, 3 * moves + visible * 3 + 2 * 1000, 1e-9);
    EXPECT_FALSE(at_end);
    const auto [at_poses, at_each] = time(1e-3);
    EXPECT_NEAR(at_poses, moves + 4 + visible * 2 + (visible - 4) * 1e-3, 1e-9);
    EXPECT_TRUE(at_each);
    cell.target_change = 0;
    EXPECT_EQ(judge_again(once.plan, campaign_, options_).plan.target_runs, 1);
    cell.stations = 2;
    cell.station_change = 600;
    EXPECT_NEAR(time(0).first, 2 * once.plan.duration + 600, 1e-9);
}

TEST_F(MakePlan, IsJudgedAgainFromWhatItsFileHolds) {
    campaign_.cell.dwell = 2;
    const Planning made = make_plan(campaign_, options_);
    Plan kept = made.plan;
    kept.predicted->worst_rms = 0;  // which no file has
    kept.value_rms.reset();
    const Planning judged = judge_again(kept, campaign_, options_);
    const auto agree = [](double a, double b) {  // both may be infinite: left unidentified
        EXPECT_TRUE(a == b || std::abs(a - b) <= 1e-6 * std::abs(b)) << a << ' ' << b;
    };
    agree(judged.plan.predicted->worst_rms, made.plan.predicted->worst_rms);
    agree(judged.plan.value_rms.value(), made.plan.value_rms.value());
    agree(judged.budget.prior, made.budget.prior);
    agree(judged.budget.model, made.budget.model);
    agree(judged.budget.total, made.budget.total);
    agree(judged.plan.duration, made.plan.duration);
    ASSERT_EQ(judged.drop_outs.size(), 1U);
    EXPECT_EQ(judged.drop_outs[0].pose, made.drop_outs.at(0).pose);
    ASSERT_EQ(judged.without_each.size(), 4U);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_EQ(judged.without_each[k].pose, made.without_each[k].pose);
        agree(judged.without_each[k].rms, made.without_each[k].rms);
    }
    EXPECT_EQ(judged.search.pose_count, 4);
    EXPECT_EQ(judged.workspace_count, 20);
}

TEST_F(MakePlan, PredictsHalfAndTwiceAsManyPoses) {
    const auto counts = predict_other_counts(make_plan(campaign_, options_));
    ASSERT_EQ(counts.size(), 4U);
    EXPECT_EQ(counts[0].pose_count, 2);
    EXPECT_EQ(counts[1].pose_count, 4);
    EXPECT_TRUE(counts[2].is_planned);
    EXPECT_EQ(counts[3].pose_count, 8);
    EXPECT_FALSE(counts[0].accuracy);  // two poses do not identify the parameters
    ASSERT_TRUE(counts[2].accuracy && counts[3].accuracy);
    EXPECT_LT(counts[3].accuracy->rms, counts[2].accuracy->rms);
}

TEST_F(MakePlan, RepairsWithoutMovingTheOthers) {
    const Plan first = make_plan(campaign_, options_).plan;
    options_.repaired = first;
    options_.pose_count = 0;
    options_.dropped = {"p2"};
    const Plan repaired = make_plan(campaign_, options_).plan;
    ASSERT_EQ(repaired.poses.size(), 4U);
    int kept = 0;
    for (const PlannedPose& pose : repaired.poses) {
        EXPECT_NE(pose.id, "p2");
        if (!pose.is_kept) continue;
        ++kept;
        const auto old =
            std::find_if(first.poses.begin(), first.poses.end(),
                         [&](const PlannedPose& other) { return other.id == pose.id; });
        ASSERT_NE(old, first.poses.end());
        EXPECT_EQ(old->configuration, pose.configuration);
    }
    EXPECT_EQ(kept, 3);
    options_.dropped = {"p77"};
    EXPECT_THROW(make_plan(campaign_, options_), InputError);
}

TEST_F(MakePlan, DrawsPosesToVerifyThatAreFeasibleAndApartFromAllOthers) {
    const Plan without = make_plan(campaign_, options_).plan;
    EXPECT_TRUE(without.verification.empty());
    options_.verification_count = 6;
    const Planning planning = make_plan(campaign_, options_);
    const Plan& plan = planning.plan;
    // The others stay as they are.
    ASSERT_EQ(plan.poses.size(), without.poses.size());
    for (std::size_t i = 0; i < plan.poses.size(); ++i) {
        EXPECT_EQ(plan.poses[i].configuration, without.poses[i].configuration);
    }
    EXPECT_EQ(plan.visiting_time, without.visiting_time);
    EXPECT_EQ(plan.predicted->rms, without.predicted->rms);
    ASSERT_EQ(plan.verification.size(), 6U);
    EXPECT_GT(plan.verification_time, 0);
    const Constraints constraints(campaign_, campaign_.cell);
    std::vector<PlannedPose> others = plan.poses;
    for (const PlannedPose& pose : plan.verification) {
        EXPECT_EQ(pose.id.front(), 'v');
        EXPECT_TRUE(constraints.check(pose.configuration).is_feasible()) << pose.id;
        EXPECT_FALSE(pose.targets.empty());
        for (const PlannedPose& other : others) {
            EXPECT_GE(joint_distance(pose.configuration, other.configuration), 5 * testing::degree);
        }
        others.push_back(pose);
    }
    EXPECT_TRUE(verify(plan, campaign_, options_).is_right());
    Plan edited = plan;
    edited.verification[2].configuration = plan.poses[1].configuration;
    edited.verification[2].targets = plan.poses[1].targets;
    EXPECT_EQ(verify(edited, campaign_, options_).wrong(),
              std::vector<std::string>{"verification"});
}

TEST_F(MakePlan, DrawsPosesToVerifyWhereTheRobotShallBeAccurate) {
    options_.verification_count = 3;
    options_.workspace_box_mm = {1000, -1000, 0, 2500, 1000, 1500};
    options_.workspace_count = 200;
    const Planning planning = make_plan(campaign_, options_);
    ASSERT_EQ(planning.plan.verification.size(), 3U);
    for (const PlannedPose& pose : planning.plan.verification) {
        for (Index target = 0; target < 3; ++target) {
            const Vector3d place =
                campaign_.robot.base_from_flange(pose.configuration, campaign_.nominal.robot) *
                campaign_.sensor->target_position(target, campaign_.nominal.sensor);
            EXPECT_TRUE((place.array() >= Eigen::Array3d(1, -1, 0)).all() &&
                        (place.array() <= Eigen::Array3d(2.5, 1, 1.5)).all())
                << place.transpose();
        }
    }
}

TEST_F(MakePlan, KeepsPosesToVerifyOfThePlanItRepairs) {
    options_.verification_count = 3;
    const Plan first = make_plan(campaign_, options_).plan;
    options_.repaired = first;
    options_.pose_count = 0;
    options_.dropped = {"p2"};
    options_.verification_count = 5;
    const Plan repaired = make_plan(campaign_, options_).plan;
    EXPECT_EQ(repaired.verification.size(), 5U);
    const auto has = [&](const PlannedPose& pose) {
        return std::ranges::any_of(repaired.verification, [&](const PlannedPose& other) {
            return other.id == pose.id && other.configuration == pose.configuration;
        });
    };
    EXPECT_TRUE(std::ranges::all_of(first.verification, has));
    options_.dropped = {"v2"};
    EXPECT_EQ(
        testing::input_error_of([&] { make_plan(campaign_, options_); }),
        "`dropped` v2: is a pose to verify, which need not be replaced; leave it out of what is "
        "measured");
}

TEST_F(MakePlan, FindsPosesToVerifyAmongThoseMeasured) {
    options_.verification_count = 3;
    Plan plan = make_plan(campaign_, options_).plan;
    Measurements measured;
    for (const auto* list : {&plan.verification, &plan.poses}) {
        for (const PlannedPose& pose : *list) {
            if (pose.id == "v2") continue;  // was not measured
            measured.ids.push_back(pose.id);
            measured.configurations.conservativeResize(std::ssize(measured.ids), 6);
            measured.configurations.bottomRows(1) = pose.configuration.transpose();
        }
    }
    const auto found = find_verification(plan, campaign_, measured);
    EXPECT_EQ(found, (std::vector<Index>{0, 1}));
    EXPECT_EQ(find_planned(plan, campaign_, measured), (std::vector<Index>{2, 3, 4, 5}));
    EXPECT_EQ(find_verification(plan, campaign_, measured, {measured.ids[0]}),
              (std::vector<Index>{1}));
    measured.configurations(1, 2) += 0.1;
    EXPECT_THROW(find_verification(plan, campaign_, measured), InputError);
}

TEST_F(MakePlan, LetsAnExceptionOfTheCallbackThrough) {
    options_.progress = [](const Progress&) { throw std::domain_error("enough"); };
    EXPECT_THROW(make_plan(campaign_, options_), std::domain_error);
}

}  // namespace
}  // namespace posewise
