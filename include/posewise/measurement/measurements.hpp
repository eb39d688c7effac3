#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// How a file states an orientation.
enum class OrientationNotation {
    RotationVector,  ///< as in observations, numbers unchanged
    Quaternion,      ///< real part first
    RollPitchYaw,    ///< rotations about the fixed axes x, y and z
};

/// A measured campaign: configurations, each observed once or several times.
struct Measurements {
    RowMatrixXd configurations;    ///< m x joints, rad or m
    std::vector<std::string> ids;  ///< m configuration names, as in the file
    RowMatrixXd observations;      ///< samples x sensor rows, m or rad; grouped by configuration
    /// samples x targets: which targets each sample shows. Values of other targets in
    /// `observations` are ignored.
    Seen is_seen;
    std::vector<Index> first_sample{0};  ///< m + 1; samples of configuration i start at [i]
    /// Name of each sample, from the file's column `sample`; empty: numbers from 1 on.
    std::vector<std::string> sample_names = {};
    OrientationNotation notation = OrientationNotation::RotationVector;  ///< in the file
    /// samples x 3: roll, pitch and yaw as read, rad; empty: the file has another notation.
    RowMatrixXd roll_pitch_yaw = {};

    Index configuration_count() const { return static_cast<Index>(ids.size()); }
    Index sample_count(Index configuration) const {
        const auto i = static_cast<std::size_t>(configuration);
        return first_sample[i + 1] - first_sample[i];
    }
    /// Name for leave_out(): "7:2".
    std::string sample_name(Index configuration, Index sample) const;
    /// A sample's observation of a target that it shows, as a view.
    auto observation(Index sample, Index target) const {
        const Index width = observations.cols() / is_seen.cols();
        return observations.row(sample).segment(width * target, width);
    }
};

/// How many samples of each configuration show each target: m x targets.
RowMatrixXd times_seen(const Measurements& measurements);

/// times_seen() as a share of the configuration's samples, 0 to 1.
RowMatrixXd share_seen(const Measurements& measurements);

/// The mean of each configuration as its only sample; for each target over the samples that show
/// it. A mean orientation is the first sample's, rotated by the mean deviation from it.
Measurements mean_measurements(const Sensor& sensor, const Measurements& measurements);

/// The measurements of the listed configurations, in that order.
Measurements take(const Measurements& measurements, const std::vector<Index>& configurations);

/// Joins campaigns that have the same columns, one after another. Their ids must differ.
Measurements put_together(const std::vector<Measurements>& parts);

/// Indices from 0 to count - 1 without those listed.
std::vector<Index> all_but(Index count, const std::vector<Index>& left_out);

/// At most `most` of 0 .. count-1, evenly spaced, beginning with 0.
std::vector<Index> evenly_spaced(Index count, Index most);

/// Standard deviation of one observed number about its configuration's mean, pooled over all
/// samples.
struct Repeatability {
    double length = 0;       ///< m
    double orientation = 0;  ///< rad; 0 if the sensor does not measure it
};

/// Nothing if no target was seen twice at one configuration.
std::optional<Repeatability> repeatability(const Sensor& sensor, const Measurements& measurements);

/// The measurements without those named in `excluded`: "7" is the configuration with that id; "7:2"
/// its sample 2 by the file's column `sample`, or its second one without such a column; "7-12" the
/// configurations from 7 to 12 in the file's order. A configuration without samples is left out.
/// Throws InputError for a name that does not exist or occurs twice, and if nothing would be left.
Measurements leave_out(const Measurements& measurements, const std::vector<std::string>& excluded);

struct SimulateOptions {
    Index pose_count = 0;          ///< configurations to draw; must be stated
    Index repeats = 1;             ///< observations per configuration
    std::uint64_t truth_seed = 1;  ///< draws the true parameters
    std::uint64_t seed = 1;        ///< draws configurations and noise
};

/// A simulated campaign and the parameters that made it.
struct Simulation {
    Parameters truth;
    Measurements measurements;
};

/// True parameters: nominal plus normal errors with the campaign's spread; compliances are
/// positive.
Parameters draw_truth(const Campaign& campaign, std::uint64_t seed);

/// A simulated robot about which only the campaign is known.
struct DrawnRobot {
    Parameters truth;
    double model_error = 0;              ///< replaces the campaign's, m
    double model_error_orientation = 0;  ///< rad
};

/// draw_truth() with two random factors, one on all robot errors and one on the model errors,
/// spread as the campaign's KnownWithin states. If the spread is the prior, robot errors are drawn
/// about zero; if an earlier estimate is the prior, everything it covers is drawn from that.
DrawnRobot draw_robot(const Campaign& campaign, std::uint64_t seed);

/// As above with given factors on the robot errors (or on all that an earlier estimate covers) and
/// on the model errors.
DrawnRobot draw_robot(const Campaign& campaign, double errors, double model, std::uint64_t seed);

/// Observations of given configurations (m x joints) by a robot with the true parameters. Sensor
/// noise is drawn for every sample; model error and joint errors for every configuration, shared by
/// its samples. Configuration i draws from stream (seed, i), whatever the number of configurations.
Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, Index repeats,
                                   std::uint64_t seed);

/// As above, where each configuration shows some targets (m x targets). For contacts it shows one:
/// the joints are moved from `configurations` to where the robot touches it, and all readings are
/// 0. A sensor with has_view() misses those that are out of sight of the true robot. Throws
/// InputError if they cannot be.
Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, const Seen& is_seen,
                                   Index repeats, std::uint64_t seed);

/// draw_truth() measured at random configurations that the campaign's cell allows. Throws
/// InputError for counts below 1, if the campaign does not state its base and targets or states
/// them where no cell has them, and if hardly any configuration is allowed.
Simulation simulate(const Campaign& campaign, const SimulateOptions& options);

/// As above at given configurations (m x joints), each of which shows some targets (m x targets).
/// Ignores options.pose_count, and the cell, see find_violations().
Simulation simulate(const Campaign& campaign, const RowMatrixXd& configurations,
                    const Seen& is_seen, const SimulateOptions& options);

}  // namespace posewise
