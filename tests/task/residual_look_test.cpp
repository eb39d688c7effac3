#include <gtest/gtest.h>

#include <cmath>

#include "posewise/calibrator/identification.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/doubts.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

class LookAtResiduals : public ::testing::Test {
  protected:
    LookAtResiduals() {
        measured_ =
            simulate(campaign_, {.pose_count = 30, .repeats = 2, .truth_seed = 3}).measurements;
    }
    ResidualLook look(const Measurements& measured) const {
        const Parameters start = register_base_and_targets(campaign_, measured).parameters;
        return look_at_residuals(campaign_, measured, identify(campaign_, measured, start));
    }
    ResidualLook look() const { return look(measured_); }
    /// Samples of configurations from this one on.
    auto observations_from(Index configuration) {
        const Index first = measured_.first_sample[static_cast<std::size_t>(configuration)];
        return measured_.observations.bottomRows(measured_.observations.rows() - first);
    }

    Campaign campaign_ = testing::tracked_campaign(testing::fanuc());
    Measurements measured_;
};

TEST_F(LookAtResiduals, FindsNothingInWhatTheModelExplains) { EXPECT_TRUE(look().is_empty()); }

TEST_F(LookAtResiduals, SaysNothingOfFewConfigurations) {
    const Measurements few = take(measured_, {0, 1, 2, 3, 4, 5, 6});
    EXPECT_TRUE(look(few).is_empty());
}

TEST_F(LookAtResiduals, NamesTheConfigurationThatTheOthersContradict) {
    measured_.configurations(5, 2) += 5 * 3.14159265 / 180;
    const ResidualLook found = look();
    ASSERT_TRUE(found.outlying);
    EXPECT_EQ(found.outlying->ids, std::vector<std::string>{measured_.ids[5]});
    EXPECT_LT(found.outlying->squares_left, 0.01);
    EXPECT_GT(found.outlying->held_out.before, 20 * found.outlying->held_out.after);
    EXPECT_FALSE(found.outlying->exchanged);
    EXPECT_TRUE(found.changes.empty());
}

TEST_F(LookAtResiduals, TellsThatTwoRowsAreExchanged) {
    measured_.configurations.row(4).swap(measured_.configurations.row(11));
    const ResidualLook found = look();
    ASSERT_TRUE(found.outlying);
    ASSERT_TRUE(found.outlying->exchanged);
    EXPECT_EQ(found.outlying->exchanged->first, measured_.ids[4]);
    EXPECT_EQ(found.outlying->exchanged->second, measured_.ids[11]);
}

TEST_F(LookAtResiduals, FindsWhereTheInstrumentMovedAndByHowMuch) {
    const Vector3d step(1.2e-3, -1.6e-3, 0);
    for (Index target = 0; target < 3; ++target) {
        observations_from(18).middleCols(3 * target, 3).rowwise() += step.transpose();
    }
    const ResidualLook found = look();
    ASSERT_EQ(found.changes.size(), 1U);
    const SetUpChange& change = found.changes.front();
    EXPECT_EQ(change.part, "base");
    EXPECT_FALSE(change.is_gradual);
    EXPECT_EQ(change.last_before, measured_.ids[17]);
    EXPECT_EQ(change.first_after, measured_.ids[18]);
    EXPECT_LT((change.translation - step).norm(), 0.2e-3);
    EXPECT_EQ(change.rotation.norm(), 0);
    EXPECT_EQ(change.excluded, measured_.ids[18] + "-" + measured_.ids[29]);
    EXPECT_LT(change.held_out.after, 0.5 * change.held_out.before);
    EXPECT_FALSE(found.outlying);
}

TEST_F(LookAtResiduals, TellsADriftFromAStep) {
    for (Index sample = 0; sample < measured_.observations.rows(); ++sample) {
        for (const Index z : {2, 5, 8}) {
            measured_.observations(sample, z) += 2e-3 * static_cast<double>(sample) / 60;
        }
    }
    const ResidualLook found = look();
    ASSERT_EQ(found.changes.size(), 1U);
    EXPECT_TRUE(found.changes.front().is_gradual);
    EXPECT_TRUE(found.changes.front().excluded.empty());
    EXPECT_NEAR(found.changes.front().translation.z(), 2e-3, 0.3e-3);
}

TEST_F(LookAtResiduals, NamesTheTargetThatSlipped) {
    const Vector3d slip(2e-3, 0, 1e-3);  // in the flange's frame
    const Parameters truth = draw_truth(campaign_, 3);
    for (Index i = 20; i < 30; ++i) {
        const VectorXd q = measured_.configurations.row(i).transpose();
        const Vector3d off = world_from_flange(campaign_, truth, q).linear() * slip;
        const Index first = measured_.first_sample[static_cast<std::size_t>(i)];
        measured_.observations.block(first, 3, 2, 3).rowwise() += off.transpose();
    }
    const ResidualLook found = look();
    ASSERT_EQ(found.changes.size(), 1U);
    EXPECT_EQ(found.changes.front().part, "target2");
    EXPECT_LT((found.changes.front().translation - slip).norm(), 0.2e-3);
    EXPECT_FALSE(found.changes.front().excluded.empty());
}

TEST_F(LookAtResiduals, NamesTheTargetWhoseReadingsAreShifted) {
    observations_from(20).col(3).array() += 2e-3;  // in the instrument's frame
    const ResidualLook found = look();
    ASSERT_EQ(found.changes.size(), 1U);
    EXPECT_EQ(found.changes.front().part, "readings of target2");
    EXPECT_NEAR(found.changes.front().translation.x(), 2e-3, 0.2e-3);
}

TEST_F(LookAtResiduals, SeesACommonFactorOfAllLengths) {
    measured_.observations *= 1.02;
    const ResidualLook found = look();
    ASSERT_TRUE(found.lengths);
    EXPECT_NEAR(found.lengths->excess, 0.02, 3 * found.lengths->deviation);
    EXPECT_LT(found.lengths->errors->after, 0.5 * found.lengths->errors->before);
}

TEST_F(LookAtResiduals, NamesTheJointWithBacklash) {
    const RowMatrixXd q = measured_.configurations;
    for (Index i = 1; i < q.rows(); ++i) {
        measured_.configurations(i, 1) += q(i, 1) > q(i - 1, 1) ? 5e-4 : -5e-4;
    }
    const ResidualLook found = look();
    ASSERT_EQ(found.joints.size(), 1U);
    EXPECT_EQ(found.joints.front().joint, campaign_.robot.joint(1).name);
    EXPECT_EQ(found.joints.front().kind, JointPattern::Kind::Backlash);
    EXPECT_NEAR(std::abs(found.joints.front().size), 1e-3, 2e-4);
    EXPECT_LT(found.joints.front().held_out.after, found.joints.front().held_out.before);
}

TEST_F(LookAtResiduals, SeesJointsThatWereRounded) {
    const double step = 0.1 * 3.14159265358979 / 180;
    // Commanded there, nothing is lost.
    Measurements exact = measured_;
    const RowMatrixXd rounded = (measured_.configurations / step).array().round() * step;
    exact = simulate_measurements(campaign_, draw_truth(campaign_, 3), rounded, 2, 5);
    EXPECT_FALSE(look(exact).rounded);
    measured_.configurations = rounded;
    const ResidualLook found = look();
    ASSERT_TRUE(found.rounded);
    EXPECT_NEAR(found.rounded->step, step, 1e-12);
    EXPECT_LT(found.rounded->held_out.after, found.rounded->held_out.before);
}

TEST_F(LookAtResiduals, SeesReadingsThatWereRounded) {
    measured_.observations = (measured_.observations / 1e-3).array().round() * 1e-3;
    const ResidualLook found = look();
    ASSERT_TRUE(found.rounded_readings);
    EXPECT_NEAR(found.rounded_readings->step, 1e-3, 1e-12);
    EXPECT_NEAR(found.rounded_readings->effect, 0.5e-3, 1e-12);
    EXPECT_FALSE(found.rounded);
}

TEST_F(LookAtResiduals, FindsTheRowFromWhichOneIsLost) {
    Measurements lost = take(measured_, all_but(30, {29}));
    EXPECT_FALSE(find_shifted_rows(campaign_, lost));
    for (Index i = 12; i < 29; ++i) {
        lost.configurations.row(i) = measured_.configurations.row(i + 1);
    }
    const auto found = find_shifted_rows(campaign_, lost);
    ASSERT_TRUE(found);
    EXPECT_LT(found->after, 0.1 * found->before);
    EXPECT_EQ(found->shift, 1);
}

}  // namespace
}  // namespace posewise
