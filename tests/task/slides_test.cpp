#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "../../src/model/complete_model.hpp"
#include "../../src/model/sampling.hpp"
#include "posewise/core/random.hpp"
#include "posewise/jacobian/identification.hpp"
#include "posewise/task/calibration.hpp"
#include "posewise/task/planning.hpp"
#include "support/held_robot.hpp"

/// Robots on slides whose drives are periodic and whose columns bend, calibrated with what
/// ErrorModel::Full knows of that.
namespace posewise {
namespace {

using namespace testing;

/// With all errors of a robot of its kind, in front of an instrument of that noise (m).
Campaign full_campaign(const Chain& robot, double sigma) {
    Campaign campaign = with_robot(tracked_campaign(robot), detail::full_model(robot));
    campaign.spread = population_spread(robot);
    campaign.sensor =
        std::make_shared<PointSensor>(std::vector<std::optional<Vector3d>>(3, std::nullopt), sigma);
    return campaign;
}

/// At poses not measured, m.
double held_out_error(const Campaign& campaign, const Measurements& measured,
                      const Measurements& others) {
    CalibrationOptions options = without_folds();
    options.validation = &others;
    return calibrate(campaign, measured, options).validation->found.distance_rms;
}

/// The campaign without the errors whose names begin so.
Campaign without_errors(const Campaign& campaign, const std::string& beginning) {
    std::vector<std::string> kept;
    for (const std::string& name : campaign.robot.parameter_names()) {
        if (!name.starts_with(beginning)) kept.push_back(name);
    }
    return with_robot(campaign, keep_parameters(campaign.robot, kept));
}

// ---- The drive of a rail ----

/// The FANUC on a rail with a screw of 20 mm that is off by 8 um once a turn.
struct DrivenRail {
    static constexpr double sigma = 2e-6;  // m

    DrivenRail() {
        campaign.model_error = sigma;
        const auto names = campaign.robot.parameter_names();
        for (const char* const name :
             {"rail.sin(rail)", "rail.cos(rail)", "rail.sin(2rail)", "rail.cos(2rail)"}) {
            waves.push_back(std::ranges::find(names, name) - names.begin());
        }
    }
    /// Its other errors are drawn.
    Parameters draw(std::uint64_t seed) const {
        Parameters truth = draw_truth(campaign, seed);
        truth.robot(waves) = errors;
        return truth;
    }

    Campaign campaign =
        full_campaign(without_parameters(with_pitch(rail_with_fanuc(), 0, 0.02)), sigma);
    std::vector<Index> waves;                             ///< of the robot's parameters
    const Eigen::Vector4d errors{6.4e-6, -4.8e-6, 0, 0};  // m
};

TEST(RailDrive, IsFoundWithinItsDeviations) {
    const DrivenRail rail;
    const Campaign& campaign = rail.campaign;
    for (const std::uint64_t seed : {1, 2, 3}) {
        const Measurements measured = measure_at_random(campaign, rail.draw(seed), 40, seed);
        const Estimate estimate = calibrate(campaign, measured, without_folds()).estimate;
        ASSERT_EQ(estimate.ending, Ending::Converged);
        const VectorXd off = estimate.parameters.robot(rail.waves) - rail.errors;
        const Index begin = base_parameter_count(campaign);
        const Index count = campaign.robot.parameter_count();
        const MatrixXd all = estimate.covariance.block(begin, begin, count, count);
        const MatrixXd C = all(rail.waves, rail.waves);
        EXPECT_LT(C.diagonal().cwiseSqrt().maxCoeff(), 1e-6);
        EXPECT_LT(off.dot(C.inverse() * off), 18.5)  // 99.9 % of chi-squared with 4
            << 1e6 * off.transpose();
    }
}

TEST(RailDrive, IsMissedWithoutItsPitch) {
    const DrivenRail rail;
    const Parameters truth = rail.draw(1);
    const Measurements measured = measure_at_random(rail.campaign, truth, 40, 1);
    const Measurements others = measure_at_random(rail.campaign, truth, 100, 2);
    Campaign blind = full_campaign(without_parameters(rail_with_fanuc()), DrivenRail::sigma);
    blind.model_error = DrivenRail::sigma;
    EXPECT_GT(held_out_error(blind, measured, others),
              1.3 * held_out_error(rail.campaign, measured, others));
}

// ---- A lifting column that carries an arm ----

/// What a mobile manipulator is: a column, an arm of six joints on its carriage.
Chain arm_on_column() {
    const auto R = Motion::Rotation;
    return Chain({{"lift", 0, 0.8},
                  {"q1", -2.5, 2.5},
                  {"q2", -1.2, 1.2},
                  {"q3", -2, 2},
                  {"q4", -3, 3},
                  {"q5", -2, 2},
                  {"q6", -3, 3}},
                 {translation(Axis::Z, 0.4), driven(Motion::Translation, Axis::Z, 0),
                  translation(Axis::X, 0.15), driven(R, Axis::Z, 1), translation(Axis::Z, 0.1),
                  driven(R, Axis::Y, 2), translation(Axis::X, 0.4), driven(R, Axis::Y, 3),
                  translation(Axis::X, 0.1), driven(R, Axis::X, 4), translation(Axis::X, 0.3),
                  driven(R, Axis::Y, 5), translation(Axis::X, 0.1), driven(R, Axis::X, 6)});
}

const std::vector<Load> arm_weights{
    {3, 6, {0.2, 0, 0}}, {4, 4, {0.1, 0, 0.02}}, {6, 3, {0.05, 0, 0}}, {8, 2, {0.08, 0.03, 0}}};

/// Moment of the weights about the x and y axes of the carriage, N m.
Eigen::Vector2d moment_about_column(const VectorXd& q) {
    const auto links = arm_on_column().base_from_links(q, VectorXd());
    Eigen::Vector2d moment = Eigen::Vector2d::Zero();
    for (const Load& load : arm_weights) {
        const Vector3d c = links[static_cast<std::size_t>(load.link)] * load.center;
        moment += 9.80665 * load.mass * Eigen::Vector2d(-c.y(), c.x());
    }
    return moment;
}

/// The robot with these geometric errors as it stands at q, its column bent by 0.3 mrad for each
/// metre that is out and each 100 N m: a beam that seems to turn about the middle of what is out.
Isometry3d bent_flange(const Chain& geometric, const VectorXd& errors, const VectorXd& q) {
    constexpr double compliance = 0.3e-3 / 100;
    const double out = q[0] - geometric.joint(0).lower;
    const Eigen::Vector2d angle = compliance * out * moment_about_column(q);
    std::vector<Element> elements;
    for (const Element& element : geometric.elements()) {
        elements.push_back(element);
        if (element.parameter != "Ry_lift") continue;
        elements.push_back(translation(Axis::Z, -out / 2));
        elements.push_back(rotation(Axis::X, angle.x()));
        elements.push_back(rotation(Axis::Y, angle.y()));
        elements.push_back(translation(Axis::Z, out / 2));
    }
    return geometric.with_elements(elements).base_from_flange(q, errors);
}

Measurements measure_bent(const Campaign& geometric, const Parameters& truth,
                          const RowMatrixXd& configurations, std::uint64_t seed) {
    // The same noise, and ids, as of a robot that does not bend.
    Measurements measured = simulate_measurements(geometric, truth, configurations, 1, seed);
    const auto predict = [&](const Isometry3d& base_from_flange) {
        return geometric.sensor->predict(truth.world_from_base * base_from_flange, truth.sensor);
    };
    for (Index i = 0; i < configurations.rows(); ++i) {
        const VectorXd q = configurations.row(i).transpose();
        const VectorXd bend = predict(bent_flange(geometric.robot, truth.robot, q)) -
                              predict(geometric.robot.base_from_flange(q, truth.robot));
        measured.observations.row(i) += bend.transpose();
    }
    return measured;
}

/// The first plan that is refined, whatever further ones would gain.
RowMatrixXd plan(const Campaign& campaign, Index count) {
    std::atomic<bool> is_refined = false;
    PlanningOptions options(count);
    options.pool_count = 100;
    options.starts = 1;
    options.workspace_count = 20;
    options.stop.interrupted = &is_refined;
    options.progress = [&](const Progress& progress) { is_refined = progress.done > 0; };
    const Planning planning = make_plan(campaign, options);
    RowMatrixXd configurations(count, campaign.robot.joint_count());
    for (Index i = 0; i < count; ++i) {
        configurations.row(i) =
            planning.plan.poses[static_cast<std::size_t>(i)].configuration.transpose();
    }
    return configurations;
}

TEST(LiftingColumn, ThatBendsIsPlannedAndFound) {
    constexpr double sigma = 1e-5;  // m
    const double noise = std::sqrt(3.0) * sigma;
    const Campaign campaign = full_campaign(arm_on_column(), sigma);
    Campaign rigid = with_robot(campaign, detail::complete_model(arm_on_column()));
    rigid.model_error = 0;
    const Parameters truth = draw_truth(rigid, 5);
    const Measurements measured = measure_bent(rigid, truth, plan(campaign, 30), 6);
    const RowMatrixXd elsewhere = detail::random_configurations(rigid.robot, 100, 7);
    const Measurements others = measure_bent(rigid, truth, elsewhere, 8);
    EXPECT_LT(held_out_error(campaign, measured, others), 1.4 * noise);

    // Without bending columns, with all else; and as errors: geometric has it.
    EXPECT_GT(held_out_error(without_errors(campaign, "lift.R"), measured, others), 2 * noise);
    Campaign geometric = with_robot(campaign, irreducible_model(rigid));
    geometric.spread = {};
    EXPECT_GT(held_out_error(geometric, measured, others), 2.5 * noise);
}

}  // namespace
}  // namespace posewise
