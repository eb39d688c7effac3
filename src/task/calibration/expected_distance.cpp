#include "expected_distance.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "calibrator/least_squares.hpp"
#include "core/decompositions.hpp"
#include "jacobian/nominal_factor.hpp"
#include "measurement/contact.hpp"
#include "model/complete_model.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::detail {

Estimate uncalibrated(const Campaign& campaign, const Parameters& at) {
    Estimate estimate;
    estimate.parameters = at;
    estimate.parameters.robot.setZero(campaign.robot.parameter_count());
    estimate.variance_factor = 1;
    estimate.model_error = campaign.model_error;
    estimate.model_error_orientation = campaign.model_error_orientation;
    VectorXd sizes = parameter_scale(campaign);
    sizes.head(base_parameter_count(campaign)).setZero();
    sizes.tail(at.sensor.size()).setZero();
    estimate.covariance = sizes.cwiseAbs2().asDiagonal();
    return estimate;
}

double expected_distance(const Campaign& campaign, const Measurements& measured) {
    // At nominal targets: fitted to another robot's points they may be anywhere.
    const Blocks blocks =
        make_prediction_blocks(campaign, campaign.nominal, measured.configurations);
    const auto points = static_cast<double>(blocks.matrix.rows()) / 3;
    const double robot = std::sqrt(
        blocks.matrix.middleCols(base_parameter_count(campaign), campaign.robot.parameter_count())
            .squaredNorm() /
        points);
    const Estimate none = uncalibrated(campaign, campaign.nominal);
    return robot +
           std::hypot(campaign.model_error, expected_error(campaign, none, measured, false).noise);
}

double largest_left_over(const Campaign& campaign, const Parameters& at,
                         const Measurements& measured, bool is_angle) {
    Campaign complete = with_robot(campaign, complete_model(campaign.robot));
    complete.prior.reset();
    Estimate none = uncalibrated(complete, at);
    const IdentificationProblem problem = make_problem(complete, measured);
    const LinearisedSystem system = linearise(problem, none.parameters);
    const MatrixXd J = system.J().topRows(system.first_row.back());
    const Index of_base = base_parameter_count(complete);
    const Index of_robot = complete.robot.parameter_count();
    const Index of_sensor = J.cols() - of_base - of_robot;
    const Index told = complete.sensor->unknown_sizes().size();
    MatrixXd fitted = MatrixXd::Zero(J.rows() + told, of_base + of_sensor);
    fitted.topRows(J.rows()) << J.leftCols(of_base), J.rightCols(of_sensor);
    fitted.block(J.rows(), of_base, told, told).setIdentity();  // their prior
    // Coordinates of the robot are standard normal; base and targets follow them.
    MatrixXd along = MatrixXd::Zero(J.cols(), of_robot);
    along.middleRows(of_base, of_robot).setIdentity();
    if (fitted.cols() > 0) {
        MatrixXd by_robot = MatrixXd::Zero(fitted.rows(), of_robot);
        by_robot.topRows(J.rows()) = J.middleCols(of_base, of_robot);
        const MatrixXd followed = PivotedReflections(fitted).solve(by_robot);
        along.topRows(of_base) = -followed.topRows(of_base);
        along.bottomRows(of_sensor) = -followed.bottomRows(of_sensor);
    }
    none.covariance = along * along.transpose();
    problem.units.unscale(none.covariance);
    return expected_error(complete, none, measured, is_angle).total();
}

double expected_pixels(const Campaign& campaign, const Parameters& at,
                       const Measurements& measured) {
    constexpr Index enough = 25;
    const Sensor& sensor = *campaign.sensor;
    std::vector<Index> in_view;
    VectorXd clearances(sensor.target_count());
    for (Index i = 0; i < measured.configuration_count(); ++i) {
        const VectorXd q = measured.configurations.row(i).transpose();
        sensor.view_clearances(world_from_flange(campaign, at, q), at.sensor, clearances);
        if (clearances.maxCoeff() > 0) in_view.push_back(i);
    }
    if (2 * std::ssize(in_view) > measured.configuration_count()) {
        return largest_left_over(campaign, at, take(measured, in_view), true);
    }
    // Joints that are misread: beside the camera, or close to it, robots miss by any number.
    const ViewedPoses poses = viewed_poses(campaign, at, enough, configuration_seed);
    if (poses.in_view == 0) return std::numeric_limits<double>::infinity();
    Measurements shown;
    shown.configurations = poses.configurations.topRows(poses.in_view);
    shown.is_seen = poses.is_seen.topRows(poses.in_view);
    shown.observations = RowMatrixXd::Zero(poses.in_view, sensor.row_count());
    for (Index i = 0; i < poses.in_view; ++i) {
        shown.ids.push_back(fmt::format("{}", i));
        shown.first_sample.push_back(i + 1);
    }
    return largest_left_over(campaign, at, shown, true);
}

double expected_pixels_as_stated(const Campaign& campaign, const Measurements& measured) {
    const bool is_stated = campaign.has_nominal_base && campaign.has_nominal_targets;
    if (!is_stated) return std::numeric_limits<double>::infinity();
    return expected_pixels(campaign, campaign.nominal, measured);
}

double credible_distance(const Campaign& campaign, const Measurements& measured) {
    const Sensor& sensor = *campaign.sensor;
    if (sensor.has_lengths()) return credible_errors * expected_distance(campaign, measured);
    if (!sensor.has_only_pixels()) return std::numeric_limits<double>::infinity();
    return credible_errors * expected_pixels_as_stated(campaign, measured);
}

}  // namespace posewise::detail
