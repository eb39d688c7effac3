#pragma once

#include <optional>
#include <string>
#include <vector>

#include "posewise/task/calibration.hpp"

/// What a calibration leaves of each reading, to look for what it does not explain.
namespace posewise {

/// Where a target is, seen from the instrument.
struct Direction {
    double range = 0;      ///< m
    double azimuth = 0;    ///< atan2(y, x) in the instrument's axes, which are the world's, rad
    double elevation = 0;  ///< above the xy plane, rad
};

/// One sample of one target. Each vector has Sensor::rows_per_target() numbers, m or rad: observed
/// less predicted.
struct ReadingResidual {
    Index configuration = 0;
    Index sample = 0;  ///< row of Measurements::observations
    Index target = 0;
    VectorXd calibrated;
    VectorXd nominal;                  ///< of the robot that is not calibrated
    std::optional<VectorXd> held_out;  ///< predicted without its configuration
    VectorXd standardised;             ///< calibrated, over its expected standard deviation
    std::optional<Direction> direction;
};

/// Those of a calibration that was made with these measurements, in their order.
std::vector<ReadingResidual> list_residuals(const Calibration& calibration,
                                            const Measurements& measurements);

/// How an estimate that was kept is judged again.
struct ResidualOptions {
    Loss loss{};      ///< that it was made with
    Index folds = 0;  ///< held out; 0: none
};
/// The same of an estimate of the campaign, which has its model error: nominal and held out are
/// fitted again. Throws InputError as calibrate() does.
std::vector<ReadingResidual> list_residuals(const Campaign& campaign, const Estimate& estimate,
                                            const Measurements& measurements,
                                            const ResidualOptions& options = {});

/// The names of a residual's numbers: "x", "y", "z", "rx", ...; of readings that are one length
/// "distance".
std::vector<std::string> residual_axes(const Campaign& campaign);

}  // namespace posewise
