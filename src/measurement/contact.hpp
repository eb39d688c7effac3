#pragma once

#include <functional>
#include <optional>

#include "model/joint_limits.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensor.hpp"

/// Poses that a sensor with has_contacts() can measure: what the robot touches it has to reach.
namespace posewise::detail {

/// The configuration near q at which this contact's readings are `readings` (m; 0: it touches), by
/// least steps of the joints [Whitney 1969]; nothing if there is none within the range.
std::optional<VectorXd> bring_to_contact(const Campaign& campaign, const Parameters& parameters,
                                         VectorXd q, Index contact, const JointRange& range,
                                         const VectorXd& readings);

/// Configurations and which targets each shows: poses x targets.
struct ShownPoses {
    RowMatrixXd configurations;
    Seen is_seen;
};

/// Candidates as they are, all targets seen; where the sensor knows contacts each is brought to
/// one of them, the first to contact `first` and so on in turn, and left out if it cannot be.
ShownPoses bring_to_contacts(const Campaign& campaign, const Parameters& parameters,
                             const RowMatrixXd& candidates, Index first, const JointRange& range);

/// So many poses out of configurations that `draw` draws; a longer list of it begins with the
/// shorter one. Throws InputError if hardly any reach something that is to be touched.
ShownPoses draw_poses(const Campaign& campaign, const Parameters& parameters, Index count,
                      const std::function<RowMatrixXd(Index count)>& draw);

/// Of random_configurations(), each touching one of what the sensor touches, in turn; nothing if it
/// touches none, or poses within the limits hardly reach them all.
std::optional<ShownPoses> touching_poses(const Campaign& campaign, const Parameters& parameters,
                                         Index count, std::uint64_t seed);

/// How far as many targets as are needed are from being out of sight: that largest of all
/// clearances, or the least of fewer. Leaves them in another order.
double needed_clearance(Eigen::Ref<VectorXd> clearances, Index needed);

/// What a sensor with has_view() sees at a configuration.
struct View {
    SeenTargets is_seen;   ///< the targets in view
    double clearance = 0;  ///< needed_clearance(); negative: fewer are in view than are needed
};
View view_at(const Campaign& campaign, const Parameters& parameters, const VectorXd& q);

struct ViewedPoses : ShownPoses {
    Index in_view = 0;  ///< the first so many; the others only come nearest to it
};

/// Random configurations at which a sensor with has_view() has as many targets in view as it needs,
/// and which targets these are. Where too few do, those that come nearest to it join them; all of
/// their targets are taken as seen.
ViewedPoses viewed_poses(const Campaign& campaign, const Parameters& parameters, Index count,
                         std::uint64_t seed);

/// A base from which a fixed camera, in whose frame the base is, sees much of what the robot moves:
/// for a campaign that does not state one. Of some directions and distances that from which most
/// random configurations are in view.
Isometry3d base_in_view(const Campaign& campaign);

/// Of random_configurations().
ShownPoses random_poses(const Campaign& campaign, const Parameters& parameters, Index count,
                        std::uint64_t seed);

}  // namespace posewise::detail
