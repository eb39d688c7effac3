#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "../../src/model/sampling.hpp"
#include "posewise/calibrator/identification.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"
#include "support/campaigns.hpp"

namespace posewise {
namespace {

using namespace detail;

using testing::tracked_campaign;

Chain fanuc_with_terms() {
    return with_harmonics(with_gravity_terms(testing::fanuc(), {0, 0, -1}, {}), {2}, {});
}

std::vector<std::string> names_of(const std::vector<ParameterSet>& sets) {
    std::vector<std::string> names;
    for (const ParameterSet& set : sets) names.push_back(set.name);
    return names;
}

/// Measurements of a robot that has the errors of the sets up to this one, and no others.
Measurements simulate_errors_of(const Campaign& campaign, const ParameterSet& set,
                                std::uint64_t seed) {
    Parameters truth = draw_truth(campaign, seed);
    const std::vector<std::string> names = campaign.robot.parameter_names();
    for (Index k = 0; k < truth.robot.size(); ++k) {
        const std::string& name = names[static_cast<std::size_t>(k)];
        const auto end = set.parameters.end();
        if (std::find(set.parameters.begin(), end, name) == end) truth.robot[k] = 0;
    }
    return simulate_measurements(campaign, truth, random_configurations(campaign.robot, 40, seed),
                                 1, seed);
}

const ModelTrial& recommended(const ModelSelection& selection) {
    return selection.trials.at(static_cast<std::size_t>(selection.recommended));
}

TEST(NestedParameterSets, HoldOneAnotherUpToTheWholeModel) {
    const Chain chain = fanuc_with_terms();
    const auto sets = nested_parameter_sets(chain);
    EXPECT_EQ(names_of(sets),
              (std::vector<std::string>{"base and targets", "+ joint offsets", "+ lengths",
                                        "+ other geometric", "+ gravity terms", "+ harmonics"}));
    EXPECT_TRUE(sets[0].parameters.empty());
    EXPECT_EQ(sets[1].parameters, (std::vector<std::string>{"dq2", "dq3", "dq4", "dq5"}));
    EXPECT_EQ(sets[3].parameters, testing::fanuc().parameter_names());
    for (std::size_t k = 1; k < sets.size(); ++k) {
        for (const std::string& name : sets[k - 1].parameters) {
            const auto& larger = sets[k].parameters;
            EXPECT_NE(std::find(larger.begin(), larger.end(), name), larger.end()) << name;
        }
    }
    EXPECT_EQ(sets.back().parameters, chain.parameter_names());
    EXPECT_EQ(nested_parameter_sets(without_parameters(chain)).size(), 1U);
}

ModelSelection select(const Campaign& campaign, const Measurements& measurements, Index folds,
                      const LevenbergMarquardtOptions& options = {}) {
    const Registration registered = register_base_and_targets(campaign, measurements);
    return select_model(campaign, measurements, registered.parameters, folds, options);
}

TEST(SelectModel, RecommendsTheSetThatMadeTheErrors) {
    const Campaign campaign = tracked_campaign(fanuc_with_terms());
    const auto sets = nested_parameter_sets(campaign.robot);
    for (const std::size_t truth : {1U, 3U, 4U}) {
        const Measurements measurements = simulate_errors_of(campaign, sets[truth], 10 + truth);
        const ModelSelection selection = select(campaign, measurements, 10);
        ASSERT_EQ(selection.trials.size(), sets.size());
        EXPECT_EQ(recommended(selection).set.name, sets[truth].name);
        EXPECT_GE(selection.best, selection.recommended);
        for (std::size_t k = 0; k < truth; ++k) {
            EXPECT_GT(selection.trials[k].held_out_rms,
                      recommended(selection).held_out_rms + recommended(selection).standard_error);
        }
        for (std::size_t k = 1; k < sets.size(); ++k) {  // a larger set always fits better
            EXPECT_LT(selection.trials[k].fit_rms, selection.trials[k - 1].fit_rms);
        }
    }
}

TEST(SelectModel, GivesTheHeldOutErrorsOfCrossValidation) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate(campaign, {16, 2, 7, 8}).measurements;
    const ModelSelection selection = select(campaign, measurements, 16);
    const CrossValidation held_out = cross_validate(campaign, measurements, campaign.nominal, 16);
    const ModelTrial& whole = selection.trials.back();
    EXPECT_EQ(whole.parameter_count, 33);
    EXPECT_NEAR(whole.held_out_rms, held_out.means.distance_rms, 1e-9);
    // Of means of equally many points the textbook's: standard deviation / sqrt(count).
    const VectorXd errors = held_out.squared_distances.rowwise().mean();
    const double of_mean = std::sqrt((errors.array() - errors.mean()).square().sum() / 15 / 16);
    EXPECT_NEAR(whole.standard_error, of_mean / (2 * whole.held_out_rms), 1e-9);
    EXPECT_NEAR(whole.fit_rms,
                identify(campaign, measurements, campaign.nominal).fit_means.distance_rms, 1e-9);
}

TEST(SelectModel, PassesOverSetsThatCannotBeIdentified) {
    Campaign campaign = tracked_campaign(testing::fanuc());
    const Measurements measurements = simulate(campaign, {24, 1, 7, 8}).measurements;
    std::vector<Element> elements = campaign.robot.elements();
    elements.insert(elements.begin() + 5, testing::translation(Axis::X, 0, "Tx2"));
    campaign = with_robot(campaign, Chain(campaign.robot.joints(), elements));
    const ModelSelection selection = select(campaign, measurements, 24);
    ASSERT_EQ(selection.trials.size(), 4U);
    EXPECT_EQ(selection.recommended, 1);
    EXPECT_EQ(selection.best, 1);
    for (const std::size_t k : {2U, 3U}) {
        EXPECT_NE(selection.trials[k].failure.find("Tx2"), std::string::npos);
    }
    EXPECT_TRUE(selection.trials[0].failure.empty());
}

TEST(SelectModel, RecommendsNothingIfNoFoldCanBeIdentified) {
    const Campaign campaign = tracked_campaign(testing::fanuc());
    const auto measurements = simulate(campaign, {3, 1, 7, 8}).measurements;
    const ModelSelection selection = select(campaign, measurements, 2);
    EXPECT_EQ(selection.best, -1);
    EXPECT_EQ(selection.recommended, -1);
    for (const ModelTrial& trial : selection.trials) EXPECT_FALSE(trial.failure.empty());
    EXPECT_THROW(select(campaign, measurements, 4), InputError);
}

TEST(SelectModel, UnderARobustLossIsNotMisledByOutliers) {
    const Campaign campaign = tracked_campaign(fanuc_with_terms());
    const auto sets = nested_parameter_sets(campaign.robot);
    Measurements measurements = simulate_errors_of(campaign, sets[3], 5);
    for (const Index i : {3, 17, 30}) measurements.observations(i, 4) += 5e-3;
    LevenbergMarquardtOptions options;
    options.loss.kind = LossKind::Cauchy;
    const ModelSelection robust = select(campaign, measurements, 10, options);
    ASSERT_EQ(robust.not_judged.size(), 3U);
    EXPECT_EQ(robust.not_judged[1].configuration, 17);
    EXPECT_EQ(robust.not_judged[1].target, 1);
    EXPECT_EQ(recommended(robust).set.name, "+ other geometric");
    EXPECT_LT(recommended(robust).held_out_rms, 3e-4);
    const ModelSelection squares = select(campaign, measurements, 10);
    EXPECT_GT(squares.trials[3].held_out_rms, 5e-4);
}

}  // namespace
}  // namespace posewise
