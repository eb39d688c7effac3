#pragma once

#include <string>
#include <vector>

#include "posewise/core/types.hpp"

namespace posewise {

/// Which targets each pose (or each sample) shows: poses x targets, stored as RowMatrixXd is.
using Seen = Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The same of one pose, a row of Seen.
using SeenTargets = Eigen::Array<bool, 1, Eigen::Dynamic>;

/// Every pose shows every target.
Seen all_seen(Index pose_count, Index target_count);

/// How often each target is observed if those seen are so often: poses x targets.
RowMatrixXd times_seen(const Seen& is_seen, double repeats);

/// The targets that a pose shows, from 0, ascending.
std::vector<Index> targets_seen(const SeenTargets& is_seen);

/// A pose that shows the targets listed (from 0), of so many.
SeenTargets seen_targets(const std::vector<Index>& targets, Index target_count);

/// Rows of an observation that belong to the targets seen, where each target has so many.
/// Ascending.
std::vector<Index> seen_rows(const SeenTargets& is_seen, Index rows_per_target);

/// For people: numbers of the targets seen, from 1, like "1 3".
std::string target_numbers(const SeenTargets& is_seen);

}  // namespace posewise
