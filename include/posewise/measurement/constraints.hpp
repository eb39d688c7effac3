#pragma once

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/seen.hpp"
#include "posewise/model/cell.hpp"

namespace posewise {

enum class Constraint {
    JointLimits,    ///< with their margin
    FixedJoints,    ///< at their value to 1e-9 rad or m
    TargetBoxes,    ///< every target in one of them
    KeepOuts,       ///< links that move and the balls at targets, against keep-outs
    SelfCollision,  ///< links against links, but for those fixed to the same or the next frame;
                    ///< balls against links, but for those that a joint at most parts from them
    Contact,        ///< of sensors with has_contacts(): one of them is touched, to 1 nm
    Range,          ///< this and the next four: as many targets as must be seen, each by itself
    Azimuth,
    Elevation,
    Incidence,
    LineOfSight,
    VisibleTargets,  ///< all five at once for as many targets as must be seen
};
inline constexpr std::size_t constraint_count = 12;

/// As campaign files call it: "tracker.elevation".
const char* constraint_name(Constraint constraint);

/// How far a configuration is from breaking each constraint.
struct ConstraintReport {
    /// By Constraint, in m or rad: at least 0 if it is met; infinite if the cell has no such
    /// constraint.
    std::array<double, constraint_count> clearance;
    /// What is touched; else what is seen, to 1e-9 m or rad; all if the cell does not speak of
    /// sight.
    SeenTargets is_seen;

    double operator[](Constraint constraint) const {
        return clearance[static_cast<std::size_t>(constraint)];
    }
    /// The smallest clearance. A metre counts as a radian: at arm's length they are alike.
    double margin() const;
    bool is_feasible() const { return margin() >= 0; }
};

/// What is not kept off a cell's obstacles since the campaign does not say where it is, a sentence
/// that says what to state; empty if there is nothing.
std::string describe_unchecked_bodies(const Campaign& campaign);

/// "target 1 is 12.3 mm from fence left, must be 30": bodies nearer to each other than the cell's
/// safety distance.
std::string describe_clearance(const Clearance& nearest, double safety_distance);

/// A cell around the robot of a campaign, checked once and then asked for many configurations.
/// Calls have no side effects, so threads may share one.
class Constraints {
  public:
    /// Throws InputError if the cell contradicts itself or does not fit the campaign: intervals
    /// out of order, shapes without extent, a margin that leaves no range, a fixed value outside
    /// the limits, a number of normals other than that of targets, targets within a link that
    /// hides them, a cell that speaks of targets or the tracker where the sensor has no targets or
    /// the campaign does not state its base and targets.
    /// `needs_contact`: whether a sensor with has_contacts() is to measure there.
    Constraints(const Campaign& campaign, Cell cell, bool needs_contact = true);

    const Cell& cell() const { return cell_; }
    /// Whether the cell allows less than the joint limits (less margin, fixed joints at theirs).
    bool restricts_places() const;
    /// The robot with its limits drawn in by the margin; fixed joints keep theirs.
    const Chain& robot() const { return robot_; }
    Index target_count() const { return target_count_; }
    /// Whether something must be touched: hardly any pose is feasible then.
    bool needs_contact() const { return contact_.has_value(); }
    /// Candidates, the first of index `first`, brought to what is to be touched, one after another;
    /// as they are, if nothing is. Those that cannot be are left out.
    RowMatrixXd bring_to_contacts(const RowMatrixXd& candidates, Index first) const;

    /// Nominal geometry throughout. Throws InputError as Chain::check_configuration().
    ConstraintReport check(const VectorXd& q) const;
    /// check(q).margin(): at least 0 where q is feasible, continuous in q.
    double margin(const VectorXd& q) const { return check(q).margin(); }
    /// check(q).is_seen.
    SeenTargets seen(const VectorXd& q) const;
    /// The smaller of the clearances KeepOuts and SelfCollision.
    double collision_clearance(const VectorXd& q) const;
    /// Which bodies are nearest to each other; their distance is that clearance and the cell's
    /// safety distance together.
    Clearance nearest(const VectorXd& q) const;
    /// A bound on the rate of collision_clearance() along a joint: m per rad (m per m), by the
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
    void check_contact(const VectorXd& q, ConstraintReport& report) const;
    void check_sight(const Posture& posture, ConstraintReport& report) const;

    Cell cell_;
    std::optional<Campaign> contact_;  // if something must be touched
    Chain robot_;
    Index target_count_;
    Isometry3d tracker_from_base_;
    std::vector<Vector3d> targets_;  // in the flange frame
    std::vector<Link> bodies_;       // the cell's links, then the balls at the targets
    std::vector<std::pair<std::size_t, std::size_t>> pairs_;  // of bodies that may collide
    std::vector<std::size_t> screens_;                        // keep-outs that hide
    VectorXd clearance_rates_;
};

/// Largest difference of a joint between two configurations, rad or m.
double joint_distance(const VectorXd& a, const VectorXd& b);

}  // namespace posewise
