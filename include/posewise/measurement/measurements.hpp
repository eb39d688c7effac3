#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/core/types.hpp"
#include "posewise/measurement/seen.hpp"
#include "posewise/measurement/sensor.hpp"

namespace posewise {

/// Which numbers of a file an orientation was read from.
enum class OrientationNotation {
    RotationVector,  ///< as observations have it, numbers unchanged
    Quaternion,      ///< real part first
    RollPitchYaw,    ///< about fixed axes x, y and z
};

/// A measured campaign: configurations, each observed once or several times.
struct Measurements {
    RowMatrixXd configurations;    ///< m x joints, rad or m
    std::vector<std::string> ids;  ///< m names of the configurations, as in the file
    RowMatrixXd observations;      ///< samples x sensor rows, m or rad; grouped by configuration
    /// samples x targets: which targets each sample shows. What stands in `observations` for the
    /// others is never looked at.
    Seen is_seen;
    std::vector<Index> first_sample{0};  ///< m + 1; samples of configuration i start at [i]
    /// Of each sample, as in the file's column `sample`; empty: numbers from 1 on.
    std::vector<std::string> sample_names = {};
    OrientationNotation notation = OrientationNotation::RotationVector;  ///< of the file
    /// samples x 3: roll, pitch and yaw as they were read, rad; empty: in another notation.
    RowMatrixXd roll_pitch_yaw = {};

    Index configuration_count() const { return static_cast<Index>(ids.size()); }
    Index sample_count(Index configuration) const {
        const auto i = static_cast<std::size_t>(configuration);
        return first_sample[i + 1] - first_sample[i];
    }
    /// "7:2", as leave_out() takes it.
    std::string sample_name(Index configuration, Index sample) const;
    /// What a sample observed of a target it shows, as a view.
    auto observation(Index sample, Index target) const {
        const Index width = observations.cols() / is_seen.cols();
        return observations.row(sample).segment(width * target, width);
    }
};

/// How many samples of each configuration show each target: m x targets.
RowMatrixXd times_seen(const Measurements& measurements);

/// The same as part of the configuration's samples, 0 to 1.
RowMatrixXd share_seen(const Measurements& measurements);

/// The means of each configuration as its only sample: of each target over the samples that show
/// it, which may be fewer than there are. A mean orientation is the first sample's, turned by the
/// mean of the deviations from it.
Measurements mean_measurements(const Sensor& sensor, const Measurements& measurements);

/// The measurements of some configurations, in the order asked for.
Measurements take(const Measurements& measurements, const std::vector<Index>& configurations);

/// The other ones: all but those listed.
std::vector<Index> all_but(Index count, const std::vector<Index>& left_out);

/// So many of `count` at most, evenly spaced from the first on.
std::vector<Index> evenly_spaced(Index count, Index most);

/// Standard deviation of one observed number about its configuration's mean, pooled over all
/// samples.
struct Repeatability {
    double length = 0;       ///< m
    double orientation = 0;  ///< rad; 0 if the sensor does not measure it
};

/// Nothing if no target was seen twice at one configuration.
std::optional<Repeatability> repeatability(const Sensor& sensor, const Measurements& measurements);

}  // namespace posewise
