#pragma once

#include "measurement/contact.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"

/// The Jacobian that decides what is identifiable: at nominal values, in expected errors.
namespace posewise::detail {

inline constexpr std::uint64_t configuration_seed =
    20151;  // any: it only has to be always the same

/// In expected errors, as a share of the strongest column: where that is 2 mm, 0.2 um, which the
/// best tracker (5 um) does not see in 300 readings. What is left of a column there is the rounding
/// of a file's numbers: a target on the last joint's axis but for an angle of 3.1416.
inline constexpr double least_visible = 1e-4;
/// What must be left of each column, as such a share. Numbers of the robot that are rounded blur
/// its geometry, not the shapes of terms or of a lens.
VectorXd least_shares_of(const Campaign& campaign);

/// As many random poses as twice the parameters, of a camera those that show it the board. Of a
/// probe that touches each touches one thing, where they can reach all. Fewer where many parameters
/// are errors of corners stated with sizes, which each view tells together.
ShownPoses poses_to_judge(const Campaign& campaign);

/// Expected errors by their kinds alone: what one of them is stated as, or how far joints' zeros
/// are off where nobody mastered them, is no matter of rank.
VectorXd sizes_of(Campaign campaign);

/// Rows of the poses from `first` on, in m and rad.
MatrixXd stack_at_nominal(const Campaign& campaign, const ShownPoses& poses, Index first,
                          Index count);

/// The triangular factor of the Jacobian in expected errors over poses_to_judge(), which is made in
/// parts: all that tells how columns depend on each other, and no more
/// rows than columns. Throws InputError if it is stopped.
MatrixXd factor_at_nominal(const Campaign& campaign, const StopSignal& stop);

}  // namespace posewise::detail
