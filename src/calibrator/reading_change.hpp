#pragma once

#include <string>
#include <vector>

#include "orientation_senses.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/measurements.hpp"

namespace posewise::detail {

/// One thing that was perhaps meant otherwise than it was read.
struct ReadingChange {
    enum class Kind {
        Reversed,      ///< -q for the joint
        Exchanged,     ///< the columns of `joint` and `other`
        Coupled,       ///< factor * q + other_factor * q_other for the joint
        JointFactor,   ///< factor * q: another unit; joint -1: all that rotate
        Zero,          ///< q + factor (rad): another zero
        LengthFactor,  ///< observed lengths in another unit; target -1: of all targets
        LeftHanded,    ///< the instrument's frame: z of points mirrored, and orientations with it
        Orientation,   ///< the orientations in another sense
        Inverted,      ///< each pose: the instrument's frame in the body's was measured
        Axes,          ///< x, y, z of a pose along other axes than its orientation's
        Image,         ///< u and v exchanged, then reversed: 1, 2 and 4 of `other`
    } kind = Kind::Reversed;
    Index joint = -1;  ///< or target, or the order of axes
    Index other = -1;  ///< or which axes are reversed, a bit each
    double factor = 1;
    double other_factor = 0;
    const OrientationSense* sense = nullptr;

    bool operator==(const ReadingChange&) const = default;
};

/// All changes of one reading; none: as read.
using ReadingChanges = std::vector<ReadingChange>;

/// The measurements as they are meant with these changes.
Measurements read_with(const ReadingChanges& changes, const Campaign& campaign,
                       Measurements measurements);

/// Whether there is one of this kind among them.
bool has_kind(const ReadingChanges& changes, ReadingChange::Kind kind);

/// How many things are changed. A coupling with the joint reversed as well counts as two; so does a
/// zero: half a turn of one joint of a wrist does what the next does reversed, which is likelier.
Index count_changes(const ReadingChanges& changes);

/// "q2, q6 reversed and points in mm where the file says m"; "as stated" of none.
std::string describe(const ReadingChanges& changes, const Campaign& campaign,
                     OrientationNotation notation);

/// What to do with file or campaign then, in words; empty of none.
std::string describe_cure(const ReadingChanges& changes, const Campaign& campaign);

/// Names of the joints that are reversed.
std::vector<std::string> reversed_joints(const ReadingChanges& changes, const Campaign& campaign);

/// Whether one has all changes of the other.
bool has_all(const ReadingChanges& changes, const ReadingChanges& others);

/// Every reading that is tried, as read first: all choices of reversed joints (of more than 12
/// joints one at a time), and every other change by itself, couplings of neighbours with their
/// joints reversed as well. Where `length_factor` is not 1, all again with lengths times it.
std::vector<ReadingChanges> all_readings(const Campaign& campaign, OrientationNotation notation,
                                         double length_factor);

}  // namespace posewise::detail
