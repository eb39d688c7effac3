#pragma once

#include <cstdint>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise::detail {

struct OrderOptions {
    /// How often the best order is broken up at random and improved again.
    Index kicks = 200;
    std::uint64_t seed = 1;
};

/// An open path from a start through all poses.
struct VisitingOrder {
    std::vector<Index> poses;  ///< pose indices, from 0, in the order they are visited
    double time = 0;           ///< infinite if the path needs a move that is impossible
};

/// Time of a path that starts at node 0 and visits the poses in this order. `times` is symmetric
/// and has a row for the start and one for each pose; pose i is node i + 1; infinite: impossible.
double order_time(const MatrixXd& times, const std::vector<Index>& poses);

/// Always on to the nearest pose not yet visited; of several nearest ones, the first.
VisitingOrder nearest_neighbour_order(const MatrixXd& times);

/// A short path: nearest neighbour, improved by 2-opt and Or-opt, again after random double-bridge
/// kicks [Johnson & McGeoch 1997]. Never longer than nearest neighbour; it has an impossible move
/// only where none was found without. Throws InputError if `times` is not square and symmetric
/// or has a value that is negative or NaN.
VisitingOrder shortest_order(const MatrixXd& times, const OrderOptions& options = {});

}  // namespace posewise::detail
