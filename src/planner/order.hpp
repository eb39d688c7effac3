#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

struct OrderOptions {
    /// How often the best order is broken up at random and improved again.
    Index kicks = 200;
    std::uint64_t seed = 1;
    /// Asked all the while; true: end with the best order so far. Empty: never.
    std::function<bool()> is_over{};
};

/// An open path from a start through all poses.
struct VisitingOrder {
    std::vector<Index> poses;  ///< pose indices, from 0, in the order they are visited
    double time = 0;           ///< infinite if the path needs a move that is impossible
};

/// Always on to the nearest pose not yet visited; of several nearest ones, the first. `times` is
/// symmetric and has a row for the start, node 0, and one for each pose; pose i is node i + 1;
/// infinite: impossible.
VisitingOrder nearest_neighbour_order(const MatrixXd& times);

/// A short path: nearest neighbour, improved by 2-opt and Or-opt, again after random double-bridge
/// kicks [Johnson & McGeoch 1997]. Never longer than nearest neighbour; it has an impossible move
/// only where none was found without. Throws InputError if `times` is not square and symmetric
/// or has a value that is negative or NaN.
VisitingOrder shortest_order(const MatrixXd& times, const OrderOptions& options = {});

/// A path in random order, in which parts at random are then reversed where that shortens it, until
/// it takes at most `factor` times as long as `shortest`, of shortest_order(); that one where none
/// is found.
VisitingOrder random_order(const MatrixXd& times, const VisitingOrder& shortest, double factor,
                           const OrderOptions& options = {});

}  // namespace posewise::detail
