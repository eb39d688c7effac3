#pragma once

#include <cstdint>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise {

struct SimulateOptions {
    Index pose_count = 0;          ///< of configurations to draw; must be stated
    Index repeats = 1;             ///< observations of each configuration
    std::uint64_t truth_seed = 1;  ///< draws the true parameters
    std::uint64_t seed = 1;        ///< draws configurations and noise
};

/// A simulated campaign and the parameters that made it.
struct Simulation {
    Parameters truth;
    Measurements measurements;
};

/// True parameters at nominal plus normal errors of the campaign's spread; compliances are
/// positive.
Parameters draw_truth(const Campaign& campaign, std::uint64_t seed);

/// A robot of which nothing is known but what the campaign says.
struct DrawnRobot {
    Parameters truth;
    double model_error = 0;              ///< m, in the place of the campaign's
    double model_error_orientation = 0;  ///< rad
};

/// draw_truth() with all of the robot's errors larger or smaller by one factor, and another factor
/// of the model errors, each as surely as the campaign's KnownWithin says. Where the spread is the
/// prior its errors are about zero, as that says, and where an earlier estimate is the prior all
/// that it tells of is drawn from that.
DrawnRobot draw_robot(const Campaign& campaign, std::uint64_t seed);

/// The same with these factors of the robot's errors (of all that an earlier estimate tells of) and
/// of the model errors.
DrawnRobot draw_robot(const Campaign& campaign, double errors, double model, std::uint64_t seed);

/// Observations of given configurations (m x joints) by a robot with the true parameters: sensor
/// noise on every sample; model error and joint errors on every configuration (the same for all its
/// samples).
/// Configuration i and its noise come from stream (seed, i), whatever the number of configurations.
Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, Index repeats,
                                   std::uint64_t seed);

/// The same where each configuration shows some targets (m x targets). Where they are contacts it
/// shows one, and the joints are where the robot touches it: they are moved from `configurations`
/// there, and all readings are 0. Throws InputError if they cannot be.
Measurements simulate_measurements(const Campaign& campaign, const Parameters& truth,
                                   const RowMatrixXd& configurations, const Seen& is_seen,
                                   Index repeats, std::uint64_t seed);

/// draw_truth() measured at random configurations that the campaign's cell allows. Throws
/// InputError for counts below 1, if the campaign does not state its base and targets, or states
/// them where no cell has them, and if hardly any configuration is allowed.
Simulation simulate(const Campaign& campaign, const SimulateOptions& options);

/// The same at given configurations (m x joints), each of which shows some targets (m x targets);
/// options.pose_count is not looked at, nor is the cell, see find_violations().
Simulation simulate(const Campaign& campaign, const RowMatrixXd& configurations,
                    const Seen& is_seen, const SimulateOptions& options);

}  // namespace posewise
