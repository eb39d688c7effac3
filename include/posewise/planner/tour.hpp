#pragma once

#include <optional>

#include "posewise/planner/constraints.hpp"
#include "posewise/planner/order.hpp"

namespace posewise {

/// Time of a straight joint move in which every joint starts and stops together, the slowest at
/// its largest speed (Chebyshev): max_j |b_j - a_j| / speed_j.
double move_time(const VectorXd& speed, const VectorXd& a, const VectorXd& b);

/// Whether the straight joint move from a to b keeps the links off keep-outs and each other. It is
/// followed in steps that the clearance at hand allows (conservative advancement), but no shorter
/// than `resolution` (m) of motion, so that at most half of it can be missed.
bool is_move_free(const Constraints& constraints, const VectorXd& a, const VectorXd& b,
                  double resolution = 1e-3);

struct TourOptions {
    OrderOptions order;
    /// Random via points tried for a move that is not free.
    Index via_attempts = 200;
    double resolution = 1e-3;  ///< of is_move_free(), m
};

/// One pose of a tour and how it is reached.
struct Visit {
    Index pose = 0;
    std::optional<VectorXd> via;  ///< configuration to pass on the way, if the straight way is not
                                  ///< free
    bool is_blocked = false;      ///< no free way was found: the user must find one
};

struct Tour {
    std::vector<Visit> visits;
    double time = 0;                 ///< s, vias included; a blocked move counts as if it were free
    double planning_order_time = 0;  ///< of straight moves in the order the poses were given
    double nearest_neighbour_time = 0;  ///< of straight moves to the nearest pose each
    Index blocked_count = 0;
};

/// The shortest tour found from the cell's home (or from anywhere, if it has none) through all
/// poses (K x joints). A straight move that is not free is avoided by another order or, where that
/// is shorter or inevitable, given a via point; what is left is marked as blocked. Throws
/// InputError if the home is not free or a pose has the wrong size.
Tour plan_tour(const Constraints& constraints, const RowMatrixXd& poses,
               const TourOptions& options = {});

}  // namespace posewise
