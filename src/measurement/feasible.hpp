#pragma once

#include <functional>

#include "contact.hpp"

/// Poses that a campaign's cell allows.
namespace posewise::detail {

/// The first `count` of a sequence that the campaign's cell allows, and which targets each shows;
/// `draw` draws so many of the sequence within the limits of a robot. Where the cell restricts
/// nothing and nothing is to be touched they are the sequence itself. A longer list begins with the
/// shorter one. Throws InputError as check_places(), and one that names what rejects most if hardly
/// any are feasible.
ShownPoses draw_feasible(const Campaign& campaign, Index count,
                         const std::function<RowMatrixXd(const Chain& robot, Index count)>& draw);

}  // namespace posewise::detail
