#pragma once

#include <optional>

#include "posewise/calibrator/estimate.hpp"
#include "posewise/core/random.hpp"
#include "posewise/measurement/measurements.hpp"
#include "posewise/task/study.hpp"

/// Robots that are drawn, measured, calibrated and judged.
namespace posewise::detail {

/// Configurations to measure, and the targets that each shows.
struct Subset {
    RowMatrixXd configurations;
    Seen is_seen;
};

std::uint64_t draw_seed(RandomStream& stream);

/// A drawn robot, and where it really is.
struct TrialRobot {
    Campaign truth;  ///< with the model error drawn
    DrawnRobot robot;
    RowMatrixXd positions;  ///< of its targets at the test configurations
};

/// The robot, sent once to each of the test configurations: with model error and repeatability of
/// that visit, by this seed.
TrialRobot visit(const Campaign& truth, DrawnRobot robot, const RowMatrixXd& test,
                 std::uint64_t seed);

/// Measured at these configurations, and calibrated as the campaign says from registration on;
/// nothing if that does not identify the model.
std::optional<Estimate> calibrate_robot(const Campaign& campaign, const TrialRobot& trial,
                                        const Subset& subset, Index repeats, std::uint64_t seed);

/// World positions of all targets, a row a configuration (m x 3 targets).
RowMatrixXd target_positions(const Campaign& campaign, const Parameters& parameters,
                             const RowMatrixXd& configurations);

/// Of positions, three columns each.
HeldOut compare_positions(const RowMatrixXd& is, const RowMatrixXd& should_be);

}  // namespace posewise::detail
