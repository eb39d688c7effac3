#pragma once

#include "order.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/planner/planning.hpp"

namespace posewise::detail {

/// How fast joints move: largest speeds (rad/s or m/s) and accelerations (empty: infinite).
struct Pace {
    VectorXd speed;
    VectorXd acceleration{};
};

/// Time of a straight joint move in which every joint starts and stops together, the slowest at
/// its largest speed (Chebyshev). For one joint by d: d / v + v / a or, where d is less than
/// v^2 / a, too short to reach the speed v, 2 sqrt(d / a).
double move_time(const Pace& pace, const VectorXd& a, const VectorXd& b);

/// Whether the straight joint move from a to b keeps the links off keep-outs and each other. It is
/// followed in steps that the clearance at hand allows (conservative advancement), but no shorter
/// than `resolution` (m) of motion, so that at most half of it can be missed.
bool is_move_free(const Constraints& constraints, const VectorXd& a, const VectorXd& b,
                  double resolution = 1e-3);

/// Time of a short tour of straight moves through the poses (K x joints), free or not: an estimate.
double straight_tour_time(const Constraints& constraints, const RowMatrixXd& poses);

struct TourOptions {
    OrderOptions order;
    /// Random via points tried for a move that is not free.
    Index via_attempts = 200;
    double resolution = 1e-3;  ///< of is_move_free(), m
    StopSignal stop{};         ///< from then on it takes half a second, and what it has then
    double random_order = 0;   ///< see PlanRequest
    VectorXd start{};          ///< where the robot is, instead of the cell's home; empty: home
};

/// The shortest tour found from the start or the cell's home (from anywhere, if it has none)
/// through all poses (K x joints). A straight move that is not free is avoided by another order or,
/// where that is shorter or inevitable, given a via point; what is left, or was not looked at
/// before the stop, is marked as blocked. Throws InputError if the home is not free or a pose has
/// the wrong size.
Tour plan_tour(const Constraints& constraints, const RowMatrixXd& poses,
               const TourOptions& options = {});

}  // namespace posewise::detail
