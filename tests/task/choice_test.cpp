#include "posewise/task/choice.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/constraints.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/selection/choice.hpp"
#include "posewise/task/planning.hpp"
#include "support/campaigns.hpp"
#include "support/cells.hpp"
#include "support/designs.hpp"
#include "support/robots.hpp"
#include "support/sensors.hpp"
#include "support/temporary_folder.hpp"

namespace posewise {
namespace {

ChoiceOptions choice_of(Index pose_count) {
    ChoiceOptions options;
    options.pose_count = pose_count;
    options.starts = 2;
    return options;
}

std::vector<std::string> ids_of(const Plan& plan) {
    std::vector<std::string> ids;
    for (const PlannedPose& pose : plan.poses) ids.push_back(pose.id);
    return ids;
}

TEST(ChooseFromBlocks, IsTheSelectionWithNames) {
    const Blocks candidates = test::random_blocks(30, 3, 4, 5);
    ChoiceOptions options = choice_of(6);
    options.repeat_limit = 2;
    const Plan plan = choose(candidates, options);
    SelectOptions select;
    select.pose_count = 6;
    select.starts = 2;
    select.repeat_limit = 2;
    const Choice choice = select_poses(candidates, select);
    EXPECT_EQ(plan.value, choice.value);
    EXPECT_EQ(plan.bound, choice.bound);
    std::vector<std::string> chosen;
    for (const PlannedPose& pose : plan.poses) {
        chosen.insert(chosen.end(), static_cast<std::size_t>(pose.times), pose.id);
    }
    std::vector<std::string> expected;
    for (const Index pose : choice.poses) expected.push_back(std::to_string(pose));
    EXPECT_EQ(chosen, expected);
    EXPECT_TRUE(verify(plan, candidates, options).is_right());
}

TEST(ChooseFromBlocks, HoldsWhatWasMeasuredAndDoesNotChooseItAgain) {
    const Blocks candidates = test::random_blocks(30, 3, 4, 5);
    ChoiceOptions options = choice_of(3);
    const Plan before = choose(candidates, options);
    std::vector<Index> measured;
    for (const std::string& id : ids_of(before)) measured.push_back(std::stol(id));
    options.held_blocks = take(candidates, measured);
    const Plan after = choose(candidates, options);
    EXPECT_GT(after.value, before.value);
    for (const std::string& id : ids_of(after)) {
        for (const std::string& other : ids_of(before)) EXPECT_NE(id, other);
    }
}

/// The demonstration cell with a prior, so that few poses are enough.
Campaign campaign_in_cell() {
    Campaign campaign = testing::cell_campaign();
    campaign.cell = testing::demo_cell();
    campaign.spread.is_prior = true;
    return campaign;
}

TEST(RandomCandidates, AreOnlyWhereTheCellAllows) {
    const Campaign campaign = campaign_in_cell();
    const Candidates candidates = random_candidates(campaign, 120, 1);
    const Constraints constraints(campaign, campaign.cell);
    EXPECT_TRUE(find_violations(constraints, candidates.configurations).rows.empty());
    for (Index i = 0; i < 120; ++i) {
        const SeenTargets seen = constraints.seen(candidates.configurations.row(i).transpose());
        EXPECT_TRUE(((candidates.share.row(i).array() > 0) == seen).all());
    }
    EXPECT_EQ(random_candidates(campaign, 30, 1).configurations,
              candidates.configurations.topRows(30));
    const Plan plan = choose(campaign, candidates, choice_of(8));
    EXPECT_TRUE(plan.cell_doubts.empty());
    EXPECT_TRUE(verify(plan, campaign, candidates, choice_of(8)).is_right());
}

TEST(ChooseFromAList, TakesNothingThatTheCellDoesNotAllow) {
    const Campaign campaign = campaign_in_cell();
    const Constraints constraints(campaign, campaign.cell);
    Campaign free = campaign;
    free.cell = {};
    Candidates listed = random_candidates(free, 400, 5);
    listed.kind = CandidateKind::Configurations;
    const auto violations = find_violations(constraints, listed.configurations);
    ASSERT_GT(violations.rows.size(), 100U);
    ASSERT_LT(violations.rows.size(), 390U);
    const Plan plan = choose(campaign, listed, choice_of(6));
    for (const PlannedPose& pose : plan.poses) {
        EXPECT_GE(constraints.margin(pose.configuration), -1e-9) << pose.id;
    }
    ASSERT_EQ(plan.cell_doubts.size(), 1U);
    EXPECT_NE(plan.cell_doubts[0].find(" of 400 configurations violate the campaign's cell: "),
              std::string::npos);
    EXPECT_TRUE(verify(plan, campaign, listed, choice_of(6)).is_right());
}

ApproximateDesign weights_of(const Blocks& candidates, const ChoiceOptions& options) {
    return relax_choice(candidates, options);
}

/// Two directions, one seen twice as well: D shares the poses evenly among them, A gives the weak
/// one what makes w1 / w2 = s2 / s1 [Fedorov 1972].
TEST(RelaxChoice, FindsTheWeightsThatAreKnown) {
    RowMatrixXd matrix(3, 2);
    matrix << 2, 0, 0, 1, 0.5, 0.25;  // the last tells less than both
    const Blocks candidates = make_equal_blocks(matrix, 1);
    ChoiceOptions options = choice_of(6);
    options.repeat_limit = 6;
    const ApproximateDesign d = weights_of(candidates, options);
    ASSERT_EQ(d.weights.size(), 2u);
    EXPECT_NEAR(d.weights[0].weight, 3, 1e-3);
    EXPECT_NEAR(d.value, std::log(4.0 * 3 * 3), 1e-4);
    EXPECT_GE(d.bound, std::log(4.0 * 3 * 3));
    EXPECT_NEAR(d.efficiency, 1, 1e-4);
    options.criterion = Criterion::A;
    const ApproximateDesign a = weights_of(candidates, options);
    EXPECT_EQ(a.weights[0].id, "1");
    EXPECT_NEAR(a.weights[0].weight, 4, 1e-2);
    EXPECT_NEAR(a.weights[1].weight, 2, 1e-2);
}

TEST(RelaxChoice, BoundsEveryChoiceAndKeepsTheRepeatLimit) {
    const Blocks candidates = test::random_blocks(30, 3, 4, 5);
    for (const Criterion criterion : all_criteria) {
        ChoiceOptions options = choice_of(6);
        options.criterion = criterion;
        const Plan plan = choose(candidates, options);
        const ApproximateDesign design = weights_of(candidates, options);
        EXPECT_GE(design.bound, plan.value) << criterion_name(criterion);
        EXPECT_GE(design.bound, design.value);
        EXPECT_EQ(design.candidate_count, 30);
        double sum = 0;
        for (const auto& [id, weight] : design.weights) {
            EXPECT_GT(weight, 0);
            EXPECT_LE(weight, 1 + 1e-12);
            EXPECT_LE(weight, design.weights.front().weight);
            sum += weight;
        }
        EXPECT_NEAR(sum, 6, 1e-9);
    }
}

TEST(RelaxChoice, RefusesCandidatesWhoseInformationCannotBeToldApartFromNone) {
    RowMatrixXd matrix(4, 2);
    matrix << 1e40, 1, 2e40, 1, 3e40, 2, 1e40, 3;
    const Blocks candidates = make_equal_blocks(matrix, 1);
    for (const Criterion criterion : all_criteria) {
        ChoiceOptions options = choice_of(3);
        options.criterion = criterion;
        try {
            EXPECT_TRUE(std::isfinite(weights_of(candidates, options).value));
        } catch (const InputError& error) {
            const std::string words = error.what();
            EXPECT_NE(words.find("no weights were found that identify all 2 parameters"),
                      std::string::npos)
                << words;
        }
    }
}

TEST(RelaxChoice, RefusesWhatWeightsCannotKeep) {
    const Blocks candidates = test::random_blocks(30, 3, 4, 5);
    ChoiceOptions options = choice_of(6);
    options.groups.assign(30, 1);
    options.group_limit = 3;
    EXPECT_THROW(weights_of(candidates, options), InputError);
    EXPECT_THROW(weights_of(test::random_blocks(2, 1, 4, 5), choice_of(2)), InputError);  // unseen
}

class ChooseWithRobot : public ::testing::Test {
  protected:
    ChooseWithRobot() {
        SimulateOptions simulation;
        simulation.pose_count = 20;
        measured_ = simulate(campaign_, simulation).measurements;
    }
    Campaign campaign_ = testing::tracked_campaign(testing::ur_type());
    Measurements measured_;
};

TEST_F(ChooseWithRobot, SaysWhatItChoseAndWhatItRestsOn) {
    const Plan plan = choose(campaign_, measured_candidates(measured_), choice_of(10));
    EXPECT_EQ(plan.campaign, campaign_.name);
    EXPECT_EQ(plan.kind, CandidateKind::Measurements);
    EXPECT_EQ(plan.candidate_count, 20);
    EXPECT_EQ(plan.columns.front(), "q1_rad");
    ASSERT_EQ(plan.poses.size(), 10U);
    for (const PlannedPose& pose : plan.poses) {
        const auto found = std::find(measured_.ids.begin(), measured_.ids.end(), pose.id);
        ASSERT_NE(found, measured_.ids.end());
        EXPECT_EQ(pose.configuration,
                  measured_.configurations.row(found - measured_.ids.begin()).transpose());
        EXPECT_EQ(pose.targets, (std::vector<Index>{0, 1, 2}));
    }
    EXPECT_EQ(plan.assumptions.front().name, "sigma_m");
    EXPECT_EQ(plan.assumptions.front().value, 5e-5);
}

/// Behind a camera's image nothing is read, so nothing is predicted there.
TEST(ChooseViews, PredictsAtTestPosesWhatIsInView) {
    const Campaign campaign = testing::before_camera(testing::tracked_campaign(testing::fanuc()),
                                                     testing::fixed_camera());
    const Measurements seen =
        simulate(campaign, {.pose_count = 20, .repeats = 1, .truth_seed = 2, .seed = 7})
            .measurements;
    RowMatrixXd anywhere = detail::random_configurations(campaign.robot, 20, 3);
    ChoiceOptions options;
    options.criterion = Criterion::V;
    options.pose_count = 8;
    options.sources.test_poses = "tests.csv";
    options.test_poses = seen.configurations.topRows(5);
    const Plan plan = choose(campaign, measured_candidates(seen), options);
    EXPECT_TRUE(plan.cell_doubts.empty());
    VectorXd clearances(campaign.sensor->target_count());
    std::vector<Index> hidden;
    for (Index i = 0; i < anywhere.rows(); ++i) {
        campaign.sensor->view_clearances(
            world_from_flange(campaign, campaign.nominal, anywhere.row(i).transpose()),
            campaign.nominal.sensor, clearances);
        if (clearances.maxCoeff() < 0) hidden.push_back(i);
    }
    ASSERT_GE(hidden.size(), 2U);
    RowMatrixXd tests(7, campaign.robot.joint_count());
    tests << seen.configurations.topRows(5), anywhere.row(hidden[0]), anywhere.row(hidden[1]);
    options.test_poses = tests;
    const Plan same = choose(campaign, measured_candidates(seen), options);
    EXPECT_EQ(same.value, plan.value);
    EXPECT_EQ(same.cell_doubts,
              std::vector<std::string>{
                  "2 of 7 test poses show too little of what the sensor sees: left out"});
    options.test_poses = tests.bottomRows(2);
    EXPECT_THROW(choose(campaign, measured_candidates(seen), options), InputError);
}

TEST_F(ChooseWithRobot, SaysWhatTheValueOfVMeansInMetresWhereThatIsExact) {
    const Candidates candidates = measured_candidates(measured_);
    ChoiceOptions options = choice_of(10);
    options.criterion = Criterion::D;
    EXPECT_FALSE(choose(campaign_, candidates, options).value_rms);
    options.criterion = Criterion::V;
    const Plan plan = choose(campaign_, candidates, options);
    ASSERT_TRUE(plan.value_rms);
    EXPECT_NEAR(*plan.value_rms, plan.predicted->rms, 1e-9 * plan.predicted->rms);
    // At other poses than the candidates it is another number.
    options.test_poses = measured_.configurations.topRows(1);
    for (const Criterion criterion : {Criterion::V, Criterion::G}) {
        options.criterion = criterion;
        const Plan at_one = choose(campaign_, candidates, options);
        const double noise = std::hypot(5e-5, campaign_.model_error);
        EXPECT_NEAR(at_one.value_rms.value(), noise / std::sqrt(3 * at_one.value), 1e-9);
        EXPECT_NE(*at_one.value_rms, at_one.predicted->rms);
    }
    // Targets that some candidates do not show, and noise that is not alike.
    options.test_poses.resize(0, 0);
    Candidates hidden = candidates;
    hidden.measured.reset();
    hidden.share(3, 1) = 0;
    EXPECT_FALSE(choose(campaign_, hidden, options).value_rms);
    campaign_.sensor = std::make_shared<PointSensor>(
        std::vector<std::optional<Vector3d>>(3, std::nullopt), PerAxisNoise{{5e-5, 5e-5, 1e-4}});
    EXPECT_FALSE(choose(campaign_, candidates, options).value_rms);
}

/// Such a noise would mix the readings of one pose, so that V predicts them as they are.
TEST_F(ChooseWithRobot, PredictsPositionsWhereTheModelErrorMovesTheFlange) {
    campaign_.model_error_common = 0.9;
    const Candidates candidates = measured_candidates(measured_);
    ChoiceOptions options = choice_of(10);
    options.criterion = Criterion::V;
    const Plan plan = choose(campaign_, candidates, options);
    EXPECT_NEAR(plan.value_rms.value(), plan.predicted->rms, 1e-9 * plan.predicted->rms);
    EXPECT_NEAR(plan.predicted->left_over, std::sqrt(3.0) * campaign_.model_error, 1e-12);
    EXPECT_TRUE(verify(plan, campaign_, candidates, options).is_right());
    options.criterion = Criterion::G;
    const Plan worst = choose(campaign_, candidates, options);
    EXPECT_GE(worst.value_rms.value(), plan.value_rms.value());
    EXPECT_TRUE(verify(worst, campaign_, candidates, options).is_right());
    options.criterion = Criterion::D;
    EXPECT_TRUE(
        verify(choose(campaign_, candidates, options), campaign_, candidates, options).is_right());
}

TEST_F(ChooseWithRobot, IsVerifiedWithoutAnyFile) {
    const Candidates candidates = random_candidates(campaign_, 100, 3);
    const ChoiceOptions options = choice_of(10);
    const Plan plan = choose(campaign_, candidates, options);
    EXPECT_TRUE(verify(plan, campaign_, candidates, options).is_right());
    Plan edited = plan;
    edited.value += 1;
    edited.poses.back() = edited.poses.front();
    EXPECT_EQ(verify(edited, campaign_, candidates, options).wrong(),
              (std::vector<std::string>{"poses", "value", "bound", "proof", "efficiency"}));
    edited = plan;
    edited.campaign = "another";
    EXPECT_EQ(verify(edited, campaign_, candidates, options).obstacle,
              "campaign: is 'another'; must be a plan of '" + campaign_.name + "'");
    campaign_.model_error = 3e-4;
    const auto wrong = verify(plan, campaign_, candidates, options).wrong();
    EXPECT_EQ(wrong.back(), "assumes");
}

TEST_F(ChooseWithRobot, IsFoundAmongWhatWasMeasured) {
    const Plan plan = choose(campaign_, measured_candidates(measured_), choice_of(10));
    const auto planned = find_planned(plan, campaign_, measured_);
    ASSERT_EQ(planned.size(), 10U);
    for (std::size_t k = 0; k < 10; ++k) {
        EXPECT_EQ(measured_.ids[static_cast<std::size_t>(planned[k])], plan.poses[k].id);
    }
    EXPECT_EQ(find_planned(plan, campaign_, measured_, {plan.poses[3].id}).size(), 9U);
    const auto error_of = [&](const Plan& edited) {
        return testing::input_error_of([&] { find_planned(edited, campaign_, measured_); });
    };
    Plan edited = plan;
    edited.poses.pop_back();
    EXPECT_EQ(error_of(edited),
              "problem.pose_count: is 10, the plan has 9 poses; must be the plan as posewise wrote "
              "it");
    edited = plan;
    std::swap(edited.columns[0], edited.columns[1]);
    EXPECT_EQ(error_of(edited),
              "poses[0].joints: are in another order than those of the campaign's robot");
    edited = plan;
    edited.poses[2].configuration[1] += 0.01;
    const std::string error = error_of(edited);
    EXPECT_TRUE(error.starts_with("configuration '" + plan.poses[2].id + "' is planned with q2 = "))
        << error;
    EXPECT_NE(error.find("must be within 0.11"), std::string::npos) << error;
}

TEST_F(ChooseWithRobot, LetsAnExceptionOfTheCallbackThrough) {
    ChoiceOptions options = choice_of(20);
    options.criterion = Criterion::O4;  // whose bound proves nothing here: it is searched
    options.progress = [](const Progress&) { throw std::domain_error("enough"); };
    EXPECT_THROW(choose(campaign_, random_candidates(campaign_, 300, 3), options),
                 std::domain_error);
}

TEST_F(ChooseWithRobot, NeedsToKnowWhereTheBaseIs) {
    const Candidates candidates = random_candidates(campaign_, 50, 3);
    campaign_.has_nominal_base = false;
    EXPECT_EQ(choose(campaign_, candidates, choice_of(10)).poses.size(), 10U);  // nothing depends
    campaign_.joint_repeatability = VectorXd::Constant(campaign_.robot.joint_count(), 1e-5);
    EXPECT_THROW(choose(campaign_, candidates, choice_of(10)), InputError);
    ChoiceOptions options = choice_of(10);
    options.held = measured_;
    EXPECT_EQ(choose(campaign_, candidates, options).poses.size(), 10U);
}

TEST_F(ChooseWithRobot, StopsMakingRandomCandidatesWhenTimeIsUp) {
    ChoiceOptions options = choice_of(10);
    const std::atomic<bool> interrupted = true;
    options.stop.interrupted = &interrupted;
    const Candidates candidates = random_candidates(campaign_, 10000, 3);
    const Plan plan = choose(campaign_, candidates, options);
    EXPECT_LT(plan.candidate_count, 10000);
    EXPECT_EQ(plan.ending, Ending::Interrupted);
}

}  // namespace
}  // namespace posewise
