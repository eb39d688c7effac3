#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/core/errors.hpp"
#include "posewise/core/progress.hpp"
#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensor.hpp"
#include "posewise/model/cell.hpp"

namespace posewise {

enum class Constraint {
    JointLimits,  ///< including their margin
    JointSums,    ///< sums of joints within their limits, less the margin
    FixedJoints,  ///< at their value to 1e-9 rad or m
    TargetBoxes,  ///< every target lies in one of them
    KeepOuts,     ///< moving links and balls at targets against keep-outs
    /// Links against links, unless fixed to the same or adjacent frames; balls against links,
    /// unless at most one joint is between them.
    SelfCollision,
    Contact,  ///< for sensors with has_contacts(): one of them is touched, to 1 nm
    /// This and the next four, each by itself: as many targets as must be visible.
    Range,
    Azimuth,
    Elevation,
    Incidence,
    LineOfSight,
    VisibleTargets,  ///< all five at once for as many targets as must be visible
    /// For sensors with has_view(): as many targets as must be are in sight and hidden by nothing,
    /// rad or m.
    View,
};
inline constexpr std::size_t constraint_count = 14;

/// Name for messages, like that in campaign files: "tracker.elevation".
const char* constraint_name(Constraint constraint);

/// How far a configuration is from violating each constraint.
struct ConstraintReport {
    /// Indexed by Constraint, m or rad: at least 0 if it is met; infinite if the cell has no such
    /// constraint.
    std::array<double, constraint_count> clearance;
    /// The target touched, for sensors with contacts; else the visible targets, to 1e-9 m or rad.
    /// All if the cell states no sight.
    SeenTargets is_seen;

    double operator[](Constraint constraint) const {
        return clearance[static_cast<std::size_t>(constraint)];
    }
    /// The smallest clearance. A metre counts like a radian: at arm's length they are similar.
    double margin() const;
    bool is_feasible() const { return margin() >= 0; }
};

/// A sentence that says what is not checked against the cell's obstacles, because its place is not
/// stated, and what to state; empty if there is nothing.
std::string describe_unchecked_bodies(const Campaign& campaign);

/// "target 1 is 12.30 mm from fence left, must be 30 mm away": for bodies closer than the cell's
/// safety distance.
std::string describe_clearance(const Clearance& nearest, double safety_distance);

/// What a robot does where it stops: it says which constraints must be met there.
enum class Stop {
    Measured,  ///< all
    Sent,      ///< all but FixedJoints: rounding to a program's digits moves those, too
    Via,       ///< JointLimits, JointSums, KeepOuts and SelfCollision
    Home,      ///< likewise, the joint limits without their margin
};

/// A cell around a campaign's robot: validated once, then queried for many configurations. Calls
/// have no side effects, so threads may share one.
class Constraints {
  public:
    /// Throws InputError if the cell contradicts itself or does not fit the campaign: intervals
    /// out of order, shapes without extent, a margin that leaves no range, a fixed value outside
    /// the limits, a number of normals other than that of targets, targets inside a link that hides
    /// them, or a cell that mentions targets or the tracker if the sensor has no targets or the
    /// campaign does not state its base and targets. `needs_contact`: whether a sensor with
    /// has_contacts() or has_view() is to measure there; the latter needs base and sensor stated.
    Constraints(const Campaign& campaign, Cell cell, bool needs_contact = true);

    const Cell& cell() const { return cell_; }
    /// Whether the cell allows less than the joint limits (less margin, fixed joints at theirs).
    bool restricts_places() const;
    /// The robot with its limits reduced by the margin; fixed joints keep theirs.
    const Chain& robot() const { return robot_; }
    Index target_count() const { return target_count_; }
    /// Whether something must be touched; hardly any pose is feasible then.
    bool needs_contact() const { return contact_.has_value(); }
    /// Moves candidates to the contacts, one contact after another; `first` is the index of the
    /// first candidate. Unchanged if nothing must be touched. Candidates that reach no contact are
    /// left out.
    RowMatrixXd bring_to_contacts(const RowMatrixXd& candidates, Index first) const;

    /// The first constraint that q violates at such a stop by more than rounding, 1e-9 rad or m.
    std::optional<Constraint> find_violated(const VectorXd& q, Stop stop) const;

    /// Checks q with nominal geometry. Throws InputError as Chain::check_configuration().
    ConstraintReport check(const VectorXd& q) const;
    /// check(q).margin(): at least 0 where q is feasible, continuous in q.
    double margin(const VectorXd& q) const { return check(q).margin(); }
    /// check(q).is_seen.
    SeenTargets seen(const VectorXd& q) const;
    /// The smaller of the KeepOuts and SelfCollision clearances.
    double collision_clearance(const VectorXd& q) const;
    /// That of JointSums: at least 0 on a straight move where it is at both ends.
    double sum_clearance(const VectorXd& q) const;
    /// The two bodies nearest to each other; their distance is collision_clearance() plus the
    /// cell's safety distance.
    Clearance nearest(const VectorXd& q) const;
    /// Bound on the rate of collision_clearance() along each joint: m per rad (m per m), from the
    /// length of the arm after it.
    const VectorXd& clearance_rates() const { return clearance_rates_; }

  private:
    struct Posture;
    struct Pair;
    Posture pose_bodies(const VectorXd& q) const;
    double limit_clearance(const VectorXd& q) const;
    double fixed_clearance(const VectorXd& q) const;
    double box_clearance(const Posture& posture) const;
    Pair nearest_keep_out(const Posture& posture) const;
    Pair nearest_of_robot(const Posture& posture) const;
    double line_clearance(const Posture& posture, const Vector3d& target) const;
    /// Which bodies hide what a sensor with has_view() sees: not those that hold an end of its
    /// lines of sight wherever the robot is.
    void find_view_screens();
    double view_clearance(const Posture& posture, const SightLines& line) const;
    void check_contact(const VectorXd& q, ConstraintReport& report) const;
    void check_sight(const Posture& posture, ConstraintReport& report) const;
    void check_view(const Posture& posture, ConstraintReport& report) const;
    /// Which targets are seen, and the clearances of that: all three, as far as they are asked for.
    void check_targets(const VectorXd& q, const Posture& posture, ConstraintReport& report) const;

    Cell cell_;
    std::optional<Campaign> contact_;     // if something must be touched
    std::shared_ptr<const Sensor> view_;  // if something must be in its view
    VectorXd view_unknowns_;
    Chain robot_;
    Index target_count_;
    Isometry3d tracker_from_base_;
    std::vector<Vector3d> targets_;  // in the flange frame
    std::vector<Link> bodies_;       // the cell's links, then the balls at the targets
    std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // bodies that may collide
    std::vector<std::size_t> screens_;                        // keep-outs that hide
    std::vector<std::size_t> view_links_, view_screens_;      // links and keep-outs, from a camera
    VectorXd clearance_rates_;
};

/// "is beyond the joint limits: q2 is 61 deg, must be from -50 to 60 deg", "does not meet keep_out:
/// link 3 is 12.30 mm from fence, must be 30 mm away": the constraint that find_violated() finds,
/// with its values; empty if there is none.
std::string describe_violation(const Constraints& constraints, const VectorXd& q, Stop stop);

/// Largest joint difference between two configurations, rad or m. Whole turns are none: a joint is
/// where it was.
double joint_distance(const ConstNumbers& a, const ConstNumbers& b);

/// How many candidates a constraint removed.
struct Rejections {
    Index first = 0;   ///< candidates whose first violation it is, in Constraint order
    Index in_all = 0;  ///< candidates that violate it, whatever else they violate
};

/// The candidates that satisfy all constraints, in the order they were drawn.
struct Pool {
    RowMatrixXd configurations;  ///< feasible x joints
    Seen is_seen;                ///< feasible x targets
    Index candidate_count = 0;
    std::array<Rejections, constraint_count> rejections{};  ///< indexed by Constraint
};

/// Draws `count` configurations of a scrambled Halton sequence within limits and margins, with
/// fixed joints at their values, and keeps the feasible ones. Independent of the number of threads.
/// Draws fewer if `stop` is set, see Pool::candidate_count. Throws InputError for a count below 1,
/// or if none is feasible, naming the constraints to blame.
Pool make_pool(const Constraints& constraints, Index count, std::uint64_t seed,
               const StopSignal& stop = {});

/// Throws InputError if a pool has fewer poses than a plan needs, naming the constraint to blame.
void check_pool_size(const Pool& pool, Index needed);

/// The error to throw if `needed` poses are needed and only those of this pool were found. It names
/// the constraint to blame and, for a collision, the bodies that collide most often.
InputError few_feasible(const Constraints& constraints, const Pool& pool, Index needed);

/// Configurations that the cell does not allow, as rows from 0. Violations by rounding to twelve
/// digits are accepted.
struct CellViolations {
    std::vector<Index> rows;
    Pool allowed;  ///< the others; its rejections are those of the rows above
};
CellViolations find_violations(const Constraints& constraints, const RowMatrixXd& configurations);

/// "3 of 20 configurations violate the campaign's cell: 4, 7, 9 (keep_out: 2, tracker.range: 1)",
/// with their ids; empty if there is none.
std::string describe(const CellViolations& violations, const std::vector<std::string>& ids);

/// One line per constraint that removed anything, the largest first: "keep_out: 812 (310 first)".
std::string describe_rejections(const Pool& pool);

/// The feasible ones among given configurations.
Pool filter_pool(const Constraints& constraints, const RowMatrixXd& candidates);

}  // namespace posewise
