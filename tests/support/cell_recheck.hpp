#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "posewise/measurement/campaign.hpp"
#include "posewise/measurement/sensors.hpp"
#include "posewise/model/cell.hpp"
#include "support/robots.hpp"

/// Separate, simple code that says what is wrong with a configuration in a cell: everything is
/// sampled densely, in the world instead of the base frame, and nothing of the planner is used.
namespace posewise::testing {

inline double depth_in(const Shape& shape, const Vector3d& x) {
    if (const auto* const box = std::get_if<Box>(&shape)) {
        return std::min((x - box->lower).minCoeff(), (box->upper - x).minCoeff());
    }
    if (const auto* const sphere = std::get_if<Sphere>(&shape)) {
        return sphere->radius - (x - sphere->center).norm();
    }
    if (const auto* const plane = std::get_if<HalfSpace>(&shape)) {
        return -plane->normal.dot(x - plane->point);
    }
    const auto& capsule = std::get<Capsule>(shape);
    double nearest = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= 50; ++i) {
        nearest =
            std::min(nearest, (x - capsule.from - i / 50.0 * (capsule.to - capsule.from)).norm());
    }
    return capsule.radius - nearest;
}

/// How far a point lies outside of a solid; 0 within.
inline double distance_to(const Shape& shape, const Vector3d& x) {
    if (const auto* const box = std::get_if<Box>(&shape)) {
        return (x - x.cwiseMax(box->lower).cwiseMin(box->upper)).norm();
    }
    const auto* const capsule = std::get_if<Capsule>(&shape);
    if (capsule == nullptr) return std::max(0.0, -depth_in(shape, x));
    const Vector3d along = capsule->to - capsule->from;
    const double square = std::max(along.squaredNorm(), 1e-300);
    const double share = std::clamp(along.dot(x - capsule->from) / square, 0.0, 1.0);
    return std::max(0.0, (x - capsule->from - share * along).norm() - capsule->radius);
}

/// Points on a capsule's surface: rings and fans about both ends.
inline std::vector<Vector3d> surface_points(const Capsule& capsule) {
    std::vector<Vector3d> points;
    for (int i = 0; i <= 24; ++i) {
        const Vector3d center = capsule.from + i / 24.0 * (capsule.to - capsule.from);
        for (int latitude = -4; latitude <= 4; ++latitude) {
            for (int longitude = 0; longitude < 16; ++longitude) {
                const double u = latitude * 22.5 * degree;
                const double v = longitude * 22.5 * degree;
                points.push_back(center + capsule.radius * Vector3d(std::cos(u) * std::cos(v),
                                                                    std::cos(u) * std::sin(v),
                                                                    std::sin(u)));
            }
        }
    }
    return points;
}

/// Names of all violated constraints, one each; allowed: how deep (m) sampling may find something.
class CellRecheck {
  public:
    CellRecheck(const Campaign& campaign, const Cell& cell, double allowed = 1e-9)
        : campaign_(campaign), cell_(cell), allowed_(allowed) {}

    std::vector<std::string> violations(const VectorXd& q) {
        found_.clear();
        const auto frames =
            campaign_.robot.base_from_links(q, VectorXd::Zero(campaign_.robot.parameter_count()));
        solids_.clear();
        for (const Link& link : cell_.links) {
            const Isometry3d& frame = frames[static_cast<std::size_t>(link.frame)];
            solids_.push_back({frame * link.solid.from, frame * link.solid.to, link.solid.radius});
        }
        balls_.clear();
        const auto targets = static_cast<Index>(campaign_.nominal.sensor.size() / 3);
        for (Index k = 0; k < targets; ++k) {
            const Vector3d center =
                frames.back() * Vector3d(campaign_.nominal.sensor.segment<3>(3 * k));
            balls_.push_back({center, center, ball_radius});
        }
        for (Index j = 0; j < q.size(); ++j) {
            const Joint& joint = campaign_.robot.joints()[static_cast<std::size_t>(j)];
            const double margin = cell_.limit_margin.angle - 1e-9;
            if (q[j] < joint.lower + margin || q[j] > joint.upper - margin) add("limits");
        }
        check_keep_outs();
        check_links();
        check_targets(frames.back());
        return found_;
    }

  private:
    void add(const std::string& name) { found_.push_back(name); }

    /// Adds a body any of whose surface points is within a solid, or nearer than the safety
    /// distance.
    void check_apart(const std::string& name, const Capsule& body, const std::string& other,
                     const Shape& solid) {
        const double safety = cell_.safety_distance;
        for (const Vector3d& x : surface_points(body)) {
            const bool is_bad = safety > 0 ? distance_to(solid, x) < safety - allowed_
                                           : depth_in(solid, x) > allowed_;
            if (!is_bad) continue;
            add(name + " at " + other);
            return;
        }
    }

    void check_keep_outs() {
        for (const KeepOut& keep_out : cell_.keep_outs) {
            for (std::size_t i = 0; i < solids_.size(); ++i) {
                if (cell_.links[i].frame == 0) continue;
                check_apart(cell_.links[i].name, solids_[i], keep_out.name, keep_out.solid);
            }
            for (const Capsule& ball : balls_) {
                check_apart("a target", ball, keep_out.name, keep_out.solid);
            }
        }
    }

    void check_links() {
        for (std::size_t i = 0; i < solids_.size(); ++i) {
            for (std::size_t j = i + 2; j < solids_.size(); ++j) {  // one link a frame, in order
                check_apart(cell_.links[i].name, solids_[i], cell_.links[j].name, solids_[j]);
            }
            // Balls are on the flange.
            if (cell_.links[i].frame > campaign_.robot.joint_count() - 2) continue;
            for (const Capsule& ball : balls_) {
                check_apart("a target", ball, cell_.links[i].name, solids_[i]);
            }
        }
    }

    bool is_hidden(const Vector3d& tracker, const Vector3d& target) const {
        for (int k = 0; k <= 1000; ++k) {
            const Vector3d x = tracker + k / 1000.0 * (target - tracker);
            for (const Capsule& solid : solids_) {
                if (depth_in(solid, x) > allowed_) return true;
            }
            for (const KeepOut& keep_out : cell_.keep_outs) {
                if (depth_in(keep_out.solid, tracker) > 0) continue;
                if (depth_in(keep_out.solid, x) > allowed_) return true;
            }
        }
        return false;
    }

    void check_targets(const Isometry3d& base_from_flange) {
        const Isometry3d& world_from_base = campaign_.nominal.world_from_base;
        const Vector3d tracker = world_from_base.inverse() * Vector3d::Zero();
        if (!cell_.sight) return;
        const Sight& sight = *cell_.sight;
        Index seen = 0;
        for (std::size_t j = 0; j < 3; ++j) {
            const Vector3d target =
                base_from_flange *
                Vector3d(campaign_.nominal.sensor.segment<3>(3 * static_cast<Index>(j)));
            if (depth_in(cell_.target_boxes[0], target) < -1e-9) add("target outside its box");
            const Vector3d point = world_from_base * target;
            const double range = point.norm();
            const double azimuth = std::atan2(point.y(), point.x());
            const double elevation = std::asin(point.z() / range);
            const Vector3d normal = base_from_flange.linear() * sight.normals[j];
            const double incidence = std::acos(normal.dot((tracker - target).normalized()));
            const bool is_seen =
                range >= sight.range.lower && range <= sight.range.upper &&
                azimuth >= sight.azimuth.lower && azimuth <= sight.azimuth.upper &&
                elevation >= sight.elevation.lower && elevation <= sight.elevation.upper &&
                incidence <= sight.acceptance_half_angle && !is_hidden(tracker, target);
            if (is_seen) ++seen;
            is_seen_[j] = is_seen;
        }
        if (seen < *sight.least_visible) add("too few targets seen");
    }

    const Campaign& campaign_;
    const Cell& cell_;
    double allowed_;
    std::vector<Capsule> solids_;  ///< links
    std::vector<Capsule> balls_;   ///< at the targets
    std::vector<std::string> found_;

  public:
    double ball_radius = 0.01905;
    std::array<bool, 3> is_seen_{};  ///< of the last configuration
};

}  // namespace posewise::testing
