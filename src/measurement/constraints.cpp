#include "posewise/measurement/constraints.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "cell_check.hpp"
#include "contact.hpp"
#include "core/format.hpp"
#include "model/halton.hpp"

namespace posewise {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

using detail::interval_clearance;
using detail::pose_rounding;

/// The limits of a joint at such a stop.
Interval limits_at(const Constraints& constraints, Index joint, Stop stop) {
    const Joint& limited = constraints.robot().joint(joint);
    const JointMargin& margin = constraints.cell().limit_margin;
    double outset = 0;
    if (stop == Stop::Home) {
        outset = limited.motion == Motion::Rotation ? margin.angle : margin.length;
    }
    return {limited.lower - outset, limited.upper + outset};
}

/// Of the joint farthest beyond its limits.
std::string describe_limits(const Constraints& constraints, const VectorXd& q, Stop stop) {
    double least = infinity;
    std::string text;
    for (Index j = 0; j < constraints.robot().joint_count(); ++j) {
        const Interval limits = limits_at(constraints, j, stop);
        const double clearance = interval_clearance(limits, q[j]);
        if (!(clearance < least)) continue;
        least = clearance;
        const Joint& joint = constraints.robot().joint(j);
        text = detail::describe_range(joint.name, joint.motion, q[j], limits.lower, limits.upper);
    }
    return text;
}

/// Clearance of an azimuth to an interval that may lie across +-pi.
double azimuth_clearance(const Interval& interval, double azimuth) {
    if (!std::isfinite(interval.lower) || !std::isfinite(interval.upper)) {
        return interval_clearance(interval, azimuth);
    }
    const double center = (interval.lower + interval.upper) / 2;
    const double offset = std::remainder(azimuth - center, 2 * std::numbers::pi);
    return (interval.upper - interval.lower) / 2 - std::abs(offset);
}

}  // namespace

/// Where everything that moves with the robot is, in the base frame.
struct Constraints::Posture {
    std::vector<Capsule> bodies;  ///< links first
    std::vector<Vector3d> targets;
    Isometry3d base_from_flange;
};

/// A body and what is nearest to it.
struct Constraints::Pair {
    double distance = infinity;  ///< of the surfaces, m
    std::size_t body = 0;
    std::size_t other = 0;  ///< a keep-out, or a body

    void consider(double candidate, std::size_t first, std::size_t second) {
        if (candidate < distance) *this = {candidate, first, second};
    }
};

const char* constraint_name(Constraint constraint) {
    static constexpr std::array<const char*, constraint_count> names{
        "joint limits",
        "joint_sums",
        "fixed",
        "target_boxes",
        "keep_out",
        "self-collision of links",
        "contact",
        "tracker.range",
        "tracker.azimuth",
        "tracker.elevation",
        "reflectors.acceptance_half_angle",
        "tracker.line_of_sight",
        "reflectors.at_least_visible",
        "sensor.view"};
    return names[static_cast<std::size_t>(constraint)];
}

double ConstraintReport::margin() const {
    return *std::min_element(clearance.begin(), clearance.end());
}

Constraints::Constraints(const Campaign& campaign, Cell cell, bool needs_contact)
    : cell_(std::move(cell)),
      contact_(needs_contact && campaign.sensor->has_contacts() ? std::optional(campaign)
                                                                : std::nullopt),
      view_(needs_contact && campaign.sensor->has_view() ? campaign.sensor : nullptr),
      view_unknowns_(campaign.nominal.sensor),
      robot_(without_parameters(detail::with_margin(campaign.robot, cell_.limit_margin))),
      target_count_(campaign.sensor->target_count()),
      tracker_from_base_(campaign.nominal.world_from_base),
      targets_(detail::nominal_targets(campaign, cell_)),
      bodies_(detail::bodies_of(campaign, cell_)),
      pairs_(detail::colliding_pairs(cell_.links, bodies_, robot_.joint_count())),
      clearance_rates_(detail::clearance_rates(robot_, bodies_)) {
    detail::check_cell(cell_, robot_, targets_);
    if (view_ && !(campaign.has_nominal_base && campaign.has_nominal_targets)) {
        throw InputError(
            fmt::format("what a camera sees depends on where it is; the campaign must state base "
                        "and {}, if only roughly",
                        view_->words().key));
    }
    if (view_) find_view_screens();
    const Vector3d tracker = tracker_from_base_.inverse().translation();
    for (std::size_t i = 0; i < cell_.keep_outs.size(); ++i) {
        if (!contains(cell_.keep_outs[i].solid, tracker)) screens_.push_back(i);
    }
}

void Constraints::find_view_screens() {
    const auto lines_at = [this](const Isometry3d& base_from_flange) -> SightLines {
        return view_->sight_lines(tracker_from_base_ * base_from_flange, view_unknowns_);
    };
    const SightLines lines = lines_at(Isometry3d::Identity());
    const SightLines moved = lines_at(Isometry3d(Eigen::Translation3d(1, 1, 1)));
    if (lines.size() == 0) return;
    // Ends in the base frame, where the flange is for `lines`.
    std::vector<Vector3d> fixed, on_flange;
    for (Index j = 0; j < lines.cols(); ++j) {
        if (lines.col(j).head<3>() == lines.col(j).tail<3>()) continue;
        for (const Index end : {0, 3}) {
            const Vector3d point = lines.block<3, 1>(end, j);
            const bool is_fixed = (moved.block<3, 1>(end, j) - point).norm() < 0.5;
            (is_fixed ? fixed : on_flange).push_back(tracker_from_base_.inverse() * point);
        }
    }
    const auto frames = robot_.base_from_links(VectorXd::Zero(robot_.joint_count()), VectorXd());
    const auto holds_any = [](const Shape& solid, const std::vector<Vector3d>& points) {
        return std::ranges::any_of(points, [&](const Vector3d& p) { return contains(solid, p); });
    };
    for (std::size_t i = 0; i < cell_.keep_outs.size(); ++i) {
        if (!holds_any(cell_.keep_outs[i].solid, fixed)) view_screens_.push_back(i);
    }
    for (std::size_t i = 0; i < cell_.links.size(); ++i) {
        const Index frame = cell_.links[i].frame;
        const bool is_on_flange = frame >= robot_.joint_count();
        const Capsule solid = is_on_flange ? frames.back().inverse() *
                                                 frames[static_cast<std::size_t>(frame)] *
                                                 cell_.links[i].solid
                                           : cell_.links[i].solid;
        const bool holds_end =
            is_on_flange ? holds_any(solid, on_flange) : frame == 0 && holds_any(solid, fixed);
        if (!holds_end) view_links_.push_back(i);
    }
}

bool Constraints::restricts_places() const {
    const bool has_obstacles = !bodies_.empty() && !cell_.keep_outs.empty();
    return contact_ || view_ || cell_.sight || !cell_.joint_sums.empty() ||
           !cell_.target_boxes.empty() || has_obstacles || !pairs_.empty();
}

Constraints::Posture Constraints::pose_bodies(const VectorXd& q) const {
    const std::vector<Isometry3d> frames = robot_.base_from_links(q, VectorXd());
    Posture posture{{}, {}, frames.back()};
    for (const Link& body : bodies_) {
        posture.bodies.push_back(frames[static_cast<std::size_t>(body.frame)] * body.solid);
    }
    for (const Vector3d& target : targets_) posture.targets.push_back(frames.back() * target);
    return posture;
}

double Constraints::limit_clearance(const VectorXd& q) const {
    double least = infinity;
    for (Index j = 0; j < robot_.joint_count(); ++j) {
        if (cell_.fixed_joints.count(j) != 0) continue;
        const Joint& joint = robot_.joints()[static_cast<std::size_t>(j)];
        least = std::min(least, interval_clearance({joint.lower, joint.upper}, q[j]));
    }
    return least;
}

double Constraints::sum_clearance(const VectorXd& q) const {
    double least = infinity;
    for (const JointSum& sum : cell_.joint_sums) {
        const Interval limits = detail::within_margin(sum, cell_, robot_);
        least = std::min(least, interval_clearance(limits, sum.amount(q)));
    }
    return least;
}

double Constraints::fixed_clearance(const VectorXd& q) const {
    constexpr double tolerance = 1e-9;
    double least = infinity;
    for (const auto& [joint, value] : cell_.fixed_joints) {
        const double deviation = std::abs(q[joint] - value);
        if (deviation > tolerance) least = std::min(least, -deviation);
    }
    return least;
}

double Constraints::box_clearance(const Posture& posture) const {
    if (cell_.target_boxes.empty()) return infinity;
    double least = infinity;
    for (const Vector3d& target : posture.targets) {
        double best = -infinity;
        for (const Box& box : cell_.target_boxes) {
            best = std::max(best, -signed_distance(target, box));
        }
        least = std::min(least, best);
    }
    return least;
}

Constraints::Pair Constraints::nearest_keep_out(const Posture& posture) const {
    Pair nearest;
    for (std::size_t i = 0; i < posture.bodies.size(); ++i) {
        if (bodies_[i].frame == 0) continue;  // never moves
        for (std::size_t k = 0; k < cell_.keep_outs.size(); ++k) {
            nearest.consider(clearance(posture.bodies[i], cell_.keep_outs[k].solid), i, k);
        }
    }
    return nearest;
}

Constraints::Pair Constraints::nearest_of_robot(const Posture& posture) const {
    Pair nearest;
    for (const auto& [i, j] : pairs_) {
        nearest.consider(clearance(posture.bodies[i], posture.bodies[j]), i, j);
    }
    return nearest;
}

double Constraints::line_clearance(const Posture& posture, const Vector3d& target) const {
    if (!cell_.sight->is_line_required) return infinity;
    const Capsule line{tracker_from_base_.inverse().translation(), target, 0};
    double least = infinity;
    for (std::size_t i = 0; i < cell_.links.size(); ++i) {
        least = std::min(least, clearance(line, posture.bodies[i]));
    }
    for (const std::size_t i : screens_) {
        least = std::min(least, clearance(line, cell_.keep_outs[i].solid));
    }
    return least;
}

double Constraints::view_clearance(const Posture& posture, const SightLines& line) const {
    // A board may lie on an obstacle, or stand before the last link, as roughly as that is stated.
    constexpr double before_target = 0.02;  // m
    const Isometry3d base_from_world = tracker_from_base_.inverse();
    const Vector3d camera = base_from_world * Vector3d(line.topRows<3>());
    const Vector3d target = base_from_world * Vector3d(line.bottomRows<3>());
    const Vector3d way = target - camera;
    const double length = way.norm();
    if (length <= before_target) return infinity;
    const Capsule seen{camera, camera + (1 - before_target / length) * way, 0};
    double least = infinity;
    for (const std::size_t i : view_links_) {
        least = std::min(least, clearance(seen, posture.bodies[i]));
    }
    for (const std::size_t i : view_screens_) {
        least = std::min(least, clearance(seen, cell_.keep_outs[i].solid));
    }
    return least;
}

void Constraints::check_contact(const VectorXd& q, ConstraintReport& report) const {
    constexpr double touches = 1e-9;  // m
    const Parameters& nominal = contact_->nominal;
    const RowMatrixXd readings =
        contact_->sensor->predict(world_from_flange(*contact_, nominal, q), nominal.sensor)
            .reshaped<Eigen::RowMajor>(target_count_, contact_->sensor->rows_per_target());
    const VectorXd misses = readings.rowwise().norm();
    report.is_seen = (misses.transpose().array() <= touches);
    report.clearance[static_cast<std::size_t>(Constraint::Contact)] = touches - misses.minCoeff();
}

RowMatrixXd Constraints::bring_to_contacts(const RowMatrixXd& candidates, Index first) const {
    if (!contact_) return candidates;
    return detail::bring_to_contacts(*contact_, contact_->nominal, candidates, first,
                                     detail::joint_range(robot_, cell_))
        .configurations;
}

void Constraints::check_sight(const Posture& posture, ConstraintReport& report) const {
    const Sight& sight = *cell_.sight;
    const std::size_t count = posture.targets.size();
    const Matrix3d tracker_R_flange =
        tracker_from_base_.linear() * posture.base_from_flange.linear();
    // Clearances of each target: range, azimuth, elevation, incidence, line, and the least of them.
    constexpr std::size_t first = static_cast<std::size_t>(Constraint::Range);
    constexpr std::size_t kinds = static_cast<std::size_t>(Constraint::VisibleTargets) + 1 - first;
    Eigen::Matrix<double, Eigen::Dynamic, kinds> clearances(count, kinds);
    for (std::size_t j = 0; j < count; ++j) {
        const Vector3d point = tracker_from_base_ * posture.targets[j];
        const double incidence =
            sight.normals.empty()
                ? infinity
                : sight.acceptance_half_angle -
                      detail::angle_between(tracker_R_flange * sight.normals[j], -point);
        const auto [azimuth, elevation] = detail::sighting_of(point);
        std::array<double, kinds> of_target{interval_clearance(sight.range, point.norm()),
                                            azimuth_clearance(sight.azimuth, azimuth),
                                            interval_clearance(sight.elevation, elevation),
                                            incidence,
                                            line_clearance(posture, posture.targets[j]),
                                            infinity};
        of_target.back() = *std::min_element(of_target.begin(), of_target.end());
        report.is_seen[static_cast<Index>(j)] = of_target.back() >= -pose_rounding;
        for (std::size_t k = 0; k < kinds; ++k) {
            clearances(static_cast<Index>(j), static_cast<Index>(k)) = of_target[k];
        }
    }
    const Index needed = sight.least_visible.value_or(static_cast<Index>(count));
    if (needed == 0) return;
    for (std::size_t k = 0; k < kinds; ++k) {
        report.clearance[first + k] =
            detail::needed_clearance(clearances.col(static_cast<Index>(k)), needed);
    }
}

void Constraints::check_view(const Posture& posture, ConstraintReport& report) const {
    VectorXd clearances(view_->target_count());
    const Isometry3d world_from_flange = tracker_from_base_ * posture.base_from_flange;
    view_->view_clearances(world_from_flange, view_unknowns_, clearances);
    if (!view_links_.empty() || !view_screens_.empty()) {
        const SightLines lines = view_->sight_lines(world_from_flange, view_unknowns_);
        for (Index j = 0; j < lines.cols(); ++j) {
            clearances[j] = std::min(clearances[j], view_clearance(posture, lines.col(j)));
        }
        view_->hide_incomplete_parts(clearances);
    }
    report.is_seen = report.is_seen && clearances.transpose().array() >= -pose_rounding;
    report.clearance[static_cast<std::size_t>(Constraint::View)] =
        detail::needed_clearance(clearances, view_->least_in_view());
}

ConstraintReport Constraints::check(const VectorXd& q) const {
    robot_.check_configuration(q);
    const Posture posture = pose_bodies(q);
    ConstraintReport report;
    report.clearance.fill(infinity);
    report.is_seen.setConstant(target_count_, true);
    const auto set = [&report](Constraint constraint, double value) {
        report.clearance[static_cast<std::size_t>(constraint)] = value;
    };
    set(Constraint::JointLimits, limit_clearance(q));
    set(Constraint::JointSums, sum_clearance(q));
    set(Constraint::FixedJoints, fixed_clearance(q));
    set(Constraint::TargetBoxes, box_clearance(posture));
    set(Constraint::KeepOuts, nearest_keep_out(posture).distance - cell_.safety_distance);
    set(Constraint::SelfCollision, nearest_of_robot(posture).distance - cell_.safety_distance);
    check_targets(q, posture, report);
    return report;
}

void Constraints::check_targets(const VectorXd& q, const Posture& posture,
                                ConstraintReport& report) const {
    if (cell_.sight) check_sight(posture, report);
    if (contact_) check_contact(q, report);
    if (view_) check_view(posture, report);
}

SeenTargets Constraints::seen(const VectorXd& q) const {
    ConstraintReport report;
    report.is_seen.setConstant(target_count_, true);
    if (!cell_.sight && !contact_ && !view_) return report.is_seen;
    robot_.check_configuration(q);
    check_targets(q, pose_bodies(q), report);
    return report.is_seen;
}

double Constraints::collision_clearance(const VectorXd& q) const {
    const Posture posture = pose_bodies(q);
    return std::min(nearest_keep_out(posture).distance, nearest_of_robot(posture).distance) -
           cell_.safety_distance;
}

std::optional<Constraint> Constraints::find_violated(const VectorXd& q, Stop stop) const {
    if (stop == Stop::Measured || stop == Stop::Sent) {
        const ConstraintReport report = check(q);
        for (std::size_t k = 0; k < constraint_count; ++k) {
            const auto constraint = static_cast<Constraint>(k);
            if (constraint == Constraint::FixedJoints && stop == Stop::Sent) continue;
            if (report[constraint] < -pose_rounding) return constraint;
        }
        return std::nullopt;
    }
    robot_.check_configuration(q);
    for (Index j = 0; j < robot_.joint_count(); ++j) {
        if (interval_clearance(limits_at(*this, j, stop), q[j]) < -pose_rounding) {
            return Constraint::JointLimits;
        }
    }
    if (sum_clearance(q) < -pose_rounding) return Constraint::JointSums;
    const Posture posture = pose_bodies(q);
    const double needed = cell_.safety_distance - pose_rounding;
    if (nearest_keep_out(posture).distance < needed) return Constraint::KeepOuts;
    if (nearest_of_robot(posture).distance < needed) return Constraint::SelfCollision;
    return std::nullopt;
}

Clearance Constraints::nearest(const VectorXd& q) const {
    const Posture posture = pose_bodies(q);
    const Pair outer = nearest_keep_out(posture);
    const Pair inner = nearest_of_robot(posture);
    if (std::min(outer.distance, inner.distance) == infinity) return {};
    if (outer.distance <= inner.distance) {
        return {outer.distance, bodies_[outer.body].name, cell_.keep_outs[outer.other].name};
    }
    // The later one along the chain first, as it is what moves.
    return {inner.distance, bodies_[inner.other].name, bodies_[inner.body].name};
}

std::string describe_clearance(const Clearance& nearest, double safety_distance) {
    const bool is_apart = nearest.distance >= 0;
    return fmt::format(
        "{} {} {} mm {} {}, must be {} mm away", nearest.body, is_apart ? "is" : "reaches",
        detail::format_fixed(1e3 * std::abs(nearest.distance), 2), is_apart ? "from" : "into",
        nearest.other, detail::format_short(1e3 * safety_distance));
}

std::string describe_violation(const Constraints& constraints, const VectorXd& q, Stop stop) {
    const std::optional<Constraint> violated = constraints.find_violated(q, stop);
    if (!violated) return "";
    if (*violated == Constraint::JointLimits) {
        return fmt::format("is beyond the joint limits{}: {}",
                           stop == Stop::Home ? "" : " (less their margin)",
                           describe_limits(constraints, q, stop));
    }
    const std::string text = std::string("does not meet ") + constraint_name(*violated);
    if (*violated == Constraint::JointSums) {
        return text + ": " + detail::describe_sums(constraints.cell(), constraints.robot(), q);
    }
    if (*violated == Constraint::KeepOuts || *violated == Constraint::SelfCollision) {
        return text + ": " +
               describe_clearance(constraints.nearest(q), constraints.cell().safety_distance);
    }
    return text;
}

std::string describe_unchecked_bodies(const Campaign& campaign) {
    const Cell& cell = campaign.cell;
    if (cell.keep_outs.empty()) return "";
    const bool are_balls = campaign.sensor->target_radius().has_value();
    std::string text;
    if (cell.links.empty()) {
        text =
            "the arm is not kept off the cell's obstacles, since cell.links are not stated: "
            "state them (a campaign made from a URDF has them from its collision shapes)";
    }
    if (are_balls && !campaign.has_nominal_targets) {
        text += std::string(text.empty() ? "" : "; ") +
                "the targets are not kept off them, since it is not stated where they are: state " +
                campaign.sensor->words().key;
    }
    return text;
}

double joint_distance(const ConstNumbers& a, const ConstNumbers& b) {
    constexpr double pi = std::numbers::pi;
    const auto apart = [](double difference) {
        return std::abs(std::abs(difference) > pi ? std::remainder(difference, 2 * pi)
                                                  : difference);
    };
    return (a - b).unaryExpr(apart).maxCoeff();
}

}  // namespace posewise
