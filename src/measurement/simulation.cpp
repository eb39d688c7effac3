#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "contact.hpp"
#include "core/elementary.hpp"
#include "core/normals.hpp"
#include "feasible.hpp"
#include "model/sampling.hpp"
#include "noise.hpp"
#include "places.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

/// Joints as they are where the robot touches what it shows, give or take the noise: q was about
/// there.
VectorXd touching_joints(const Campaign& campaign, const Parameters& truth, const VectorXd& q,
                         const SeenTargets& is_seen, const VectorXd& noise) {
    const Index width = campaign.sensor->rows_per_target();
    const Index contact = targets_seen(is_seen).front();
    constexpr double near = 0.2;  // rad or m
    const VectorXd infinite =
        VectorXd::Constant(campaign.robot.joint_count(), std::numeric_limits<double>::infinity());
    const detail::JointRange unlimited{-infinite, infinite};
    for (const auto& range : {detail::limits_of(campaign.robot), unlimited}) {
        auto joints = detail::bring_to_contact(campaign, truth, q, contact, range,
                                               noise.segment(width * contact, width));
        if (joints && (*joints - q).cwiseAbs().maxCoeff() <= near) return std::move(*joints);
    }
    throw InputError(
        "the simulated robot does not reach " +
        campaign.sensor->contact_names()[static_cast<std::size_t>(contact)] +
        " near a configuration that shows it; the configurations must touch, or the expected "
        "errors be smaller");
}

void check_contacts(const Campaign& campaign, const Seen& is_seen, Index repeats) {
    if (!campaign.sensor->has_contacts()) return;
    if (repeats != 1) {
        throw InputError(
            "repeats must be 1: the robot touches once a configuration, and is "
            "elsewhere when it does so again");
    }
    if ((is_seen.rowwise().count() == 1).all()) return;
    throw InputError("each configuration must show one contact and no other");
}

/// What the campaign leaves open of where base and targets are, with its keys.
std::string missing_places(const Campaign& campaign) {
    const Sensor& sensor = *campaign.sensor;
    if (sensor.has_contacts()) {
        return "where the ball and all sockets are (position_mm of 'sensor.targets' and of each of "
               "'sensor.sockets')";
    }
    if (sensor.is_combined()) {
        return "where the base is (key 'base') and of each of 'sensors' where on the flange it "
               "sees what, and its frame (keys 'targets.position_mm', 'tool' or 'place', and "
               "'frame')";
    }
    if (sensor.has_pixels()) {
        const std::string places =
            "where board and cameras are, and their intrinsics, if only roughly (keys "
            "'sensor.place', 'place' of each of 'sensor.other_cameras', 'intrinsics'";
        return places + (campaign.has_nominal_base ? ")" : ", and 'base')");
    }
    const bool is_pose = sensor.has_orientation();
    const std::string key = is_pose ? "sensor.tool" : "sensor.targets.position_mm";
    if (campaign.has_nominal_base) {
        return fmt::format("where the {}, too (key '{}')", is_pose ? "tool is" : "targets are",
                           key);
    }
    if (campaign.has_nominal_targets) return "where the base is, too (key 'base')";
    return fmt::format("where base and {} are (keys 'base' and '{}')", is_pose ? "tool" : "targets",
                       key);
}

void check_places_stated(const Campaign& campaign) {
    if (!campaign.has_nominal_base || !campaign.has_nominal_targets) {
        throw InputError("to simulate, the campaign must state " + missing_places(campaign));
    }
    detail::check_places(campaign);
}

/// Parameters as an earlier calibration tells, give or take so many times its covariance's
/// deviations; what it tells nothing of about nominal.
Parameters draw_from_prior(const Campaign& campaign, double times, std::uint64_t seed) {
    RandomStream stream(seed);
    const VectorXd z = stream.normals(parameter_count(campaign));
    const Index begin = prior_begin(campaign);
    const Index count = prior_count(campaign);
    const MatrixXd root = detail::cholesky_factor(campaign.prior->covariance);
    if (root.rows() != count) throw InputError("the prior is of other parameters");
    VectorXd errors = parameter_scale(campaign).cwiseProduct(z);
    errors.segment(begin, count) = times * (root * z.segment(begin, count));
    return advance(campaign, campaign.prior->mean, errors);
}

}  // namespace

Parameters draw_truth(const Campaign& campaign, std::uint64_t seed) {
    RandomStream stream(seed);
    VectorXd errors =
        parameter_scale(campaign).cwiseProduct(stream.normals(parameter_count(campaign)));
    for (const Compliance& compliance : compliances(campaign.robot)) {
        double& error = errors[base_parameter_count(campaign) + compliance.parameter];
        error = std::abs(error);
    }
    return advance(campaign, campaign.nominal, errors);
}

DrawnRobot draw_robot(const Campaign& campaign, std::uint64_t seed) {
    RandomStream stream(seed, 1);  // draw_truth() draws from stream (seed, 0)
    const double errors = detail::power(campaign.known_within.error_size, stream.normal());
    const double model = detail::power(campaign.known_within.model_error, stream.normal());
    return draw_robot(campaign, errors, model, seed);
}

DrawnRobot draw_robot(const Campaign& campaign, double errors, double model, std::uint64_t seed) {
    DrawnRobot robot{{}, model * campaign.model_error, model * campaign.model_error_orientation};
    if (campaign.prior) {
        robot.truth = draw_from_prior(campaign, errors, seed);
        return robot;
    }
    robot.truth = draw_truth(campaign, seed);
    const VectorXd& nominal = campaign.nominal.robot;
    const VectorXd drawn = errors * (robot.truth.robot - nominal);
    robot.truth.robot = campaign.spread.is_prior ? drawn : nominal + drawn;
    return robot;
}

Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, Index repeats,
                                   std::uint64_t seed) {
    return simulate_measurements(campaign, truth, configurations,
                                 all_seen(configurations.rows(), campaign.sensor->target_count()),
                                 repeats, seed);
}

Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, const Seen& is_seen,
                                   Index repeats, std::uint64_t seed) {
    detail::check_noise(campaign);
    check_contacts(campaign, is_seen, repeats);
    const Sensor& sensor = *campaign.sensor;
    const Index rows = sensor.row_count();
    const double common = detail::common_model_error(campaign);
    const VectorXd own_errors = detail::own_model_errors(campaign);
    RowMatrixXd effect(rows, 6);
    TwistMatrix twists(6, 6);
    VectorXd motion(6);
    VectorXd clearances(sensor.target_count());
    SeenTargets seen(sensor.target_count());
    const bool has_contacts = sensor.has_contacts();
    Measurements measurements;
    measurements.configurations = configurations;
    measurements.ids.reserve(static_cast<std::size_t>(configurations.rows()));
    measurements.first_sample.reserve(static_cast<std::size_t>(configurations.rows()) + 1);
    measurements.observations.resize(configurations.rows() * repeats, rows);
    measurements.is_seen.resize(configurations.rows() * repeats, sensor.target_count());
    VectorXd q(configurations.cols());
    VectorXd joint_errors = VectorXd::Zero(q.size());
    VectorXd predicted(rows), expected(rows), noise(rows), drawn(rows);
    MatrixXd covariance(rows, rows), noise_factor;
    std::array<RandomStream, 4> streams = RandomStream::of_four_items(seed, 0);
    for (Index i = 0; i < configurations.rows(); ++i) {
        if (i > 0 && i % 4 == 0) {
            streams = RandomStream::of_four_items(seed, static_cast<std::uint64_t>(i));
        }
        RandomStream& stream = streams[static_cast<std::size_t>(i % 4)];
        q = configurations.row(i).transpose();
        for (Index j = 0; j < campaign.joint_repeatability.size(); ++j) {
            joint_errors[j] = campaign.joint_repeatability[j] * stream.normal();
        }
        q += joint_errors;
        const Isometry3d flange = world_from_flange(campaign, truth, q);
        sensor.predict(flange, truth.sensor, predicted);
        detail::fill_normals(stream, drawn);
        drawn.array() *= own_errors.array();
        if (common > 0) {
            detail::set_model_error_twists(campaign, flange, truth.sensor, twists);
            sensor.differentiate(flange, twists, truth.sensor, effect);
            detail::fill_normals(stream, motion);
            drawn.noalias() += common * effect * motion;
        }
        sensor.deviate(predicted, drawn, expected);
        if (i == 0 || !sensor.has_constant_covariance()) {
            sensor.covariance(flange, truth.sensor, covariance);
            detail::cholesky_factor(covariance, noise_factor);
        }
        seen = is_seen.row(i);
        if (sensor.has_view()) {
            sensor.view_clearances(flange, truth.sensor, clearances);
            seen = seen && clearances.transpose().array() >= 0;
        }
        measurements.is_seen.middleRows(i * repeats, repeats).rowwise() = seen;
        for (Index k = 0; k < repeats; ++k) {
            detail::fill_normals(stream, drawn);
            noise.noalias() = noise_factor * drawn;
            sensor.deviate(expected, noise, predicted);
            measurements.observations.row(i * repeats + k) = predicted.transpose();
            if (!sensor.has_view()) continue;
            for (Index target = 0; target < seen.size(); ++target) {
                if (!seen[target] || sensor.is_readable(target, predicted)) continue;
                measurements.is_seen(i * repeats + k, target) = false;
            }
        }
        if (has_contacts) {
            noise =
                measurements.observations.row(i).transpose() - sensor.predict(flange, truth.sensor);
            measurements.configurations.row(i) =
                (touching_joints(campaign, truth, q, is_seen.row(i), noise) - joint_errors)
                    .transpose();
            measurements.observations.row(i).setZero();
        }
        measurements.ids.push_back(std::to_string(i));
        measurements.first_sample.push_back((i + 1) * repeats);
    }
    return measurements;
}

Simulation simulate(const Campaign& campaign, const SimulateOptions& options) {
    if (options.pose_count < 1) {
        throw InputError("poses must be at least 1, are " + std::to_string(options.pose_count));
    }
    check_places_stated(campaign);
    // Configurations and noise come from different streams of one seed.
    const std::uint64_t configuration_seed = ~options.seed;
    const detail::ShownPoses poses =
        detail::draw_feasible(campaign, options.pose_count, [&](const Chain& robot, Index drawn) {
            return detail::random_configurations(robot, drawn, configuration_seed);
        });
    return simulate(campaign, poses.configurations, poses.is_seen, options);
}

Simulation simulate(const Campaign& campaign, const RowMatrixXd& configurations,
                    const Seen& is_seen, const SimulateOptions& options) {
    if (options.repeats < 1) {
        throw InputError("repeats must be at least 1, are " + std::to_string(options.repeats));
    }
    check_places_stated(campaign);
    if (is_seen.rows() != configurations.rows() ||
        is_seen.cols() != campaign.sensor->target_count()) {
        throw InputError("visibility is stated for " + std::to_string(is_seen.rows()) + " x " +
                         std::to_string(is_seen.cols()) + " configurations and targets, must be " +
                         std::to_string(configurations.rows()) + " x " +
                         std::to_string(campaign.sensor->target_count()));
    }
    Simulation simulation;
    simulation.truth = draw_truth(campaign, options.truth_seed);
    simulation.measurements = simulate_measurements(campaign, simulation.truth, configurations,
                                                    is_seen, options.repeats, options.seed);
    return simulation;
}

}  // namespace posewise
