#pragma once

#include <cstdint>
#include <numbers>

#include "posewise/calibrator/identification.hpp"
#include "posewise/calibrator/registration.hpp"

namespace posewise {

/// Where the starts of a global identification are: anywhere, or where a population search, over
/// the robot's errors alone with base and targets registered for each, has found its best.
enum class StartSearch { Random, Crs2, Esch, Isres, CmaEs };

/// How far the nominal robot may be off, and how hard to search.
struct GlobalOptions {
    double length_share = 0.3;                   ///< error of a length, as part of it
    double least_length = 0.05;                  ///< m; that of any length at least
    double angle = 20 * std::numbers::pi / 180;  ///< error of an angle, rad
    StartSearch search = StartSearch::Random;
    Index evaluation_limit = 20000;  ///< of one population search
    Index start_limit = 200;
    Index agreeing_starts = 3;  ///< stop when so many ended at the best sum of squares
    std::uint64_t seed = 1;     ///< start i draws from stream (seed, i)
    LevenbergMarquardtOptions start_options{};  ///< of each start; its loss must be squares
    ProgressCallback progress{};  ///< of the starts; agreeing ones end them before the total
};

/// Largest error searched of each of the robot's parameters, m or rad; 0 for error terms.
VectorXd error_bounds(const Chain& robot, const GlobalOptions& options);

/// As register_roughly(), the robot with these errors, which the result has.
Registration register_roughly_with_errors(const Campaign& campaign,
                                          const Measurements& measurements,
                                          const VectorXd& robot_errors);

struct GlobalEstimate {
    Estimate estimate;  ///< the best
    Index starts = 0;
    Index starts_at_best = 0;  ///< one alone: there may be better ones
};

/// Identification of a robot whose nominal parameters are far off: identify() from the nominal
/// robot and from others within the bounds, base and targets registered anew for each. The
/// same for any number of threads. Ends NotIdentifiable where every start does, as the first.
/// Throws InputError as identify() does, for options out of range, and where the spread is a prior,
/// since that says errors are small.
GlobalEstimate identify_globally(const Campaign& campaign, const Measurements& measurements,
                                 const GlobalOptions& options = {});

}  // namespace posewise
