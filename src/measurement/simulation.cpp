#include "posewise/measurement/simulation.hpp"

#include <cmath>

#include "../model/sampling.hpp"
#include "noise.hpp"
#include "posewise/core/errors.hpp"
#include "posewise/core/random.hpp"
#include "posewise/model/error_terms.hpp"

namespace posewise {
namespace {

VectorXd draw_normal(RandomStream& stream, Index count) {
    VectorXd z(count);
    for (Index k = 0; k < count; ++k) z[k] = stream.normal();
    return z;
}

}  // namespace

Parameters draw_truth(const Campaign& campaign, std::uint64_t seed) {
    RandomStream stream(seed);
    VectorXd errors =
        parameter_scale(campaign).cwiseProduct(draw_normal(stream, parameter_count(campaign)));
    for (const Compliance& compliance : compliances(campaign.robot)) {
        double& error = errors[base_parameter_count(campaign) + compliance.parameter];
        error = std::abs(error);
    }
    return advance(campaign, campaign.nominal, errors);
}

Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, Index repeats,
                                   std::uint64_t seed) {
    detail::check_noise(campaign);
    const Sensor& sensor = *campaign.sensor;
    const Index rows = sensor.row_count();
    const VectorXd model_error = detail::model_error_of_rows(campaign);
    Measurements measurements;
    measurements.configurations = configurations;
    measurements.observations.resize(configurations.rows() * repeats, rows);
    measurements.is_seen.setConstant(configurations.rows() * repeats, sensor.target_count(), true);
    for (Index i = 0; i < configurations.rows(); ++i) {
        RandomStream stream(seed, static_cast<std::uint64_t>(i));
        VectorXd q = configurations.row(i).transpose();
        if (campaign.joint_repeatability.size() > 0) {
            const Index joints = campaign.robot.joint_count();
            q.head(joints) +=
                campaign.joint_repeatability.cwiseProduct(draw_normal(stream, joints));
        }
        const Isometry3d flange = world_from_flange(campaign, truth, q);
        const VectorXd expected =
            sensor.deviate(sensor.predict(flange, truth.sensor),
                           model_error.cwiseProduct(draw_normal(stream, rows)));
        const MatrixXd noise_factor =
            detail::cholesky_factor(sensor.covariance(flange, truth.sensor));
        for (Index k = 0; k < repeats; ++k) {
            const VectorXd noise = noise_factor * draw_normal(stream, rows);
            measurements.observations.row(i * repeats + k) =
                sensor.deviate(expected, noise).transpose();
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
    // Configurations and noise come from different streams of one seed.
    const std::uint64_t configuration_seed = ~options.seed;
    const Index targets = campaign.sensor->target_count();
    return simulate(
        campaign,
        detail::random_configurations(campaign.robot, options.pose_count, configuration_seed),
        all_seen(options.pose_count, targets), options);
}

Simulation simulate(const Campaign& campaign, const RowMatrixXd& configurations,
                    const Seen& is_seen, const SimulateOptions& options) {
    if (options.repeats < 1) {
        throw InputError("repeats must be at least 1, are " + std::to_string(options.repeats));
    }
    if (!campaign.has_nominal_base || !campaign.has_nominal_targets) {
        throw InputError(
            "to simulate, the campaign must state where base and targets are (keys 'base' and "
            "'sensor.targets.position_mm' or 'sensor.tool')");
    }
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
                                                    options.repeats, options.seed);
    for (Index sample = 0; sample < simulation.measurements.is_seen.rows(); ++sample) {
        simulation.measurements.is_seen.row(sample) = is_seen.row(sample / options.repeats);
    }
    return simulation;
}

}  // namespace posewise
